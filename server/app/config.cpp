#include "app/config.h"

#include <toml++/toml.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <filesystem>
#include <map>
#include <sstream>

#include "app/settings.h"

namespace mane::app {
namespace {

// A setting's name and the text it was given.
using Texts = std::map<std::string, std::string, std::less<>>;

constexpr const char* kFooter = R"(
Every setting can also come from the environment (MANE_MAX_HEADS=200) or from a TOML file given by
--config or MANE_CONFIG (max-heads = 200). A flag wins over the environment, that over the file.
MANE_ISA=scalar, neon, avx2 or avx512 holds the kernels to one instruction set; without it they
take the fastest that this machine has.

Examples:
  maned                                         serve this machine on 127.0.0.1:7420
  maned --listen 127.0.0.1:0 --port-file port   take a free port and write it to the file `port`
  maned --health-check                          exit 0 when the server on 127.0.0.1:7420 serves
  maned --listen 0.0.0.0:7420 --tls-cert cert.pem --tls-key key.pem --token-file token
                                                serve other machines

SIGTERM or SIGINT drains: no new streams, running ones get --drain-grace-s to end.)";

// The definition of the command line and what it was given.
class CommandLine {
 public:
  CommandLine() {
    app_.set_version_flag("--version", "maned " MANE_VERSION, "Print the version and exit.");
    app_.set_help_flag("-h,--help", "Print this page and exit.");
    app_.footer(kFooter);
    app_.add_option("--config", config_, "Read settings from FILE (TOML).\nMANE_CONFIG")
        ->type_name("FILE");
    app_.add_flag("--health-check", health_check_,
                  "Ask the server at --listen whether it serves; exit 0 if so, 1 if not.");
    for (const Setting& setting : Settings()) Add(setting);
  }

  // The text to print for --help or --version, or none. InvalidArgument for an unknown flag.
  Result<std::optional<std::string>> Parse(std::span<const char* const> arguments) {
    try {
      app_.parse(static_cast<int>(arguments.size()), arguments.data());
    } catch (const CLI::CallForVersion& call) {
      return std::optional(std::string(call.what()) + "\n");
    } catch (const CLI::CallForHelp&) {
      return std::optional(app_.help());
    } catch (const CLI::ParseError& error) {
      return InvalidArgument("", fmt::format("{}; see maned --help", error.what()));
    }
    return std::optional<std::string>();
  }

  [[nodiscard]] bool health_check() const { return health_check_; }
  [[nodiscard]] const std::string& config() const { return config_; }

  // The settings that flags gave.
  [[nodiscard]] const Texts& given() const { return given_; }

 private:
  void Add(const Setting& setting) {
    const std::string name(setting.name);
    const std::string initial = setting.Format(Options());
    std::string help = fmt::format("{}.\n{}", setting.help, setting.EnvironmentName());
    if (setting.high > 0) help += fmt::format(", {:.16g} to {:.16g}", setting.low, setting.high);
    if (setting.is_switch()) {
      app_.add_flag_callback(
          "--" + name, [this, name] { given_[name] = "true"; }, help);
      return;
    }
    if (!initial.empty()) help += fmt::format(", default {}", initial);
    const auto store = [this, name](const std::string& text) { given_[name] = text; };
    app_.add_option_function<std::string>("--" + name, store, help)
        ->type_name(std::string(setting.value));
  }

  CLI::App app_{"Mane animates hair for many heads at once and streams it to clients over gRPC.",
                "maned"};
  std::string config_;
  bool health_check_ = false;
  Texts given_;
};

Error FileError(const std::string& path, const std::string& message) {
  return InvalidArgument("config", fmt::format("{}: {}", path, message));
}

// A number, string or boolean of the file as text; none for anything else.
std::optional<std::string> TextOf(const toml::node& node) {
  if (const auto text = node.value_exact<std::string>()) return text;
  if (const auto flag = node.value_exact<bool>()) return *flag ? "true" : "false";
  if (const auto whole = node.value_exact<int64_t>()) return std::to_string(*whole);
  if (const auto number = node.value_exact<double>()) return fmt::format("{}", *number);
  return std::nullopt;
}

Result<Texts> ReadFile(const std::string& path) {
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(path, ignored)) {
    return Error{ErrorCode::kUnavailable, fmt::format("{} cannot be read", path), "config"};
  }
  toml::table table;
  try {
    table = toml::parse_file(path);
  } catch (const toml::parse_error& error) {
    std::ostringstream where;
    where << "line " << error.source().begin.line << ": " << error.description();
    return FileError(path, where.str());
  }
  Texts texts;
  for (const auto& [key, node] : table) {
    const std::string name(key.str());
    const auto known = [&](const Setting& setting) { return setting.name == name; };
    if (std::none_of(Settings().begin(), Settings().end(), known)) {
      return FileError(path, fmt::format("'{}' is no setting; see maned --help", name));
    }
    const std::optional<std::string> text = TextOf(node);
    if (!text) return FileError(path, fmt::format("{} must be a string, number or boolean", name));
    texts[name] = *text;
  }
  return texts;
}

// The text of `setting` from the source that wins, and that source's name for it; none if unset.
std::optional<std::pair<std::string, std::string>> Find(const Setting& setting, const Texts& flags,
                                                        const Environment& environment,
                                                        const Texts& file,
                                                        const std::string& path) {
  if (const auto flag = flags.find(setting.name); flag != flags.end()) {
    return std::pair(flag->second, fmt::format("--{}", setting.name));
  }
  const std::string variable = setting.EnvironmentName();
  if (auto text = environment(variable)) return std::pair(*std::move(text), variable);
  if (const auto entry = file.find(setting.name); entry != file.end()) {
    return std::pair(entry->second, fmt::format("{}: {}", path, setting.name));
  }
  return std::nullopt;
}

}  // namespace

Result<Invocation> ReadInvocation(std::span<const char* const> arguments,
                                  const Environment& environment) {
  CommandLine line;
  const Result<std::optional<std::string>> text = line.Parse(arguments);
  if (!text) return text.error();
  if (*text) return Invocation{Invocation::Action::kPrint, **text, {}};

  std::string path = line.config();
  if (path.empty()) path = environment("MANE_CONFIG").value_or("");
  Texts file;
  if (!path.empty()) {
    Result<Texts> read = ReadFile(path);
    if (!read) return read.error();
    file = *std::move(read);
  }

  Invocation invocation;
  if (line.health_check()) invocation.action = Invocation::Action::kCheckHealth;
  for (const Setting& setting : Settings()) {
    const auto found = Find(setting, line.given(), environment, file, path);
    if (!found) continue;
    const Result<void> set = setting.Assign(found->first, found->second, invocation.options);
    if (!set) return set.error();
  }
  if (invocation.action == Invocation::Action::kServe) {
    if (const Result<void> valid = invocation.options.Validate(); !valid) return valid.error();
  }
  return invocation;
}

}  // namespace mane::app
