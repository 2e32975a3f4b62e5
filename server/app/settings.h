#pragma once

#include <span>
#include <string>
#include <string_view>
#include <variant>

#include "app/options.h"
#include "base/result.h"

namespace mane::app {

/// One field of Options as operators see it. The table of all settings is the only place that names
/// them: flags, environment variables, keys of the configuration file and --help follow from it.
struct Setting {
  using Field =
      std::variant<std::string Options::*, int Options::*, double Options::*, bool Options::*>;

  std::string_view name;   ///< Flag and key, `max-heads`.
  std::string_view value;  ///< What stands for the value in --help, `N`; empty for a switch.
  Field field;
  double low = 0;  ///< Allowed range of a number, ends included.
  double high = 0;
  std::string_view help;

  /// `MANE_MAX_HEADS`.
  [[nodiscard]] std::string EnvironmentName() const;
  [[nodiscard]] bool is_switch() const { return std::holds_alternative<bool Options::*>(field); }

  /// Reads `text` into the field of `options`. kInvalidArgument when it is not of the field's type;
  /// `source` says where the text came from, `MANE_MAX_HEADS`.
  [[nodiscard]] Result<void> Assign(std::string_view text, std::string_view source,
                                    Options& options) const;
  /// The field as text that Assign reads.
  [[nodiscard]] std::string Format(const Options& options) const;
  /// kInvalidArgument when the field is a number outside [low, high].
  [[nodiscard]] Result<void> CheckRange(const Options& options) const;
};

/// All settings, in the order of --help.
[[nodiscard]] std::span<const Setting> Settings();

/// All settings and their values on one line, `listen=127.0.0.1:7420 data-dir=... `, for the log.
[[nodiscard]] std::string Describe(const Options& options);

}  // namespace mane::app
