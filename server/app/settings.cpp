#include "app/settings.h"

#include <array>
#include <cctype>
#include <charconv>
#include <type_traits>

namespace mane::app {
namespace {

constexpr auto kSettings = std::to_array<Setting>({
    {"listen", "HOST:PORT", &Options::listen, 0, 0,
     "Where to listen; port 0 takes any free port. Off loopback this wants --tls-cert, --tls-key "
     "and "
     "--token-file"},
    {"data-dir", "DIR", &Options::data_dir, 0, 0, "Folder of grooms, jobs and results"},
    {"port-file", "FILE", &Options::port_file, 0, 0,
     "Write the port to FILE once the server listens"},
    {"workers", "N", &Options::workers, 0, 256, "Threads that compute hair; 0 is one per core"},
    {"max-heads", "N", &Options::max_heads, 1, 100'000, "Heads open at once"},
    {"max-groom-guides", "N", &Options::max_groom_guides, 1, 1'000'000, "Guides of one groom"},
    {"resume-grace-s", "S", &Options::resume_grace_s, 0, 3600,
     "How long a head waits for its broken stream to come back"},
    {"max-message-bytes", "N", &Options::max_message_bytes, 65'536, 1 << 30,
     "Largest message that a client may send"},
    {"tls-cert", "FILE", &Options::tls_cert, 0, 0, "Certificate chain (PEM); speaks TLS only"},
    {"tls-key", "FILE", &Options::tls_key, 0, 0, "The certificate's private key (PEM)"},
    {"token-file", "FILE", &Options::token_file, 0, 0,
     "File with the token that every call must carry"},
    {"insecure-non-loopback", "", &Options::insecure_non_loopback, 0, 0,
     "Listen off loopback without TLS or without a token: for private networks only"},
    {"drain-grace-s", "S", &Options::drain_grace_s, 0, 600,
     "Time that running streams get to end after SIGTERM"},
    {"log-level", "LEVEL", &Options::log_level, 0, 0, "debug, info, warning or error"},
});

template <typename T>
bool ParseNumber(std::string_view text, T& out) {
  T value{};
  const auto parsed = std::from_chars(text.data(), text.data() + text.size(), value);
  if (parsed.ec != std::errc() || parsed.ptr != text.data() + text.size()) return false;
  out = value;
  return true;
}

bool Parse(std::string_view text, std::string& out) {
  out = text;
  return true;
}
bool Parse(std::string_view text, int& out) { return ParseNumber(text, out); }
bool Parse(std::string_view text, double& out) { return ParseNumber(text, out); }
bool Parse(std::string_view text, bool& out) {
  if (text != "true" && text != "1" && text != "false" && text != "0") return false;
  out = text == "true" || text == "1";
  return true;
}

// What Parse reads.
template <typename T>
std::string Expected(const Setting& setting) {
  if (std::is_same_v<T, bool>) return "true, 1, false or 0";
  return fmt::format("a {}number from {} to {}", std::is_integral_v<T> ? "whole " : "", setting.low,
                     setting.high);
}

}  // namespace

std::string Setting::EnvironmentName() const {
  std::string result = "MANE_";
  for (const char c : name) {
    result += c == '-' ? '_' : static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  }
  return result;
}

Result<void> Setting::Assign(std::string_view text, std::string_view source,
                             Options& options) const {
  return std::visit(
      [&](auto member) -> Result<void> {
        using T = std::remove_reference_t<decltype(options.*member)>;
        if (Parse(text, options.*member)) return {};
        return InvalidArgument(std::string(name), fmt::format("{} is '{}'; it must be {}", source,
                                                              text, Expected<T>(*this)));
      },
      field);
}

std::string Setting::Format(const Options& options) const {
  return std::visit([&](auto member) { return fmt::format("{}", options.*member); }, field);
}

Result<void> Setting::CheckRange(const Options& options) const {
  return std::visit(
      [&](auto member) -> Result<void> {
        using T = std::remove_cvref_t<decltype(options.*member)>;
        if constexpr (std::is_arithmetic_v<T> && !std::is_same_v<T, bool>) {
          const auto number = static_cast<double>(options.*member);
          if (!(number >= low && number <= high)) {
            return InvalidArgument(
                std::string(name),
                fmt::format("{} is {}; it must be {}", name, options.*member, Expected<T>(*this)));
          }
        }
        return {};
      },
      field);
}

std::span<const Setting> Settings() { return kSettings; }

std::string Describe(const Options& options) {
  std::string line;
  for (const Setting& setting : Settings()) {
    const std::string text = setting.Format(options);
    const bool plain = !text.empty() && text.find_first_of(" \t\"\n") == std::string::npos;
    line += fmt::format("{}{}={}", line.empty() ? "" : " ", setting.name,
                        plain ? text : fmt::format("\"{}\"", text));
  }
  return line;
}

}  // namespace mane::app
