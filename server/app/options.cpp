#include "app/options.h"

#include <algorithm>
#include <array>
#include <charconv>

#include "app/settings.h"

namespace mane::app {
namespace {

Result<void> CheckListen(const std::string& listen) {
  const size_t colon = listen.rfind(':');
  int port = -1;
  if (colon != std::string::npos && colon > 0) {
    const char* end = listen.data() + listen.size();
    const auto parsed = std::from_chars(listen.data() + colon + 1, end, port);
    if (parsed.ec != std::errc() || parsed.ptr != end) port = -1;
  }
  if (port >= 0 && port <= 65535) return {};
  return InvalidArgument(
      "listen", fmt::format("listen is '{}'; it must be host:port with a port from 0 to 65535, "
                            "such as 127.0.0.1:7420 or [::1]:7420",
                            listen));
}

Result<void> CheckExposure(const Options& options) {
  if (options.tls_cert.empty() != options.tls_key.empty()) {
    const bool has_cert = !options.tls_cert.empty();
    const char* given = has_cert ? "tls-cert" : "tls-key";
    const char* missing = has_cert ? "tls-key" : "tls-cert";
    return InvalidArgument(missing,
                           fmt::format("{} is set without {}; TLS needs both", given, missing));
  }
  if (!options.token_file.empty() && options.tls_cert.empty()) {
    return InvalidArgument(
        "token-file",
        "token-file is set without tls-cert and tls-key; a token that travels in "
        "plain text is no secret");
  }
  const bool guarded = !options.token_file.empty();
  if (IsLoopback(options.listen) || guarded || options.insecure_non_loopback) return {};
  return InvalidArgument(
      "listen",
      fmt::format("listen is '{}', which other machines can reach: give tls-cert, tls-key "
                  "and token-file, or listen on 127.0.0.1, or set insecure-non-loopback "
                  "where the network itself is private",
                  options.listen));
}

}  // namespace

bool IsLoopback(std::string_view listen) {
  const std::string_view host = listen.substr(0, listen.rfind(':'));
  if (host == "localhost" || host == "[::1]") return true;
  const bool numbers = std::all_of(host.begin(), host.end(),
                                   [](char c) { return c == '.' || (c >= '0' && c <= '9'); });
  return numbers && host.starts_with("127.") && std::count(host.begin(), host.end(), '.') == 3;
}

Result<void> Options::Validate() const {
  for (const Setting& setting : Settings()) {
    if (Result<void> in_range = setting.CheckRange(*this); !in_range) return in_range;
  }
  if (Result<void> usable = CheckListen(listen); !usable) return usable;
  if (Result<void> safe = CheckExposure(*this); !safe) return safe;
  if (data_dir.empty()) return InvalidArgument("data-dir", "data-dir is empty; name a folder");
  constexpr std::array kLevels = {"debug", "info", "warning", "error"};
  if (std::find(kLevels.begin(), kLevels.end(), log_level) == kLevels.end()) {
    return InvalidArgument(
        "log-level",
        fmt::format("log-level is '{}'; it must be debug, info, warning or error", log_level));
  }
  return {};
}

}  // namespace mane::app
