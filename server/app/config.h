#pragma once

#include <functional>
#include <optional>
#include <span>
#include <string>

#include "app/options.h"
#include "base/result.h"

namespace mane::app {

/// What one start of the program is asked to do.
struct Invocation {
  enum class Action {
    kServe,
    kCheckHealth,  ///< Ask the server at `options.listen`, and say by the exit code.
    kPrint,        ///< Print `text`: --help or --version.
  };
  Action action = Action::kServe;
  std::string text;
  Options options;  ///< Validated when `action` is kServe.
};

/// The value of an environment variable, or none.
using Environment = std::function<std::optional<std::string>(const std::string& name)>;

/// Reads flags, environment and configuration file. Precedence: flag, then environment (MANE_*),
/// then file (--config FILE or MANE_CONFIG; TOML, with the names of the flags as keys), then
/// default.
///
/// kInvalidArgument for an unknown flag or key, a value of the wrong type or out of range;
/// kUnavailable for a file that cannot be read. The message names what and where.
[[nodiscard]] Result<Invocation> ReadInvocation(std::span<const char* const> arguments,
                                                const Environment& environment);

}  // namespace mane::app
