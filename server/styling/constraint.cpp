#include "styling/constraint.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/check.h"
#include "base/text.h"
#include "groom/range.h"

namespace mane::styling {
namespace {

using Eigen::Vector3d;

constexpr long kMostQueues = 2560;  // Of the style's own 256, and of 256 braids.
constexpr long kMostConstraints = 64;
constexpr size_t kMostPoints = 4096;
constexpr groom::Range kCoordinate{-100, 100, "m"};
constexpr groom::Range kRadius{0, 10, "m", true};
constexpr groom::Range kWeight{0, 1};
constexpr double kLeastPiece = 1e-6;  // Of a path [m].

Result<void> CheckPath(const Constraint& constraint, const std::string& field) {
  const std::vector<Vector3d>& path = constraint.path;
  const bool one = constraint.kind == Constraint::Kind::kPoint;
  if (one ? path.size() != 1 : path.size() < 2 || path.size() > kMostPoints) {
    return InvalidArgument(field,
                           fmt::format("{} has {} points; it must have {}", field, path.size(),
                                       one ? "one" : fmt::format("2 to {}", kMostPoints)));
  }
  for (size_t i = 0; i < path.size(); ++i) {
    const std::string name = fmt::format("{}[{}]", field, i);
    if (auto finite = groom::CheckVector(name, path[i], kCoordinate); !finite) return finite;
    if (i > 0 && (path[i] - path[i - 1]).norm() < kLeastPiece) {
      return InvalidArgument(
          name, fmt::format("{} lies within {} m of the point before it", name, kLeastPiece));
    }
  }
  return {};
}

Result<void> CheckOutside(const Constraint& constraint, const Obstacles& obstacles,
                          const std::string& field) {
  if (constraint.kind == Constraint::Kind::kDirection) return {};
  for (size_t i = 0; i < constraint.path.size(); ++i) {
    const double distance = DistanceTo(obstacles, constraint.path[i]).distance;
    if (distance >= -constraint.radius) continue;
    const std::string name = fmt::format("{}.path[{}]", field, i);
    return InvalidArgument(
        name, fmt::format("{} lies {:.4g} m deep in an obstacle, more than the radius {} m", name,
                          -distance, constraint.radius));
  }
  return {};
}

}  // namespace

Result<void> Validate(const Constraint& constraint, const Obstacles& obstacles,
                      const std::string& field) {
  if (constraint.kind < Constraint::Kind::kPoint ||
      constraint.kind > Constraint::Kind::kDirection) {
    return InvalidArgument(field + ".kind", field + ".kind is none of the kinds of constraints");
  }
  if (auto path = CheckPath(constraint, field + ".path"); !path) return path;
  if (!kRadius.Contains(constraint.radius)) {
    return groom::OutOfRange(field + ".radius_m", constraint.radius, kRadius);
  }
  if (!kWeight.Contains(constraint.weight)) {
    return groom::OutOfRange(field + ".weight", constraint.weight, kWeight);
  }
  return CheckOutside(constraint, obstacles, field);
}

Result<void> Validate(const std::vector<ConstraintQueue>& queues, const Obstacles& obstacles,
                      const std::string& field) {
  const auto count = static_cast<long>(queues.size());
  if (count > kMostQueues) return groom::TooMany(field, "queues", count, kMostQueues);
  for (size_t q = 0; q < queues.size(); ++q) {
    const std::string name = fmt::format("{}[{}].constraints", field, q);
    const std::vector<Constraint>& constraints = queues[q].constraints;
    const auto length = static_cast<long>(constraints.size());
    if (length == 0) return InvalidArgument(name, name + " is empty");
    if (length > kMostConstraints) {
      return groom::TooMany(name, "constraints", length, kMostConstraints);
    }
    for (size_t i = 0; i < constraints.size(); ++i) {
      const auto valid = Validate(constraints[i], obstacles, fmt::format("{}[{}]", name, i));
      if (!valid) return valid;
    }
  }
  return {};
}

Result<void> ValidateSelections(const std::vector<ConstraintQueue>& queues,
                                const std::vector<std::vector<uint32_t>>& selected, int wisps,
                                const std::string& field) {
  MANE_CHECK(selected.size() == queues.size());
  std::vector<int> owner(static_cast<size_t>(wisps), -1);
  for (size_t q = 0; q < queues.size(); ++q) {
    for (const uint32_t wisp : selected[q]) {
      MANE_CHECK(wisp < owner.size());
      const int before = owner[wisp];
      owner[wisp] = static_cast<int>(q);
      if (before < 0) continue;
      const std::string name = fmt::format("{}[{}].selection", field, q);
      const std::string& other = queues[static_cast<size_t>(before)].name;
      return InvalidArgument(
          name, fmt::format("wisp {} is selected by {}[{}] ({}) and by {}[{}] ({}); a wisp may be "
                            "in one queue only",
                            wisp, field, before, base::Shown(other), field, q,
                            base::Shown(queues[q].name)));
    }
  }
  return {};
}

Path::Path(const std::vector<Vector3d>& points) : points_(points), arcs_{0} {
  for (size_t i = 1; i < points.size(); ++i) {
    const Vector3d piece = points[i] - points[i - 1];
    arcs_.push_back(arcs_.back() + piece.norm());
    tangents_.push_back(piece.normalized());
  }
  if (tangents_.empty()) tangents_.emplace_back(Vector3d::Zero());
}

size_t Path::PieceAt(double arc) const {
  const auto above = std::upper_bound(arcs_.begin(), arcs_.end(), arc);
  const auto piece = std::max<ptrdiff_t>(above - arcs_.begin() - 1, 0);
  return std::min(static_cast<size_t>(piece), tangents_.size() - 1);
}

Vector3d Path::TangentAt(double arc) const { return tangents_[PieceAt(arc)]; }

PathPlace Path::Nearest(const Vector3d& x, double begin, double end) const {
  PathPlace nearest{points_.front(), tangents_.front(), 0, (x - points_.front()).norm()};
  if (points_.size() == 1) return nearest;
  nearest.distance = HUGE_VAL;
  for (size_t i = PieceAt(begin); i < tangents_.size() && arcs_[i] <= end; ++i) {
    const double low = std::max(begin - arcs_[i], 0.0);
    const double high = std::min(end, arcs_[i + 1]) - arcs_[i];
    const double s = std::max(low, std::min(high, (x - points_[i]).dot(tangents_[i])));
    const Vector3d point = points_[i] + s * tangents_[i];
    const double distance = (x - point).norm();
    if (distance < nearest.distance) nearest = {point, tangents_[i], arcs_[i] + s, distance};
  }
  return nearest;
}

Vector3d Psi(const Constraint& constraint, const Path& path, const PathPlace& place,
             const Vector3d& x, double segment_length) {
  const Vector3d back = place.point - x;
  switch (constraint.kind) {
    case Constraint::Kind::kPoint:
      return back.stableNormalized();
    case Constraint::Kind::kDirection:
      return place.distance <= constraint.radius ? place.tangent : Vector3d::Zero();
    case Constraint::Kind::kTrajectory: {
      // A segment cannot aim finer than its own length.
      const double a = std::max(constraint.radius, segment_length);
      if (place.distance > a || place.arc >= path.length()) return back.stableNormalized();
      return (path.TangentAt(place.arc + segment_length / 2) + back / a).stableNormalized();
    }
  }
  return Vector3d::Zero();
}

}  // namespace mane::styling
