#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "head/diagnostics.h"
#include "head/model.h"
#include "math/rigid.h"

namespace mane::session {

/// One computed frame of a head; immutable, shared by whoever sends it.
struct Frame {
  uint64_t index = 0;           ///< 1, 2, 3 ... in the order of computation.
  double time = 0;              ///< Client's clock [s]: the moment that the pose belongs to.
  math::Pose pose;              ///< head -> world.
  std::string data;             ///< head::EncodeFrame's bytes.
  double newest_pose_time = 0;  ///< Newest pose known then, client's clock [s].
  double step_seconds = 0;      ///< Computing time.
  int repaired_guides = 0;      ///< See head::StepReport.
  int stepped_elements = 0;     ///< See head::SteppedElements.
  head::Model model = head::Model::kSuperHelix;  ///< With which it was computed.
  std::optional<head::Diagnostics> diagnostics;  ///< Where HeadOptions asks for them.
};
using FramePtr = std::shared_ptr<const Frame>;

/// A frame on its way out, and how many were dropped in its favour since the one before.
struct OutgoingFrame {
  FramePtr frame;  ///< Null when there is nothing to send.
  uint32_t skipped = 0;
};

}  // namespace mane::session
