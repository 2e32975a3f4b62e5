#include "head/frame.h"

#include <array>
#include <span>
#include <vector>

#include "base/check.h"
#include "head/kernels.h"
#include "wire/frame_codec.h"

namespace mane::head {
namespace {

using PoseRows = std::array<rod::Row<float>, rod::layout::kPoseRows>;

constexpr int kBlocksPerPiece = 4;

// Bytes of one guide of so many coordinates.
size_t GuideSize(const View& view, size_t coordinates) {
  switch (view.format) {
    case FrameFormat::kPositionsFloat32:
      return wire::PositionsSize(view.points_per_guide);
    case FrameFormat::kPositionsQuantized16:
      return wire::QuantizedSize(view.points_per_guide);
    case FrameFormat::kGeneralized:
      return wire::CoordinatesSize(coordinates);
  }
  MANE_CHECK(false);
}

// One worker's memory.
struct Scratch {
  std::vector<rod::Row<float>> positions;  // (points x 3)
  std::vector<Eigen::Vector3f> points;
  std::vector<double> coordinates;
};

void EncodeBlockCoordinates(const groom::Groom& groom, const rod::Batch<float>::Block& block,
                            const HeadState& state, std::span<std::byte> data, Scratch& scratch) {
  for (int lane = 0; lane < block.count; ++lane) {
    const int guide = block.strands[lane];
    scratch.coordinates.resize(groom.guides[guide].coordinate_count());
    groom.batch.GetCoordinates(guide, state.guides, scratch.coordinates);
    const auto bytes = data.subspan(wire::CoordinatesSize(groom.first_coordinate[guide]),
                                    wire::CoordinatesSize(scratch.coordinates.size()));
    wire::EncodeCoordinates(scratch.coordinates, bytes);
  }
}

void EncodeBlockPositions(const groom::Groom& groom, const rod::Batch<float>::Block& block,
                          const HeadState& state, const PoseRows& pose, const View& view,
                          std::span<std::byte> data, Scratch& scratch) {
  const int points = view.points_per_guide;
  const size_t size = GuideSize(view, 0);
  scratch.positions.resize(static_cast<size_t>(3) * points);
  scratch.points.resize(points);
  Kernels()
      .Of(block.kind)
      .sample(block.elements, groom.batch.constants(block), pose[0].lane,
              state.guides[block.state].lane, points, scratch.positions[0].lane);
  for (int lane = 0; lane < block.count; ++lane) {
    const rod::Row<float>* row = scratch.positions.data();
    for (Eigen::Vector3f& point : scratch.points) {
      point = {row[0].lane[lane], row[1].lane[lane], row[2].lane[lane]};
      row += 3;
    }
    const std::span<std::byte> bytes = data.subspan(block.strands[lane] * size, size);
    if (view.format == FrameFormat::kPositionsFloat32) {
      wire::EncodePositions(scratch.points, bytes);
    } else {
      wire::EncodeQuantized(scratch.points, bytes);
    }
  }
}

}  // namespace

size_t FrameSize(const groom::Groom& groom, const View& view) {
  if (view.format == FrameFormat::kGeneralized) {
    return wire::CoordinatesSize(groom.coordinate_count());
  }
  return groom.guide_count() * GuideSize(view, 0);
}

std::string EncodeFrame(const groom::Groom& groom, const HeadState& state, const View& view,
                        exec::WorkerPool& pool) {
  MANE_CHECK(view.points_per_guide >= 2);
  std::string bytes(FrameSize(groom, view), '\0');
  const std::span<std::byte> data = std::as_writable_bytes(std::span(bytes));
  PoseRows pose;
  rod::SetPose<float>(view.space == Space::kHead ? math::Pose{} : state.pose, 0,
                      rod::layout::kLanes, pose);
  const auto blocks = groom.batch.blocks();
  pool.ParallelFor(static_cast<int>(blocks.size()), kBlocksPerPiece, [&](int begin, int end) {
    thread_local Scratch scratch;
    for (int i = begin; i < end; ++i) {
      if (view.format == FrameFormat::kGeneralized) {
        EncodeBlockCoordinates(groom, blocks[i], state, data, scratch);
      } else {
        EncodeBlockPositions(groom, blocks[i], state, pose, view, data, scratch);
      }
    }
  });
  return bytes;
}

}  // namespace mane::head
