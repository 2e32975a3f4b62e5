#pragma once

#include <cstddef>
#include <string>

#include "head/head.h"

namespace mane::head {

/// Layouts of a frame's numbers; proto/mane/v1/animation.proto FrameFormat says each byte.
enum class FrameFormat { kPositionsFloat32, kPositionsQuantized16, kGeneralized };

/// Frame of a frame's positions: the world, or the head at its pose.
enum class Space { kWorld, kHead };

/// What a client wants to see of a head.
struct View {
  FrameFormat format = FrameFormat::kPositionsFloat32;
  Space space = Space::kWorld;
  int points_per_guide = 16;  ///< Points at equal arc length, root and tip included, >= 2.
};

/// Bytes of every frame of a groom seen by `view`.
[[nodiscard]] size_t FrameSize(const groom::Groom& groom, const View& view);

/// The state as bytes; guides are encoded in parallel.
///
/// @param view  not generalized where the head's guides are beams; its points are those of a
///              transition that is under way.
[[nodiscard]] std::string EncodeFrame(const groom::Groom& groom, const HeadState& state,
                                      const View& view, exec::WorkerPool& pool);

}  // namespace mane::head
