#include "head/beam_hull.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "groom/scalp_hull.h"
#include "head/kernels.h"

namespace mane::head {
namespace {

using Eigen::Vector3d;
using Row = rod::Row<float>;

constexpr int kBlocksPerPiece = 4;
// A hull is made smaller by so much more than it must be, relative.
constexpr double kHullMargin = 1e-4;
constexpr double kInstantStep = 1e-6;  // [s]

// The least (E + 1) of a guide's nodes at rest: squared scale of the hull that reaches it.
double LeastLevel(const groom::Groom& groom, const Beams& beams, const beam::Hull& hull, int guide,
                  bool root) {
  Vector3d node = groom.guides[guide].root.p;
  double least = root ? hull.At(node) : std::numeric_limits<double>::infinity();
  for (const Vector3d& e : beams.rest_of(guide)) {
    node += beams.segment_length[guide] * e;
    least = std::min(least, hull.At(node));
  }
  return least + 1;
}

}  // namespace

std::optional<beam::Hull> HullOf(const groom::Groom& groom, const Beams& beams) {
  if (std::holds_alternative<std::monostate>(groom.scalp)) return std::nullopt;
  auto hull = groom::ScalpHull(groom.scalp);
  if (!hull) return std::nullopt;  // Like a plate: nothing to stay out of.
  std::vector<double> least;
  least.reserve(groom.guides.size());
  for (int i = 0; i < groom.guide_count(); ++i) {
    least.push_back(LeastLevel(groom, beams, *hull, i, true));
  }
  const auto rank = static_cast<std::ptrdiff_t>(kInHull * groom.guide_count());
  std::ranges::nth_element(least, least.begin() + rank);
  if (!(least[rank] > 0)) return std::nullopt;
  if (least[rank] < 1) hull->radii *= std::sqrt(least[rank]) * (1 - kHullMargin);
  return *hull;
}

std::vector<int> GuidesInside(const groom::Groom& groom, const Beams& beams,
                              const beam::Hull& hull) {
  std::vector<int> inside;
  for (int i = 0; i < groom.guide_count(); ++i) {
    if (LeastLevel(groom, beams, hull, i, false) < 1) inside.push_back(i);
  }
  return inside;
}

void KeepOut(const Beams& beams, const math::Pose& head, std::vector<Vector3d>* directions,
             exec::WorkerPool& pool) {
  const auto k = static_cast<size_t>(beams.segments);
  const auto own = [&](int hair) { return std::span(*directions).subspan(hair * k, k); };
  std::vector<Row> rows = beams.rest;
  beam::MotionDrive drive;
  drive.head = head;
  drive.velocity = drive.velocity_before = drive.spin = drive.spin_before = Vector3d::Zero();
  drive.gravity = Vector3d::Zero();
  drive.duration = kInstantStep;
  drive.drag_scale = drive.friction_scale = 0;
  drive.frame = 1;  // Nothing is drawn.
  const std::array<Row, 3> air{};
  pool.ParallelFor(beams.batch.blocks(), kBlocksPerPiece, [&](int first, int last) {
    for (int block = first; block < last; ++block) {
      const int begin = block * simd::kLanes,
                end = std::min(begin + simd::kLanes, beams.batch.hair_count());
      for (int i = begin; i < end; ++i) beams.batch.SetHair(i, own(i), {}, kInstantStep, rows);
      beams.batch.Step(BeamKernels(), block, drive, air, rows);
      for (int i = begin; i < end; ++i) beams.batch.GetHair(i, kInstantStep, rows, own(i), {});
    }
  });
}

}  // namespace mane::head
