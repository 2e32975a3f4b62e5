#pragma once

namespace mane::contact::fixtures {

inline constexpr double kDt = 1.0 / 60;  ///< Of the steps of tests that do not vary it [s].

}  // namespace mane::contact::fixtures
