#include "contact/wisp_search.h"

#include <algorithm>
#include <cmath>
#include <tuple>

#include "contact/segment_distance.h"

namespace mane::contact {
namespace {

using Candidate = WispScratch::Candidate;
using Contact = WispScratch::Contact;
using Link = WispScratch::Link;

// By the links' reach: how far they move until those that meet are compared again,
constexpr float kPatience = 0.35f;
constexpr float kLate = 0.1f;   // what may come in before it is seen, if not within the radii,
constexpr float kFast = 0.25f;  // and what they sweep at which it is followed.

// Distance of a candidate's segments at the start of the step [m].
float Apart(const WispNeighbours& neighbours, const int32_t point[2]) {
  const auto segment = [&](int k) {
    const auto p = static_cast<size_t>(point[k]);
    return Segment{neighbours.start[p], neighbours.start[p + 1]};
  };
  const Segment s = segment(0), t = segment(1);
  const ClosestFractions at = ClosestPoints(s, t);
  return (s.At(at.s) - t.At(at.t)).norm();
}

// Calls visit(first's segment, second's) for all of two links.
template <typename Visit>
void ForSegments(const Link& a, const Link& b, const int32_t link[2], const Visit& visit) {
  for (int32_t p = link[0]; p < link[0] + a.count; ++p) {
    for (int32_t q = link[1]; q < link[1] + b.count; ++q) visit(p, q);
  }
}

// How far apart two links are at the start of the step, and where they are closest: of what is
// nearer than `near` where middles of segments are, or by the next ones; of what is not, a bound.
float Closest(const WispNeighbours& neighbours, const WispScratch& scratch, float near,
              Candidate& candidate) {
  const Link& a = scratch.links[static_cast<size_t>(candidate.link[0])];
  const Link& b = scratch.links[static_cast<size_t>(candidate.link[1])];
  const float halves = a.half + b.half;
  const auto middles_2 = [&](int32_t p, int32_t q) {
    return (scratch.middles[static_cast<size_t>(p)].start -
            scratch.middles[static_cast<size_t>(q)].start)
        .squaredNorm();
  };
  float least_2 = 1e30f;
  ForSegments(a, b, candidate.link, [&](int32_t p, int32_t q) {
    const float apart_2 = middles_2(p, q);
    if (apart_2 >= least_2) return;
    least_2 = apart_2;
    candidate.point[0] = p;
    candidate.point[1] = q;
  });
  const float bound = std::sqrt(least_2) - halves;
  if (bound > near) return bound;
  const int32_t middle[2] = {candidate.point[0], candidate.point[1]};
  float least = Apart(neighbours, candidate.point);
  if (least <= near) return least;
  ForSegments(a, b, candidate.link, [&](int32_t p, int32_t q) {
    const bool next = std::abs(p - middle[0]) + std::abs(q - middle[1]) == 1;
    if (!next || middles_2(p, q) > (least + halves) * (least + halves)) return;
    const int32_t point[2] = {p, q};
    const float apart = Apart(neighbours, point);
    if (apart >= least) return;
    least = apart;
    candidate.point[0] = p;
    candidate.point[1] = q;
  });
  return least;
}

// Those whose middles come closest within the step; their distance.
float Closest(const WispStep& step, const WispScratch& scratch, Candidate& candidate) {
  float least = 1e30f;
  const auto count = [&](int k) {
    return scratch.links[static_cast<size_t>(candidate.link[k])].count;
  };
  for (int32_t p = candidate.link[0]; p < candidate.link[0] + count(0); ++p) {
    const WispScratch::Middle& mine = scratch.middles[static_cast<size_t>(p)];
    for (int32_t q = candidate.link[1]; q < candidate.link[1] + count(1); ++q) {
      const WispScratch::Middle& other = scratch.middles[static_cast<size_t>(q)];
      const float distance_2 =
          LeastDistance2(mine.start - other.start, mine.velocity - other.velocity, step.dt);
      if (distance_2 >= least) continue;
      least = distance_2;
      candidate.point[0] = p;
      candidate.point[1] = q;
    }
  }
  return std::sqrt(least);
}

// Whether two links may touch within the step; where.
bool MayMeet(const WispNeighbours& neighbours, const WispStep& step, const WispScratch& scratch,
             WispNeighbours::Pair& pair, Candidate& candidate) {
  const Link& a = scratch.links[static_cast<size_t>(pair.first)];
  const Link& b = scratch.links[static_cast<size_t>(pair.second)];
  pair.slack -= (a.moved - b.moved).norm() + a.wobble + b.wobble;
  const float reach = a.reach + b.reach;
  const float all = (a.drift - b.drift).norm() * step.dt + a.spread + b.spread;
  // What stays within the margin does not touch.
  const float enough = std::max(-kLate * reach, all - kMargin / (1 + kMargin) * reach);
  const bool known = pair.segment[0] >= 0;
  if (pair.slack > enough && !known) return false;
  const float sweep = std::max(0.0f, enough);
  candidate = {b.guide, {pair.first, pair.second}, {pair.first, pair.second}, 0, &pair};
  if (known && pair.slack > 0 && all < kFast * reach) {
    for (int k = 0; k < 2; ++k) candidate.point[k] += pair.segment[k];
    candidate.distance = Apart(neighbours, candidate.point);
    return true;
  }
  if (!known) {
    const float apart_2 = (a.middle - b.middle).squaredNorm();
    const float radii = a.radius + b.radius + reach, most = radii + sweep;
    if (apart_2 > most * most) {
      pair.slack = std::sqrt(apart_2) - radii;
      return false;
    }
  }
  pair.segment[0] = -1;
  candidate.distance = Closest(neighbours, scratch, reach + sweep, candidate);
  pair.slack = candidate.distance - reach;
  if (pair.slack > sweep) return false;
  if (all < kFast * reach) return true;
  candidate.distance = Closest(step, scratch, candidate);
  return candidate.distance <= reach + a.half + b.half;
}

// What is not the nearest need not be looked at until it has moved by some part of its reach.
void Wait(const WispScratch& scratch, const Candidate& candidate) {
  WispNeighbours::Pair& pair = *candidate.pair;
  const float reach = scratch.links[static_cast<size_t>(pair.first)].reach +
                      scratch.links[static_cast<size_t>(pair.second)].reach;
  pair.segment[0] = -1;
  pair.slack = std::max(pair.slack, kPatience * reach);
}

// What is goes on along the guides until then.
void Follow(const WispScratch& scratch, const Candidate& candidate) {
  WispNeighbours::Pair& pair = *candidate.pair;
  if (pair.segment[0] >= 0) return;
  Wait(scratch, candidate);
  for (int k = 0; k < 2; ++k) {
    pair.segment[k] = static_cast<int8_t>(candidate.point[k] - candidate.link[k]);
  }
}

// Adds a candidate of the first's link, of which the last ones from `of_link` on are, unless
// another with the same guide is nearer.
void Add(const WispScratch& scratch, Candidate candidate, size_t of_link,
         std::vector<Candidate>& candidates) {
  for (size_t k = of_link; k < candidates.size(); ++k) {
    if (candidates[k].guide != candidate.guide) continue;
    if (candidate.distance < candidates[k].distance) std::swap(candidates[k], candidate);
    return Wait(scratch, candidate);
  }
  candidates.push_back(candidate);
}

// Candidates of a guide with later ones: each the nearest of its first link to the other guide.
void FindCandidates(const WispStep& step, const WispScratch& scratch, int32_t g,
                    WispNeighbours& neighbours, std::vector<Candidate>& candidates) {
  candidates.clear();
  size_t of_link = 0;
  int32_t link = -1;
  const auto end = static_cast<size_t>(neighbours.first_of[static_cast<size_t>(g) + 1]);
  for (auto k = static_cast<size_t>(neighbours.first_of[static_cast<size_t>(g)]); k < end; ++k) {
    WispNeighbours::Pair& pair = neighbours.pairs[k];
    if (pair.first != link) {
      link = pair.first;
      of_link = candidates.size();
    }
    Candidate candidate;
    if (!MayMeet(neighbours, step, scratch, pair, candidate)) continue;
    Add(scratch, candidate, of_link, candidates);
  }
  std::sort(candidates.begin(), candidates.end(), [](const Candidate& a, const Candidate& b) {
    return std::tie(a.guide, a.link[0], a.link[1]) < std::tie(b.guide, b.link[0], b.link[1]);
  });
}

// Calls visit(candidate) for those of them that are the nearest of their second link, too.
template <typename Visit>
void ForMutual(const WispScratch& scratch, const std::vector<Candidate>& candidates,
               const Visit& visit) {
  for (auto begin = candidates.begin(); begin != candidates.end();) {
    auto end = begin;
    while (end != candidates.end() && end->guide == begin->guide) ++end;
    for (auto a = begin; a != end; ++a) {
      bool nearest = true;
      for (auto b = begin; b != end && nearest; ++b) {
        nearest = b->link[1] != a->link[1] || b == a || a->distance < b->distance ||
                  (a->distance == b->distance && a < b);
      }
      if (nearest) {
        visit(*a);
      } else {
        Wait(scratch, *a);
      }
    }
    begin = end;
  }
}

}  // namespace

void FindContacts(const WispPoints& points, const WispStep& step, const WispScratch& scratch,
                  int begin, int end, WispNeighbours& neighbours, WispScratch::Piece& piece) {
  auto& contacts = piece.contacts;
  contacts.clear();
  for (int32_t g = begin; g < end; ++g) {
    FindCandidates(step, scratch, g, neighbours, piece.candidates);
    const size_t of_guide = contacts.size();
    ForMutual(scratch, piece.candidates, [&](const Candidate& candidate) {
      const int32_t guide[2] = {g, candidate.guide};
      const Contact contact = Walk(points, step, scratch, guide, candidate.point);
      if (contact.distance > (1 + kMargin) * SumOfRadii(points, guide)) {
        candidate.pair->segment[0] = -1;
        candidate.pair->slack = 0;
        return;
      }
      Follow(scratch, candidate);
      contacts.push_back(contact);
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
