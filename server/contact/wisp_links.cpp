#include "contact/wisp_links.h"

#include <algorithm>
#include <cmath>

#include "contact/wisp_neighbours.h"

namespace mane::contact {
namespace {

using Eigen::Vector3f;

constexpr float kLongestSegment = 0.25f;  // [m]
constexpr float kFarthest = 1e4f;  // From the origin; beyond it float32 resolves no hair [m].
constexpr float kLinkLength = 3;   // At least, by the radius of the wisp;
constexpr float kLinksAGuide = 5;  // no more of them than that, but of kLongestLink.

bool Usable(const WispPoints& points, size_t p) {
  return Within(points.Position(p), kFarthest) && Within(points.velocity[p], 1e6f) &&
         points.mass[p] >= 1e-12f && points.mass[p] <= 1e6f;
}

float Squared(float x) { return x * x; }

float Length(const WispPoints& points, size_t p) {
  return (points.Position(p + 1) - points.Position(p)).norm();
}

// The first point of a guide beyond its root.
size_t Begin(const WispPoints& points, size_t g, float root_length) {
  const auto end = static_cast<size_t>(points.first[g + 1]);
  if (!(points.radius[g] > 0)) return end;
  float arc = 0;
  for (auto p = static_cast<size_t>(points.first[g]); p + 1 < end; ++p) {
    const float length = Length(points, p);
    if (!(length <= kLongestSegment)) continue;
    if (arc >= root_length) return p;
    arc += length;
  }
  return end;
}

// Marks the segments of a guide that can take part, weighs them, and sees its points by the frame.
// Returns the first point beyond the root.
size_t Place(const WispPoints& points, size_t g, const WispStep& step, const WispFrame& frame,
             float root_length, WispNeighbours& neighbours, WispScratch& scratch) {
  const size_t begin = Begin(points, g, root_length);
  const auto end = static_cast<size_t>(points.first[g + 1]);
  for (auto p = static_cast<size_t>(points.first[g]); p < end; ++p) scratch.guide_of[p] = -1;
  const Eigen::Matrix3f R = frame.to_frame;
  float mass = 0;
  bool last = false;
  for (size_t p = begin; p < end; ++p) {
    Vector3f& place = neighbours.place[p];
    Vector3f& sweep = scratch.sweep[p];
    const bool usable = Usable(points, p);
    if (usable) {
      const Vector3f u = points.velocity[p];
      scratch.start[p] = points.Position(p) - step.h * u;
      const Vector3f r = scratch.start[p] - frame.position;
      const Vector3f w = step.dt * (u - frame.velocity - frame.spin.cross(r));
      place = R * r;
      sweep = R * w;
      if (last && (place - neighbours.place[p - 1]).squaredNorm() <= Squared(kLongestSegment)) {
        scratch.guide_of[p - 1] = static_cast<int32_t>(g);
        mass += points.mass[p - 1];
      }
    } else {
      place.setZero();
      sweep.setZero();
    }
    last = usable;
  }
  scratch.guide_mass[g] = mass;
  return begin;
}

void Measure(const WispNeighbours& neighbours, size_t l, WispScratch& scratch) {
  WispLink& link = scratch.links[l];
  const auto begin = static_cast<size_t>(link.point), end = begin + static_cast<size_t>(link.count);
  const auto& x = neighbours.place;
  const auto& last = scratch.last_place;
  const Vector3f moved = 0.5f * (x[begin] - last[begin] + x[end] - last[end]);
  const Vector3f mean_sweep = 0.5f * (scratch.sweep[begin] + scratch.sweep[end]);
  const Vector3f d = x[end] - x[begin];
  const float inverse_dd = 1 / std::max(d.squaredNorm(), 1e-12f);
  const Vector3f first = scratch.sweep[begin], last_sweep = scratch.sweep[end];
  float wobble = 0, spread = 0, ripple = 0, bulge = 0, length = 0, away = 0, sweep = 0;
  for (size_t p = begin; p <= end; ++p) {
    wobble = std::max(wobble, (x[p] - last[p] - moved).squaredNorm());
    spread = std::max(spread, (scratch.sweep[p] - mean_sweep).squaredNorm());
    away = std::max(away, (x[p] - neighbours.searched[p + l]).squaredNorm());
    sweep = std::max(sweep, scratch.sweep[p].squaredNorm());
    if (p == begin) continue;
    length = std::max(length, (x[p] - x[p - 1]).squaredNorm());
    if (p == end) continue;
    const Vector3f r = x[p] - x[begin];
    const float part = std::clamp(r.dot(d) * inverse_dd, 0.0f, 1.0f);
    bulge = std::max(bulge, (r - part * d).squaredNorm());
    ripple =
        std::max(ripple, (scratch.sweep[p] - first - part * (last_sweep - first)).squaredNorm());
  }
  LinkMotion& motion = scratch.motions[l];
  motion.moved = {moved.x(), moved.y(), moved.z(), std::sqrt(wobble)};
  motion.sweep = {mean_sweep.x(), mean_sweep.y(), mean_sweep.z(), std::sqrt(spread)};
  link.bulge = std::sqrt(bulge);
  link.ripple = std::sqrt(ripple);
  link.half = 0.5f * std::sqrt(length);
  link.farthest = std::sqrt(away) + std::min(std::sqrt(sweep), neighbours.longest_sweep);
}

}  // namespace

// Links are a few whatever the radius, but not short against it: where wisps are wide, more of them
// would only make more pairs of the same.
WispNeighbours::Layout LayOut(const WispPoints& points, size_t g) {
  const auto begin = static_cast<size_t>(points.first[g]);
  const auto end = static_cast<size_t>(points.first[g + 1]);
  WispNeighbours::Layout layout{1, false};
  const float radius = std::min(points.radius[g], kLargestRadius);
  if (!(radius > 0)) return layout;
  float arc = 0;
  size_t lengths = 0;
  for (size_t p = begin; p < end; ++p) {
    layout.unsettled = layout.unsettled || !Usable(points, p);
    const float length = p + 1 < end ? Length(points, p) : 1;
    if (!(length <= kLongestSegment)) continue;
    arc += length;
    ++lengths;
  }
  const float each = arc / static_cast<float>(std::max<size_t>(lengths, 1));
  const float wide = kLinkLength * radius / std::max(each, 1e-6f) + 0.75f;
  const float few = std::ceil(static_cast<float>(end - begin) / kLinksAGuide);
  layout.link = static_cast<int32_t>(std::clamp(std::max(wide, few), 1.0f, float{kLongestLink}));
  return layout;
}

void MeasureLinks(const WispPoints& points, size_t g, const WispStep& step, const WispFrame& frame,
                  float root_length, WispNeighbours& neighbours, WispScratch& scratch) {
  const auto begin =
      static_cast<int32_t>(Place(points, g, step, frame, root_length, neighbours, scratch));
  const int32_t last = points.first[g + 1] - 1, segments = neighbours.layout[g].link;
  const float reach = (1 + kMargin) * std::min(points.radius[g], kLargestRadius);
  int32_t first = points.first[g];
  for (int32_t l = neighbours.first_link[g]; l < neighbours.first_link[g + 1]; ++l) {
    WispLink& link = scratch.links[static_cast<size_t>(l)];
    const int32_t end = std::min(first + segments, last);
    link.guide = static_cast<int32_t>(g);
    link.first = first;
    link.point = std::clamp(begin, first, end);
    link.count = end - link.point;
    link.reach = link.count > 0 ? reach : 0;
    for (int32_t p = link.point; p < end; ++p) {
      if (scratch.guide_of[static_cast<size_t>(p)] < 0) link.reach = 0;
    }
    scratch.motions[static_cast<size_t>(l)].reach = link.reach;
    if (link.reach > 0) Measure(neighbours, static_cast<size_t>(l), scratch);
    first = end;
  }
}

}  // namespace mane::contact
