#include "contact/wisp_search.h"

#include <algorithm>
#include <cmath>
#include <tuple>

#include "contact/segment_distance.h"

namespace mane::contact {
namespace {

using Eigen::Array3f;
using Eigen::Vector3f;
using Contact = WispScratch::Contact;

constexpr float kLongestSegment = 0.25f;  // [m]
constexpr float kLargestRadius = 0.1f;    // [m]
constexpr float kFarthest = 1e4f;       // From the origin; beyond it float32 resolves no hair [m].
constexpr float kLongestSweep = 0.25f;  // Of a segment among the others [m].
constexpr double kMostTests = 500;      // A segment, at which sweeps are cut.
constexpr double kFew = 1000;           // Segments that may always be tested.

bool Usable(const WispPoints& points, size_t p) {
  const float reach = points.Position(p).lpNorm<Eigen::Infinity>();
  return reach <= kFarthest && points.velocity[p].lpNorm<Eigen::Infinity>() <= 1e6f &&
         points.mass[p] >= 1e-12f && points.mass[p] <= 1e6f;
}

// Of all usable points, by mass.
Vector3f MeanVelocity(const WispPoints& points) {
  Eigen::Vector3d momentum = Eigen::Vector3d::Zero();
  double mass = 0;
  for (size_t p = 0; p < points.mass.size(); ++p) {
    if (!Usable(points, p)) continue;
    momentum += points.mass[p] * points.velocity[p].cast<double>();
    mass += points.mass[p];
  }
  return mass > 0 ? Vector3f((momentum / mass).cast<float>()) : Vector3f::Zero();
}

// A point as it moves over the step, seen by one that moves with the mean.
SegmentBox Swept(const Vector3f& x, const Vector3f& drift, const WispStep& step, float longest) {
  const Array3f back = (step.h * drift).array().min(longest).max(-longest);
  const Array3f ahead = ((step.dt - step.h) * drift).array().min(longest).max(-longest);
  const Array3f begin = x.array() - back, end = x.array() + ahead;
  return {begin.min(end), begin.max(end), 0};
}

// Boxes of one guide's segments beyond its root.
void BoxGuide(const WispPoints& points, int guide, const WispStep& step, float root_length,
              const Vector3f& mean, float longest_sweep, std::vector<SegmentBox>& boxes) {
  const auto g = static_cast<size_t>(guide);
  const float radius = std::min(points.radius[g], kLargestRadius);
  const auto begin = static_cast<size_t>(points.first[g]);
  const auto end = static_cast<size_t>(points.first[g + 1]);
  float arc = 0;
  for (size_t p = begin; p < end; ++p) {
    boxes[p].guide = -1;
    if (p + 1 == end || !(radius > 0)) continue;
    const Vector3f x = points.Position(p), y = points.Position(p + 1);
    const float length = (y - x).norm();
    const bool beyond_root = arc >= root_length;
    arc += std::isfinite(length) ? length : 0;
    if (!beyond_root || !(length <= kLongestSegment) || !Usable(points, p) ||
        !Usable(points, p + 1)) {
      continue;
    }
    const SegmentBox from = Swept(x, points.velocity[p] - mean, step, longest_sweep);
    const SegmentBox to = Swept(y, points.velocity[p + 1] - mean, step, longest_sweep);
    const float reach = (1 + kMargin) * radius;
    boxes[p] = {from.low.min(to.low) - reach, from.high.max(to.high) + reach, guide};
  }
}

// First time in [0, dt] at which d + time w is as short as `reach`, or shortest.
float TouchTime(const Vector3f& d, const Vector3f& w, float reach, float dt) {
  const float ww = w.squaredNorm(), dw = d.dot(w), beyond = d.squaredNorm() - reach * reach;
  if (!(beyond > 0) || !(dw < 0) || !(ww * dt * dt > 1e-14f)) return 0;
  const float root = dw * dw - ww * beyond;
  const float time = root > 0 ? beyond / (-dw + std::sqrt(root)) : -dw / ww;
  return std::min(time, dt);
}

// Marks, of contacts sorted so that one segment's with one guide are neighbours, the nearest.
template <typename Same>
void MarkNearest(std::vector<Contact>& contacts, size_t begin, const Same& same,
                 bool Contact::*mark) {
  for (size_t i = begin; i < contacts.size();) {
    size_t nearest = i, next = i + 1;
    for (; next < contacts.size() && same(contacts[i], contacts[next]); ++next) {
      if (contacts[next].distance < contacts[nearest].distance) nearest = next;
    }
    contacts[nearest].*mark = true;
    i = next;
  }
}

}  // namespace

float SumOfRadii(const WispPoints& points, const int32_t guide[2]) {
  const auto radius = [&](int32_t g) {
    return std::min(points.radius[static_cast<size_t>(g)], kLargestRadius);
  };
  return radius(guide[0]) + radius(guide[1]);
}

Contact Approach(const WispPoints& points, const WispStep& step, const int32_t guide[2],
                 const int32_t point[2]) {
  Vector3f start[4], velocity[4];
  for (size_t k = 0; k < 4; ++k) {
    const auto p = static_cast<size_t>(point[k / 2]) + k % 2;
    velocity[k] = points.velocity[p];
    start[k] = points.Position(p) - step.h * velocity[k];
  }
  const auto closest = [&](float time) {
    return ClosestPoints({start[0] + time * velocity[0], start[1] + time * velocity[1]},
                         {start[2] + time * velocity[2], start[3] + time * velocity[3]});
  };
  const auto difference = [](const Vector3f x[4], const ClosestFractions& at) -> Vector3f {
    return x[0] + at.s * (x[1] - x[0]) - x[2] - at.t * (x[3] - x[2]);
  };

  const float reach = SumOfRadii(points, guide);
  ClosestFractions at = closest(0);
  Vector3f d = difference(start, at), w = difference(velocity, at);
  float time = TouchTime(d, w, reach, step.dt);
  if (time * w.norm() > 0.1f * reach) {  // Other places may be closest then.
    at = closest(time);
    d = difference(start, at);
    w = difference(velocity, at);
    time = TouchTime(d, w, reach, step.dt);
  }
  const float nearest = std::clamp(-d.dot(w) / std::max(w.squaredNorm(), 1e-20f), 0.0f, step.dt);
  return {{guide[0], guide[1]},
          {point[0], point[1]},
          {at.s, at.t},
          (d + nearest * w).norm(),
          d,
          d + time * w,
          false,
          false};
}

void BuildGrid(const WispPoints& points, const WispStep& step, const WispSettings& settings,
               WispScratch& scratch, exec::WorkerPool& pool) {
  const Vector3f mean = MeanVelocity(points);
  const auto root_length = static_cast<float>(settings.root_length);
  scratch.boxes.resize(points.mass.size());
  float sweep = kLongestSweep;
  for (int tries = 0; tries < 6; ++tries, sweep *= 0.5f) {
    pool.ParallelFor(points.guides(), 16, [&](int begin, int end) {
      for (int g = begin; g < end; ++g) {
        BoxGuide(points, g, step, root_length, mean, sweep, scratch.boxes);
      }
    });
    scratch.grid.Build(scratch.boxes);
    if (scratch.grid.tests() <= kMostTests * (kFew + static_cast<double>(points.size()))) break;
  }
}

void FindContacts(const WispPoints& points, const WispStep& step, const WispScratch& scratch,
                  int begin, int end, std::vector<Contact>& contacts) {
  contacts.clear();
  for (int32_t g = begin; g < end; ++g) {
    const size_t of_guide = contacts.size();
    const int32_t last = points.first[static_cast<size_t>(g) + 1];
    for (int32_t p = points.first[static_cast<size_t>(g)]; p < last; ++p) {
      scratch.grid.ForOverlapping(p, [&](int32_t q) {
        const int32_t guide[2] = {g, scratch.boxes[static_cast<size_t>(q)].guide};
        const int32_t point[2] = {p, q};
        const Contact contact = Approach(points, step, guide, point);
        if (contact.distance <= (1 + kMargin) * SumOfRadii(points, guide)) {
          contacts.push_back(contact);
        }
      });
    }

    // Those of a segment of the later guides, then those of a segment of this one.
    const auto first = contacts.begin() + static_cast<ptrdiff_t>(of_guide);
    std::sort(first, contacts.end(), [](const Contact& a, const Contact& b) {
      return std::tie(a.point[1], a.point[0]) < std::tie(b.point[1], b.point[0]);
    });
    MarkNearest(
        contacts, of_guide,
        [](const Contact& a, const Contact& b) { return a.point[1] == b.point[1]; },
        &Contact::closest_of_second);
    std::sort(first, contacts.end(), [](const Contact& a, const Contact& b) {
      return std::tie(a.guide[1], a.point[0], a.point[1]) <
             std::tie(b.guide[1], b.point[0], b.point[1]);
    });
    MarkNearest(
        contacts, of_guide,
        [](const Contact& a, const Contact& b) {
          return a.guide[1] == b.guide[1] && a.point[0] == b.point[0];
        },
        &Contact::closest_of_first);
    contacts.erase(
        std::remove_if(contacts.begin() + static_cast<ptrdiff_t>(of_guide), contacts.end(),
                       [](const Contact& contact) {
                         return !contact.closest_of_first || !contact.closest_of_second;
                       }),
        contacts.end());
  }
}

}  // namespace mane::contact
