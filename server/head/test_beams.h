#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include "head/frame.h"
#include "head/head.h"
#include "head/sample_groom.h"

/// What tests of beams share.
namespace mane::head {

/// Straight, wavy, curly and wound hair, with and without a scalp.
[[nodiscard]] inline std::vector<std::shared_ptr<const groom::Groom>> TestGrooms() {
  return {SampleGroom(13, 5), GeneratedGroom(groom::HairType::kAsianSmooth, 20, 0.25, 6),
          GeneratedGroom(groom::HairType::kCaucasianWavy, 20, 0.2, 0),
          GeneratedGroom(groom::HairType::kCaucasianCurly, 20, 0.2, 0),
          GeneratedGroom(groom::HairType::kAfricanFuzzy, 20, 0.1, 0)};
}

[[nodiscard]] inline math::Pose Shaken(double t) {
  return {{0.1 * std::sin(8 * t), 0.02 * std::cos(11 * t), 0.03 * t},
          math::FromRotationVector({0.2 * std::sin(5 * t), 0.8 * std::sin(9 * t), 0})};
}

/// Goes on with a shake, at 60 Hz, for so many frames.
inline void Shake(const groom::Groom& groom, int frames, HeadState* state, exec::WorkerPool& pool) {
  const double begin = state->time;
  for (int i = 1; i <= frames; ++i) {
    Advance(groom, {Shaken(begin + i / 60.0), 1 / 60.0, 1}, {}, state, pool);
  }
}

/// What a frame of `points` a guide shows, head's axes, (guides x points) [m].
[[nodiscard]] inline std::vector<Eigen::Vector3f> Points(const groom::Groom& groom,
                                                         const HeadState& state, int points,
                                                         exec::WorkerPool& pool) {
  const std::string bytes =
      EncodeFrame(groom, state, {FrameFormat::kPositionsFloat32, Space::kHead, points}, pool);
  const auto* begin = reinterpret_cast<const Eigen::Vector3f*>(bytes.data());
  return {begin, begin + bytes.size() / sizeof(Eigen::Vector3f)};
}

/// The largest distance of two points that belong together [m].
[[nodiscard]] inline double Farthest(const std::vector<Eigen::Vector3f>& a,
                                     const std::vector<Eigen::Vector3f>& b) {
  double worst = 0;
  for (size_t i = 0; i < a.size(); ++i) worst = std::max<double>(worst, (a[i] - b[i]).norm());
  return worst;
}

/// No guide leaves its root or is longer anywhere than it is.
inline void ExpectLengths(const groom::Groom& groom, const std::vector<Eigen::Vector3f>& all,
                          int points) {
  for (int guide = 0; guide < groom.guide_count(); ++guide) {
    const Eigen::Vector3f* const own = &all[static_cast<size_t>(guide) * points];
    const double longest = groom.guides[guide].strand.TotalLength() / (points - 1);
    ASSERT_LT((own[0].cast<double>() - groom.guides[guide].root.p).norm(), 1e-5);
    for (int j = 1; j < points; ++j) {
      ASSERT_LE((own[j] - own[j - 1]).norm(), longest * (1 + 1e-4)) << guide << " " << j;
    }
  }
}

}  // namespace mane::head
