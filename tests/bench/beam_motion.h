#pragma once

namespace mane {

/// What moving hair by beam/motion.h takes, medians. Hair grows on the upper half of a hull that it
/// is kept out of and is held in its style, with drag, while the head shakes; a frame is one step
/// of all hairs and their nodes in memory, at 20 segments a hair.
struct MotionSpeed {
  double frame_20k_ms_one_core;  ///< 20,000 hairs by one thread.
  double frame_50k_ms;           ///< 50,000 hairs by two workers.
  /// Time grows as hairs (1,250 to 20,000), as segments (10 to 160), to the power of these.
  double exponent_over_hairs, exponent_over_segments;
};

[[nodiscard]] MotionSpeed TimeMotion();

}  // namespace mane
