#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "mane/error.h"
#include "mane/head.h"
#include "mane/v1/animation.pb.h"
#include "mane/v1/groom.pb.h"
#include "math/rigid.h"

namespace mane::inline client {

/// What a guide's shape is rebuilt from.
struct GuideGeometry {
  math::Pose root;                      ///< Head frame; unit quaternion.
  std::vector<double> element_lengths;  ///< [m], root to tip.
  bool wound = false;                   ///< Of StrandModel::kWound.
  /// Natural twist and curvatures of a wound guide's elements [rad/m], (N); else empty.
  std::vector<Eigen::Vector3d> natural = {};

  /// Numbers that describe its shape: FRAME_FORMAT_GENERALIZED.
  [[nodiscard]] std::size_t coordinates() const { return (wound ? 4 : 3) * element_lengths.size(); }

  /// Whether a shape can be rebuilt from it: elements, of a wound guide with natural curvature.
  [[nodiscard]] bool usable() const;

  static GuideGeometry From(const v1::Guide& guide);
};

/// Turns the frames of one opened head into public ones, whatever their format. Immutable and
/// thread-safe.
class FrameDecoder {
 public:
  /// @param guides  the groom's guides in order; needed only for FRAME_FORMAT_GENERALIZED.
  /// @return kInternal when the guides do not fit what `opened` says, or have no shape.
  static Result<std::shared_ptr<const FrameDecoder>> Create(
      const v1::Opened& opened, std::shared_ptr<const std::vector<GuideGeometry>> guides);

  /// kInternal when `frame.data` does not have the size that the format gives it.
  Result<std::shared_ptr<const Frame>> Decode(const v1::HairFrame& frame) const;

 private:
  FrameDecoder() = default;

  std::size_t DataSize() const;
  void DecodeStrands(const v1::HairFrame& frame, Frame& out) const;
  void Reconstruct(const v1::HairFrame& frame, Frame& out) const;

  v1::FrameFormat format_ = v1::FRAME_FORMAT_POSITIONS_FLOAT32;
  v1::Space space_ = v1::SPACE_WORLD;
  std::uint32_t guide_count_ = 0;
  std::size_t coordinates_ = 0;  // Of all guides, for FRAME_FORMAT_GENERALIZED.
  std::uint32_t points_ = 0;
  std::shared_ptr<const std::vector<GuideGeometry>> guides_;
};

}  // namespace mane::inline client
