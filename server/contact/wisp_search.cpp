#include "contact/wisp_search.h"

#include <algorithm>
#include <cmath>
#include <tuple>

#include "contact/segment_distance.h"

namespace mane::contact {
namespace {

using Candidate = WispScratch::Candidate;
using Contact = WispScratch::Contact;
using Eigen::Vector3f;

// By the links' reach: how far they move until those that meet are compared again,
constexpr float kPatience = 0.35f;
constexpr float kLate = 0.1f;  // what may come in before it is seen, if not within the radii,
constexpr float kFast =
    0.25f;  // what they sweep from which on it is what they come to that counts,
constexpr float kFollowed = 0.5f;  // and up to which those that meet are followed.
// Contacts a point that are kept: of a link's, the nearest. What touched in the last step counts as
// nearer by a part of its reach, lest two take turns.
constexpr double kMostContacts = 0.8;
constexpr double kMore = 8e3;  // Points besides (Budget).
constexpr float kKept = 0.1f;

Segment SegmentAt(const WispNeighbours& neighbours, int32_t point) {
  const auto p = static_cast<size_t>(point);
  return {neighbours.place[p], neighbours.place[p + 1]};
}

float Apart(const Segment& s, const Segment& t) {
  const ClosestFractions at = ClosestPoints(s, t);
  return (s.At(at.s) - t.At(at.t)).norm();
}

// How two links are to each other by the lines between their ends.
struct Lines {
  float apart;    // No points of them are nearer at the start of the step [m],
  float nearing;  // nor will they come nearer in it by more than this [m].
};

Lines Between(const WispNeighbours& neighbours, const WispScratch& scratch, const WispLink& a,
              const WispLink& b) {
  const auto of = [](const std::vector<Vector3f>& list, const WispLink& link) {
    const auto p = static_cast<size_t>(link.point);
    return Segment{list[p], list[p + static_cast<size_t>(link.count)]};
  };
  const Segment s = of(neighbours.place, a), t = of(neighbours.place, b);
  const Segment sweep = of(scratch.sweep, a), other_sweep = of(scratch.sweep, b);
  const ClosestFractions at = ClosestPoints(s, t);
  // No line is between the planes across it; so only what ends move along it brings them nearer.
  const Vector3f d = s.At(at.s) - t.At(at.t);
  const float distance = d.norm();
  const Vector3f n = d / std::max(distance, 1e-9f);
  const float nearing = std::max(other_sweep.a.dot(n), other_sweep.b.dot(n)) -
                        std::min(sweep.a.dot(n), sweep.b.dot(n));
  return {distance - a.bulge - b.bulge, std::max(0.0f, nearing) + a.ripple + b.ripple};
}

// The middles of a link's segments, in lists of what they are taken of; as rows that a compiler
// turns into vectors, filled up with the last one.
struct Middles {
  float x[kLongestLink], y[kLongestLink], z[kLongestLink];

  Middles(const std::vector<Vector3f>& of, const WispLink& link) {
    const auto p = static_cast<size_t>(link.point), last = static_cast<size_t>(link.count) - 1;
    for (size_t k = 0; k < kLongestLink; ++k) {
      const size_t at = p + std::min(k, last);
      const Vector3f middle = 0.5f * (of[at] + of[at + 1]);
      x[k] = middle.x(), y[k] = middle.y(), z[k] = middle.z();
    }
  }
};

// Squared distances of the segments' middles of two links.
struct Distances {
  float squared[kLongestLink][kLongestLink];

  // Takes the segments that are nearest; their squared distance.
  float Least(const WispLink& a, const WispLink& b, int nearest[2]) const {
    float least = 1e30f;
    nearest[0] = nearest[1] = 0;
    for (int i = 0; i < a.count; ++i) {
      for (int j = 0; j < b.count; ++j) {
        if (squared[i][j] >= least) continue;
        least = squared[i][j];
        nearest[0] = i;
        nearest[1] = j;
      }
    }
    return least;
  }
};

// How far apart two links are at the start of the step, and where.
float Closest(const WispNeighbours& neighbours, const WispLink& a, const WispLink& b,
              Candidate& candidate) {
  const Middles mine(neighbours.place, a), other(neighbours.place, b);
  Distances all;
  for (int i = 0; i < a.count; ++i) {
    for (int j = 0; j < kLongestLink; ++j) {
      const float x = mine.x[i] - other.x[j], y = mine.y[i] - other.y[j],
                  z = mine.z[i] - other.z[j];
      all.squared[i][j] = x * x + y * y + z * z;
    }
  }
  int nearest[2];
  all.Least(a, b, nearest);
  const auto apart = [&](int i, int j) {
    return Apart(SegmentAt(neighbours, a.point + i), SegmentAt(neighbours, b.point + j));
  };
  const auto take = [&](int i, int j) {
    candidate.point[0] = a.point + i;
    candidate.point[1] = b.point + j;
  };
  float least = apart(nearest[0], nearest[1]);
  take(nearest[0], nearest[1]);
  for (int i = 0; i < a.count; ++i) {
    for (int j = 0; j < b.count; ++j) {
      const float within = least + a.half + b.half;
      if ((i == nearest[0] && j == nearest[1]) || all.squared[i][j] > within * within) continue;
      const float distance = apart(i, j);
      if (distance >= least) continue;
      least = distance;
      take(i, j);
    }
  }
  return least;
}

// Those whose middles come closest within the step; their distance.
float ClosestWithin(const WispNeighbours& neighbours, const WispScratch& scratch, const WispLink& a,
                    const WispLink& b, Candidate& candidate) {
  const Middles mine(neighbours.place, a), other(neighbours.place, b);
  const Middles my_sweep(scratch.sweep, a), other_sweep(scratch.sweep, b);
  Distances all;
  for (int i = 0; i < a.count; ++i) {
    for (int j = 0; j < kLongestLink; ++j) {
      // LeastDistance2 within the whole step.
      float x = mine.x[i] - other.x[j], y = mine.y[i] - other.y[j], z = mine.z[i] - other.z[j];
      const float u = my_sweep.x[i] - other_sweep.x[j], v = my_sweep.y[i] - other_sweep.y[j],
                  w = my_sweep.z[i] - other_sweep.z[j];
      const float nearing = -(x * u + y * v + z * w);
      const float part = nearing / std::max(u * u + v * v + w * w, 1e-20f);
      const float time = std::min(std::max(part, 0.0f), 1.0f);
      x += time * u, y += time * v, z += time * w;
      all.squared[i][j] = x * x + y * y + z * z;
    }
  }
  int nearest[2];
  const float least = all.Least(a, b, nearest);
  candidate.point[0] = a.point + nearest[0];
  candidate.point[1] = b.point + nearest[1];
  return std::sqrt(least);
}

// Whether two links may touch within the step; where.
bool MayMeet(const WispNeighbours& neighbours, const WispScratch& scratch,
             WispNeighbours::Pair& pair, Candidate& candidate) {
  const WispLink& a = scratch.links[static_cast<size_t>(pair.first)];
  const WispLink& b = scratch.links[static_cast<size_t>(pair.second)];
  pair.slack -= (a.moved - b.moved).norm() + a.wobble + b.wobble;
  const float reach = a.reach + b.reach;
  const float all = (a.sweep - b.sweep).norm() + a.spread + b.spread;
  // What stays within the margin does not touch.
  const float still = kMargin / (1 + kMargin) * reach;
  const float enough = std::max(-kLate * reach, all - still);
  const bool known = pair.known();
  if (pair.slack > enough && !known) return false;
  if (!(a.reach > 0) || !(b.reach > 0)) return false;
  candidate.distance = kUnknown;
  candidate.guide = b.guide;
  candidate.followed = known;
  candidate.pair = &pair;
  candidate.link[0] = pair.first;
  candidate.link[1] = pair.second;
  candidate.point[0] = a.point;
  candidate.point[1] = b.point;
  if (known && pair.slack > 0 && all < kFollowed * reach) {
    for (int k = 0; k < 2; ++k) candidate.point[k] += pair.segment[k];
    return true;
  }
  pair.segment[0] = WispNeighbours::kNone;
  const Lines lines = Between(neighbours, scratch, a, b);
  const float sweep = std::max(0.0f, lines.nearing - still);
  pair.slack = lines.apart - reach;
  if (pair.slack > sweep) return false;
  if (all >= kFast * reach) {
    candidate.distance = ClosestWithin(neighbours, scratch, a, b, candidate);
    return candidate.distance <= reach + a.half + b.half;
  }
  pair.slack = Closest(neighbours, a, b, candidate) - reach;
  return pair.slack <= sweep;
}

// What is not the nearest need not be looked at until it has moved by some part of its reach.
void Wait(const WispScratch& scratch, const Candidate& candidate) {
  WispNeighbours::Pair& pair = *candidate.pair;
  const float reach = scratch.links[static_cast<size_t>(pair.first)].reach +
                      scratch.links[static_cast<size_t>(pair.second)].reach;
  pair.segment[0] = WispNeighbours::kNone;
  pair.slack = std::max(pair.slack, kPatience * reach);
}

// What is goes on along the guides until then.
void Follow(const WispScratch& scratch, const Candidate& candidate) {
  WispNeighbours::Pair& pair = *candidate.pair;
  if (!pair.known()) Wait(scratch, candidate);
  for (int k = 0; k < 2; ++k) {
    pair.segment[k] = static_cast<int8_t>(
        candidate.point[k] - scratch.links[static_cast<size_t>(candidate.link[k])].point);
  }
}

// Whether two links' wisps are within their margin in the step; where.
bool Meets(const WispPoints& points, const WispStep& step, const WispScratch& scratch,
           const WispNeighbours& neighbours, WispNeighbours::Pair& pair, Candidate& candidate) {
  if (!MayMeet(neighbours, scratch, pair, candidate)) return false;
  const int32_t guide[2] = {scratch.links[static_cast<size_t>(pair.first)].guide, candidate.guide};
  candidate.contact = Approach(points, step, guide, candidate.point);
  // Of those that sweep far, many come near in turn: what they come to is told by their middles.
  if (candidate.distance == kUnknown) candidate.distance = candidate.contact.distance;
  Walk(points, step, scratch, candidate.contact);
  if (candidate.contact.distance <= (1 + kMargin) * SumOfRadii(points, guide)) return true;
  pair.segment[0] = WispNeighbours::kNone;
  pair.slack = 0;
  return false;
}

// Adds a candidate of the first's link, of which the last ones from `of_link` on are, unless
// another with the same guide is nearer.
void Add(const WispScratch& scratch, const Candidate& candidate, size_t of_link,
         std::vector<Candidate>& candidates) {
  for (size_t k = of_link; k < candidates.size(); ++k) {
    if (candidates[k].guide != candidate.guide || candidates[k].link[0] != candidate.link[0]) {
      continue;
    }
    if (candidate.distance >= candidates[k].distance) {
      return Wait(scratch, candidate);
    }
    Wait(scratch, candidates[k]);
    candidates[k] = candidate;
    return;
  }
  candidates.push_back(candidate);
}

// Where a pair is none any more, those of the same guides that waited for it are looked at again.
void WakeOthers(const WispNeighbours::Pair& left, int32_t g, const WispScratch& scratch,
                WispNeighbours& neighbours) {
  const auto guide = [&](const WispNeighbours::Pair& pair) {
    return scratch.links[static_cast<size_t>(pair.second)].guide;
  };
  const auto end = static_cast<size_t>(neighbours.first_of[static_cast<size_t>(g) + 1]);
  for (auto k = static_cast<size_t>(neighbours.first_of[static_cast<size_t>(g)]); k < end; ++k) {
    WispNeighbours::Pair& pair = neighbours.pairs[k];
    if (&pair != &left && guide(pair) == guide(left)) pair.slack = kUnknown;
  }
}

// Candidates of a guide with later ones: each the nearest of its first link to the other guide.
void FindCandidates(const WispPoints& points, const WispStep& step, const WispScratch& scratch,
                    int32_t g, WispNeighbours& neighbours, std::vector<Candidate>& candidates) {
  candidates.clear();
  size_t of_link = 0;
  int32_t link = -1;
  bool woken = false;
  const auto end = static_cast<size_t>(neighbours.first_of[static_cast<size_t>(g) + 1]);
  for (auto k = static_cast<size_t>(neighbours.first_of[static_cast<size_t>(g)]); k < end; ++k) {
    WispNeighbours::Pair& pair = neighbours.pairs[k];
    if (pair.first != link) {
      link = pair.first;
      of_link = candidates.size();
    }
    Candidate candidate;
    const bool known = pair.known();
    bool meets = Meets(points, step, scratch, neighbours, pair, candidate);
    if (known && !meets) {
      // Others of its segments may be nearer than what was followed.
      pair.slack = kUnknown;
      meets = Meets(points, step, scratch, neighbours, pair, candidate);
      if (!meets) WakeOthers(pair, g, scratch, neighbours);
      woken = woken || !meets;
    }
    if (!meets) continue;
    Add(scratch, candidate, of_link, candidates);
  }
  // Those before the one that woke them.
  for (auto k = static_cast<size_t>(neighbours.first_of[static_cast<size_t>(g)]); woken && k < end;
       ++k) {
    WispNeighbours::Pair& pair = neighbours.pairs[k];
    Candidate candidate;
    if (pair.slack != kUnknown || !Meets(points, step, scratch, neighbours, pair, candidate)) {
      continue;
    }
    Add(scratch, candidate, 0, candidates);
  }
  KeepRoom(candidates);
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
        const float mine = a->distance, other = b->distance;
        nearest = b->link[1] != a->link[1] || b == a || mine < other || (mine == other && a < b);
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

// How far off a contact is for its link, by the reach.
float Rank(const WispPoints& points, const Candidate& candidate) {
  const Contact& contact = candidate.contact;
  // What passes through all counts by where it begins.
  const float apart = contact.distance + contact.start.norm();
  return apart / SumOfRadii(points, contact.guide) - (candidate.followed ? kKept : 0);
}

// Of each first link's candidates, keeps the `most` nearest.
void KeepNearest(const WispPoints& points, const WispScratch& scratch, size_t most,
                 std::vector<Candidate>& candidates) {
  std::sort(candidates.begin(), candidates.end(), [&](const Candidate& a, const Candidate& b) {
    if (a.link[0] != b.link[0]) return a.link[0] < b.link[0];
    const float mine = Rank(points, a), other = Rank(points, b);
    return mine != other ? mine < other : a.link[1] < b.link[1];
  });
  size_t kept = 0, of_link = 0;
  for (size_t k = 0; k < candidates.size(); ++k) {
    of_link = k > 0 && candidates[k].link[0] == candidates[k - 1].link[0] ? of_link + 1 : 0;
    if (of_link < most) {
      candidates[kept++] = candidates[k];
    } else {
      Wait(scratch, candidates[k]);
    }
  }
  candidates.resize(kept);
}

// Sorts contacts of one guide, from `begin` on; some have walked to the same place.
void DropSame(size_t begin, std::vector<Contact>& contacts) {
  const auto key = [](const Contact& contact) {
    return std::tie(contact.guide[1], contact.point[0], contact.point[1]);
  };
  const auto first = contacts.begin() + static_cast<ptrdiff_t>(begin);
  std::sort(first, contacts.end(),
            [&](const Contact& a, const Contact& b) { return key(a) < key(b); });
  contacts.erase(std::unique(first, contacts.end(),
                             [&](const Contact& a, const Contact& b) { return key(a) == key(b); }),
                 contacts.end());
}

}  // namespace

void FindContacts(const WispPoints& points, const WispStep& step, const WispScratch& scratch,
                  int begin, int end, WispNeighbours& neighbours, WispScratch::Piece& piece) {
  auto& contacts = piece.contacts;
  contacts.clear();
  const auto links = static_cast<double>(neighbours.around.size());
  const auto most = static_cast<size_t>(Budget(kMostContacts, kMore, points) / links) + 1;
  for (int32_t g = begin; g < end; ++g) {
    FindCandidates(points, step, scratch, g, neighbours, piece.candidates);
    const size_t of_guide = contacts.size();
    piece.nearest.clear();
    ForMutual(scratch, piece.candidates,
              [&](const Candidate& candidate) { piece.nearest.push_back(candidate); });
    KeepRoom(piece.nearest);
    if (piece.nearest.size() > most) KeepNearest(points, scratch, most, piece.nearest);
    for (const Candidate& candidate : piece.nearest) {
      Follow(scratch, candidate);
      contacts.push_back(candidate.contact);
    }
    DropSame(of_guide, contacts);
  }
}

}  // namespace mane::contact
