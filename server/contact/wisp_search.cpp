#include "contact/wisp_search.h"

#include <algorithm>
#include <cmath>
#include <tuple>

#include "contact/segment_distance.h"

namespace mane::contact {
namespace {

using Eigen::Array3f;
using Eigen::Vector3f;
using Candidate = WispScratch::Candidate;
using Contact = WispScratch::Contact;
using Middle = WispScratch::Middle;

constexpr float kLongestSegment = 0.25f;  // [m]
constexpr float kLargestRadius = 0.1f;    // [m]
constexpr float kFarthest = 1e4f;       // From the origin; beyond it float32 resolves no hair [m].
constexpr float kLongestSweep = 0.25f;  // Of a segment among the others [m].
constexpr float kLinkLength = 1.5f;     // By the radius of the wisp,
constexpr float kLongestLink = 4;       // and in segments.
constexpr double kMostTests = 500;      // A segment, at which sweeps are cut.
constexpr double kFew = 1000;           // Segments that may always be tested.

bool Usable(const WispPoints& points, size_t p) {
  return Within(points.Position(p), kFarthest) && Within(points.velocity[p], 1e6f) &&
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

// The box and the middle of a stretch of `count` segments from `begin` on.
void BoxLink(const WispPoints& points, size_t begin, size_t count, const WispStep& step,
             const Vector3f& mean, float longest_sweep, WispScratch& scratch) {
  const int32_t guide = scratch.guide_of[begin];
  const float reach =
      (1 + kMargin) * std::min(points.radius[static_cast<size_t>(guide)], kLargestRadius);
  SegmentBox box =
      Swept(points.Position(begin), points.velocity[begin] - mean, step, longest_sweep);
  for (size_t p = begin + 1; p <= begin + count; ++p) {
    const SegmentBox next =
        Swept(points.Position(p), points.velocity[p] - mean, step, longest_sweep);
    box.low = box.low.min(next.low);
    box.high = box.high.max(next.high);
  }
  const Vector3f x = points.Position(begin), y = points.Position(begin + count);
  const Vector3f velocity = 0.5f * (points.velocity[begin] + points.velocity[begin + count]);
  const size_t middle = begin + count / 2;
  scratch.boxes[middle] = {box.low - reach, box.high + reach, guide};
  scratch.middles[middle] = {0.5f * (x + y) - step.h * velocity, velocity,
                             reach + 0.5f * (y - x).norm()};
}

// Finds one guide's segments beyond its root, and joins them to links about as long as its wisp is
// thick: where wisps are wide, that many segments more would only make more pairs of the same.
void BoxGuide(const WispPoints& points, int guide, const WispStep& step, float root_length,
              const Vector3f& mean, float longest_sweep, WispScratch& scratch) {
  const auto g = static_cast<size_t>(guide);
  const float radius = std::min(points.radius[g], kLargestRadius);
  const auto begin = static_cast<size_t>(points.first[g]);
  const auto end = static_cast<size_t>(points.first[g + 1]);
  float arc = 0, mass = 0;
  size_t lengths = 0;
  for (size_t p = begin; p < end; ++p) {
    scratch.boxes[p].guide = -1;
    scratch.guide_of[p] = -1;
    if (p + 1 == end || !(radius > 0)) continue;
    const float length = (points.Position(p + 1) - points.Position(p)).norm();
    if (!(length <= kLongestSegment)) continue;
    if (arc >= root_length && Usable(points, p) && Usable(points, p + 1)) {
      scratch.guide_of[p] = guide;
      mass += points.mass[p];
    }
    arc += length;
    ++lengths;
  }

  scratch.guide_mass[g] = mass;
  const float each = arc / static_cast<float>(std::max<size_t>(lengths, 1));
  const float most = kLinkLength * radius / std::max(each, 1e-6f);
  const auto link = static_cast<size_t>(std::clamp(most + 0.5f, 1.0f, kLongestLink));
  for (size_t p = begin; p < end;) {
    size_t count = 0;
    while (count < link && p + count < end && scratch.guide_of[p + count] == guide) ++count;
    if (count > 0) BoxLink(points, p, count, step, mean, longest_sweep, scratch);
    p += std::max<size_t>(count, 1);
  }
}

// Least squared length of d + time w within [0, dt].
float LeastDistance2(const Vector3f& d, const Vector3f& w, float dt) {
  const float dw = d.dot(w), ww = w.squaredNorm();
  const float time = std::clamp(-dw / std::max(ww, 1e-20f), 0.0f, dt);
  return (d + time * w).squaredNorm();
}

// First time in [0, dt] at which d + time w is as short as `reach`, or shortest.
float TouchTime(const Vector3f& d, const Vector3f& w, float reach, float dt) {
  const float ww = w.squaredNorm(), dw = d.dot(w), beyond = d.squaredNorm() - reach * reach;
  if (!(beyond > 0) || !(dw < 0) || !(ww * dt * dt > 1e-14f)) return 0;
  const float root = dw * dw - ww * beyond;
  const float time = root > 0 ? beyond / (-dw + std::sqrt(root)) : -dw / ww;
  return std::min(time, dt);
}

// Candidates of one guide with later ones, by the later one's segment and then by this one's.
void FindCandidates(const WispPoints& points, const WispStep& step, const WispScratch& scratch,
                    int32_t g, std::vector<Candidate>& candidates) {
  candidates.clear();
  const int32_t end = points.first[static_cast<size_t>(g) + 1];
  for (int32_t p = points.first[static_cast<size_t>(g)]; p < end; ++p) {
    const Middle mine = scratch.middles[static_cast<size_t>(p)];
    scratch.grid.ForOverlapping(p, [&](int32_t q) {
      const Middle& other = scratch.middles[static_cast<size_t>(q)];
      const float reach = mine.reach + other.reach;
      const float distance_2 =
          LeastDistance2(mine.start - other.start, mine.velocity - other.velocity, step.dt);
      if (distance_2 > reach * reach) return;
      candidates.push_back({q, p, scratch.boxes[static_cast<size_t>(q)].guide, distance_2, false});
    });
  }
  std::sort(candidates.begin(), candidates.end(), [](const Candidate& a, const Candidate& b) {
    return a.second != b.second ? a.second < b.second : a.first < b.first;
  });
}

// Calls visit(candidate) for those whose segments are each the nearest of the other's guide, the
// first of equally near ones.
template <typename Visit>
void ForMutual(int32_t first_point, WispScratch::Piece& piece, const Visit& visit) {
  auto& candidates = piece.candidates;
  for (size_t i = 0, next = 0; i < candidates.size(); i = next) {
    size_t nearest = i;
    for (next = i + 1; next < candidates.size() && candidates[next].second == candidates[i].second;
         ++next) {
      if (candidates[next].distance_2 < candidates[nearest].distance_2) nearest = next;
    }
    candidates[nearest].closest_of_second = true;
  }
  for (size_t i = 0, next = 0; i < candidates.size(); i = next) {
    std::fill(piece.nearest.begin(), piece.nearest.end(), -1);
    for (next = i; next < candidates.size() && candidates[next].guide == candidates[i].guide;
         ++next) {
      int32_t& nearest = piece.nearest[static_cast<size_t>(candidates[next].first - first_point)];
      if (nearest < 0 ||
          candidates[next].distance_2 < candidates[static_cast<size_t>(nearest)].distance_2) {
        nearest = static_cast<int32_t>(next);
      }
    }
    for (const int32_t k : piece.nearest) {
      if (k >= 0 && candidates[static_cast<size_t>(k)].closest_of_second) {
        visit(candidates[static_cast<size_t>(k)]);
      }
    }
  }
}

// The contact of a candidate or, where segments touch at an end, of the next ones along the guides
// as long as those are closer.
Contact Walk(const WispPoints& points, const WispStep& step, const WispScratch& scratch,
             const int32_t guide[2], const int32_t point[2]) {
  Contact contact = Approach(points, step, guide, point);
  const auto go = [&](const int32_t next[2]) {
    const Contact closer = Approach(points, step, guide, next);
    const bool better = closer.distance < contact.distance;
    if (better) contact = closer;
    return better;
  };
  for (int tries = 0; tries < 5; ++tries) {
    int32_t next[2];
    for (int k = 0; k < 2; ++k) {
      const float s = contact.fraction[k];
      const int32_t p = contact.point[k] + (s >= 1 ? 1 : 0) - (s <= 0 ? 1 : 0);
      const bool usable = p >= 0 && scratch.guide_of[static_cast<size_t>(p)] == guide[k];
      next[k] = usable ? p : contact.point[k];
    }
    const int32_t first[2] = {next[0], contact.point[1]};
    const int32_t second[2] = {contact.point[0], next[1]};
    const bool one = next[0] != contact.point[0], two = next[1] != contact.point[1];
    if (!(one && two && go(next)) && !(one && go(first)) && !(two && go(second))) break;
  }
  return contact;
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
  return {{guide[0], guide[1]},
          {point[0], point[1]},
          {at.s, at.t},
          std::sqrt(LeastDistance2(d, w, step.dt)),
          d,
          d + time * w};
}

void BuildGrid(const WispPoints& points, const WispStep& step, const WispSettings& settings,
               WispScratch& scratch, exec::WorkerPool& pool) {
  const Vector3f mean = MeanVelocity(points);
  const auto root_length = static_cast<float>(settings.root_length);
  scratch.boxes.resize(points.mass.size());
  scratch.middles.resize(points.mass.size());
  scratch.guide_of.resize(points.mass.size());
  scratch.guide_mass.resize(points.radius.size());
  float sweep = kLongestSweep;
  for (int tries = 0; tries < 6; ++tries, sweep *= 0.5f) {
    pool.ParallelFor(points.guides(), 16, [&](int begin, int end) {
      for (int g = begin; g < end; ++g) {
        BoxGuide(points, g, step, root_length, mean, sweep, scratch);
      }
    });
    scratch.grid.Build(scratch.boxes);
    if (scratch.grid.tests() <= kMostTests * (kFew + static_cast<double>(points.size()))) break;
  }
}

void FindContacts(const WispPoints& points, const WispStep& step, const WispScratch& scratch,
                  int begin, int end, WispScratch::Piece& piece) {
  auto& contacts = piece.contacts;
  contacts.clear();
  for (int32_t g = begin; g < end; ++g) {
    FindCandidates(points, step, scratch, g, piece.candidates);
    const size_t of_guide = contacts.size();
    const int32_t first_point = points.first[static_cast<size_t>(g)];
    piece.nearest.resize(
        static_cast<size_t>(points.first[static_cast<size_t>(g) + 1] - first_point));
    ForMutual(first_point, piece, [&](const Candidate& candidate) {
      const int32_t guide[2] = {g, candidate.guide};
      const int32_t point[2] = {candidate.first, candidate.second};
      const Contact contact = Walk(points, step, scratch, guide, point);
      if (contact.distance <= (1 + kMargin) * SumOfRadii(points, guide)) {
        contacts.push_back(contact);
      }
    });

    // Some walk to the same place.
    const auto key = [](const Contact& contact) {
      return std::tie(contact.guide[1], contact.point[0], contact.point[1]);
    };
    const auto first = contacts.begin() + static_cast<ptrdiff_t>(of_guide);
    std::sort(first, contacts.end(),
              [&](const Contact& a, const Contact& b) { return key(a) < key(b); });
    contacts.erase(
        std::unique(first, contacts.end(),
                    [&](const Contact& a, const Contact& b) { return key(a) == key(b); }),
        contacts.end());
  }
}

}  // namespace mane::contact
