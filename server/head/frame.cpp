#include "head/frame.h"

#include <span>
#include <vector>

#include "base/check.h"
#include "wire/frame_codec.h"
#include "wire/reconstruct.h"

namespace mane::head {
namespace {

constexpr int kGuidesPerPiece = 32;

// Bytes of one guide of N elements.
size_t GuideSize(const View& view, size_t N) {
  switch (view.format) {
    case FrameFormat::kPositionsFloat32:
      return wire::PositionsSize(view.points_per_guide);
    case FrameFormat::kPositionsQuantized16:
      return wire::QuantizedSize(view.points_per_guide);
    case FrameFormat::kGeneralized:
      return wire::AnglesSize(N);
  }
  MANE_CHECK(false);
}

void EncodeGuide(const groom::Guide& guide, std::span<const Eigen::Vector3d> theta,
                 const math::Pose& pose, const View& view, std::span<std::byte> data) {
  if (view.format == FrameFormat::kGeneralized) return wire::EncodeAngles(theta, data);
  thread_local std::vector<Eigen::Vector3f> points;
  points.resize(view.points_per_guide);
  const math::Pose root = view.space == Space::kHead ? guide.root : pose * guide.root;
  wire::SamplePoints(root, guide.strand.length, theta, std::span(points));
  if (view.format == FrameFormat::kPositionsFloat32) {
    wire::EncodePositions(points, data);
  } else {
    wire::EncodeQuantized(points, data);
  }
}

}  // namespace

size_t FrameSize(const groom::Groom& groom, const View& view) {
  if (view.format == FrameFormat::kGeneralized) return wire::AnglesSize(groom.element_count());
  return groom.guide_count() * GuideSize(view, 0);
}

std::string EncodeFrame(const groom::Groom& groom, const HeadState& state, const View& view,
                        exec::WorkerPool& pool) {
  MANE_CHECK(view.points_per_guide >= 2);
  std::string bytes(FrameSize(groom, view), '\0');
  const std::span<std::byte> data = std::as_writable_bytes(std::span(bytes));
  pool.ParallelFor(groom.guide_count(), kGuidesPerPiece, [&](int begin, int end) {
    for (int i = begin; i < end; ++i) {
      const size_t first = groom.first_element[i], N = groom.first_element[i + 1] - first;
      const size_t size = GuideSize(view, N);
      const size_t offset =
          view.format == FrameFormat::kGeneralized ? wire::AnglesSize(first) : i * size;
      EncodeGuide(groom.guides[i], std::span(state.theta).subspan(first, N), state.pose, view,
                  data.subspan(offset, size));
    }
  });
  return bytes;
}

}  // namespace mane::head
