#include "head/frame.h"

#include <span>
#include <vector>

#include "base/check.h"
#include "head/points.h"
#include "head/shown.h"
#include "wire/frame_codec.h"

namespace mane::head {
namespace {

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

void EncodeBlockCoordinates(const groom::Groom& groom, const rod::Batch<float>::Block& block,
                            const HeadState& state, std::span<std::byte> data,
                            std::vector<double>& coordinates) {
  for (int lane = 0; lane < block.count; ++lane) {
    const int guide = block.strands[lane];
    coordinates.resize(groom.guides[guide].coordinate_count());
    groom.batch.GetCoordinates(guide, state.guides, coordinates);
    const auto bytes = data.subspan(wire::CoordinatesSize(groom.first_coordinate[guide]),
                                    wire::CoordinatesSize(coordinates.size()));
    wire::EncodeCoordinates(coordinates, bytes);
  }
}

void EncodePoints(const View& view, int guide, std::span<const Eigen::Vector3f> points,
                  std::span<std::byte> data) {
  const size_t size = GuideSize(view, 0);
  const std::span<std::byte> bytes = data.subspan(guide * size, size);
  if (view.format == FrameFormat::kPositionsFloat32) {
    wire::EncodePositions(points, bytes);
  } else {
    wire::EncodeQuantized(points, bytes);
  }
}

void EncodeBlockPositions(const groom::Groom& groom, int block, const HeadState& state,
                          const View& view, std::span<std::byte> data, PointScratch& scratch) {
  const int points = view.points_per_guide;
  const bool in_head = view.space == Space::kHead;
  if (!state.beams.active && state.transition.points == 0) {
    ForRodPoints(groom, groom.batch.blocks()[block], state.guides,
                 in_head ? math::Pose{} : state.pose, points, scratch,
                 [&](int guide, std::span<const Eigen::Vector3f> own) {
                   EncodePoints(view, guide, own, data);
                 });
    return;
  }
  const Eigen::Matrix3f back = state.pose.q.conjugate().toRotationMatrix().cast<float>();
  const Eigen::Vector3f place = state.pose.p.cast<float>();
  ForShownPoints(
      groom, state, block, points, scratch, [&](int guide, std::span<Eigen::Vector3f> own) {
        for (Eigen::Vector3f& point : own) {
          point = in_head ? Eigen::Vector3f(back * point) : Eigen::Vector3f(point + place);
        }
        EncodePoints(view, guide, own, data);
      });
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
  MANE_CHECK(!state.beams.active || view.format != FrameFormat::kGeneralized);
  std::string bytes(FrameSize(groom, view), '\0');
  const std::span<std::byte> data = std::as_writable_bytes(std::span(bytes));
  pool.ParallelFor(ShownBlocks(groom, state), kBlocksPerPiece, [&](int begin, int end) {
    thread_local std::vector<double> coordinates;
    thread_local PointScratch scratch;
    for (int i = begin; i < end; ++i) {
      if (view.format == FrameFormat::kGeneralized) {
        EncodeBlockCoordinates(groom, groom.batch.blocks()[i], state, data, coordinates);
      } else {
        EncodeBlockPositions(groom, i, state, view, data, scratch);
      }
    }
  });
  return bytes;
}

}  // namespace mane::head
