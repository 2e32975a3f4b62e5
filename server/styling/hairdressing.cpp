#include "styling/hairdressing.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/check.h"
#include "styling/constraint.h"
#include "styling/equal.h"
#include "styling/spline.h"

namespace mane::styling {
namespace {

constexpr int kPointsPerPeriod = 16;
constexpr size_t kMostPoints = 1000;

// The queue of hair of `region`, if none dealt out into shares.
ConstraintQueue& QueueOf(const Operation& operation, const char* name, Style* style) {
  const Region& region = operation.region;
  for (ConstraintQueue& queue : style->queues) {
    if (queue.share_count <= 1 && queue.selection == region) return queue;
  }
  style->queues.push_back({name, operation.source, region, 0, 1, {}});
  return style->queues.back();
}

struct Dresser {
  const Operation& operation;
  Style* style;

  void operator()(const Operation::Trim& trim) const {
    style->cuts.push_back({operation.region, trim.length, trim.plane});
  }
  void operator()(const Operation::Wave& wave) const {
    style->regional.push_back({operation.region, wave.synthesis});
  }
  void operator()(const Operation::Comb& comb) const {
    QueueOf(operation, "comb", style)
        .constraints.push_back({Constraint::Kind::kDirection, comb.path, comb.radius, comb.weight});
  }
  void operator()(const Operation::Tie& tie) const {
    QueueOf(operation, "tie", style)
        .constraints.push_back({Constraint::Kind::kPoint, {tie.point}, tie.radius, 1});
  }
  void operator()(const Operation::Braid& braid) const {
    // What led the hair so far leads each of its parts.
    const Region& region = operation.region;
    ConstraintQueue before{"braid", operation.source, region, 0, 1, {}};
    const auto same = std::find_if(style->queues.begin(), style->queues.end(),
                                   [&region](const ConstraintQueue& queue) {
                                     return queue.share_count <= 1 && queue.selection == region;
                                   });
    if (same != style->queues.end()) {
      before.constraints = same->constraints;
      style->queues.erase(same);
    }
    // Farther on than the strands' own ends, which lie beside the axis.
    const Eigen::Vector3d last = braid.path.back() - braid.path[braid.path.size() - 2];
    const Eigen::Vector3d end = braid.path.back() + braid.radius * last.normalized();
    for (int strand = 0; strand < braid.strand_count; ++strand) {
      ConstraintQueue queue = before;
      queue.share = strand;
      queue.share_count = braid.strand_count;
      const std::vector<Eigen::Vector3d> path =
          BraidStrand(braid.path, strand, braid.strand_count, braid.radius, braid.period);
      // A strand of a braid takes about half of the braid's radius.
      const double tolerance = braid.radius / 2;
      queue.constraints.push_back({Constraint::Kind::kPoint, {path.front()}, tolerance, 1});
      queue.constraints.push_back({Constraint::Kind::kTrajectory, path, tolerance, 1});
      // What hangs out of it is tied together.
      queue.constraints.push_back({Constraint::Kind::kPoint, {end}, tolerance, 1});
      style->queues.push_back(std::move(queue));
    }
  }
};

}  // namespace

void Dress(const Operation& operation, Style* style) {
  std::visit(Dresser{operation, style}, operation.what);
}

std::vector<Eigen::Vector3d> BraidStrand(const std::vector<Eigen::Vector3d>& axis, int strand,
                                         int strand_count, double radius, double period) {
  MANE_CHECK(axis.size() >= 2 && strand_count >= 1 && period > 0);
  const Path path(axis);
  const auto count =
      std::clamp(static_cast<size_t>(std::ceil(path.length() / period * kPointsPerPeriod)) + 1,
                 axis.size(), kMostPoints);

  std::vector<Eigen::Vector3d> strand_axis = Resample(axis, static_cast<int>(count));
  // The first side lies across the head's front, so that a braid down the back is broad seen from
  // behind; then it is carried along.
  Eigen::Vector3d tangent = path.TangentAt(0);
  Eigen::Vector3d side = Eigen::Vector3d::UnitX() - tangent * tangent.x();
  if (side.norm() < 1e-3) side = tangent.unitOrthogonal();
  for (size_t i = 0; i < count; ++i) {
    const double t = path.length() * static_cast<double>(i) / static_cast<double>(count - 1);
    const Eigen::Vector3d next = path.TangentAt(t);
    side = (Eigen::Quaterniond::FromTwoVectors(tangent, next) * side).normalized();
    tangent = next;
    const double phi =
        2 * std::numbers::pi * (t / period + static_cast<double>(strand) / strand_count);
    strand_axis[i] += radius * (std::sin(phi) * side + std::sin(2 * phi) / 2 * tangent.cross(side));
  }
  return strand_axis;
}

}  // namespace mane::styling
