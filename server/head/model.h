#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "beam/motion.h"

namespace mane::head {

/// How the guides of a head are animated: mane.v1.AnimationModel.
enum class Model { kSuperHelix, kBeam };

/// What beams of a head are like: mane.v1.BeamMotion. Arrays over segments are (segments), or empty
/// for all default; see beam::MotionSettings.
struct BeamOptions {
  /// k of every guide, 2 to 64, which arrays over segments need; 0 for what the groom takes
  /// (SegmentsOf).
  int segments = 0;
  /// Factor on the stiffness that holds segments in their directions at rest (B11); 0 as published:
  /// then nothing does, not the weight of what hangs either.
  double hold = 1;
  beam::Equations equations = beam::Equations::kAcross;
  bool bounded = true;
  bool clamped = true;
  bool avoid_head = true;
  double alpha = -0.75;
  double near = 0.02;  ///< [m]
  std::vector<float> epsilon;
  std::vector<float> largest_turn;  ///< [rad]
  double fluctuation = 0;           ///< [rad]
  uint64_t seed = 0;
  /// lambda_k [1/m], of which others have their part i / k (B8); empty for 2.1 over the length of
  /// a guide's polyline where stiffness prevails, 1.45 where weight does.
  std::optional<double> tip_response;

  bool operator==(const BeamOptions&) const = default;
};

/// The model of a head and what it is like.
struct ModelOptions {
  Model model = Model::kSuperHelix;
  BeamOptions beam;
};

}  // namespace mane::head
