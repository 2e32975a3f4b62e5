#include "contact/wisp_neighbours.h"

#include <algorithm>
#include <cmath>

#include "contact/segment_distance.h"

namespace mane::contact {
namespace {

using Around = WispNeighbours::Around;
using Pair = WispNeighbours::Pair;

constexpr int kGuidesAPiece = WispScratch::kGuidesAPiece;
constexpr float kLongestSweep = 0.25f;  // Of a point among the others [m].
constexpr float kSpare = 0.4f;  // What a point may move until the next search, by the radius,
constexpr float kAhead = 3;     // and steps more for which that lasts, up to it; if not twice it.
constexpr double kMostTests = 500;  // A point, at which sweeps are cut.
constexpr double kFew = 1000;       // Points that may always be tested.

// Why a link's neighbours are searched: it left where it was, or is another.
constexpr uint8_t kMoved = 1, kChanged = 2;

constexpr auto Before = [](const Pair& a, const Pair& b) {
  return a.first != b.first ? a.first < b.first : a.second < b.second;
};

template <typename Visit>
void ForGuides(int guides, exec::WorkerPool& pool, const Visit& visit) {
  pool.ParallelFor(guides, kGuidesAPiece, [&](int begin, int end) {
    for (auto g = static_cast<size_t>(begin); g < static_cast<size_t>(end); ++g) visit(g);
  });
}

// Whether the links are those of these guides still.
bool Settled(const WispPoints& points, const WispNeighbours& neighbours) {
  return std::ranges::equal(neighbours.first, points.first) &&
         std::ranges::equal(neighbours.radius, points.radius) &&
         std::ranges::none_of(neighbours.layout, [](const auto& of) { return of.unsettled; });
}

void Start(const WispPoints& points, WispNeighbours& neighbours) {
  const auto guides = static_cast<size_t>(points.guides());
  neighbours.first.assign(points.first.begin(), points.first.end());
  neighbours.radius.assign(points.radius.begin(), points.radius.end());
  neighbours.layout.resize(guides);
  neighbours.first_link.assign(1, 0);
  for (size_t g = 0; g < guides; ++g) {
    const WispNeighbours::Layout layout = neighbours.layout[g] = LayOut(points, g);
    const int32_t segments = std::max(0, points.first[g + 1] - 1 - points.first[g]);
    neighbours.first_link.push_back(neighbours.first_link.back() +
                                    (segments + layout.link - 1) / layout.link);
  }
  neighbours.turn.setIdentity();
  neighbours.longest_sweep = kLongestSweep;
  neighbours.around.assign(static_cast<size_t>(neighbours.first_link.back()), Around{});
  neighbours.searched.assign(points.mass.size() + neighbours.around.size(),
                             Eigen::Vector3f::Zero());
  neighbours.place.assign(points.mass.size(), Eigen::Vector3f::Zero());
  neighbours.pairs.clear();
  neighbours.first_of.assign(guides + 1, 0);
}

// Notes where a link is while its neighbours are searched.
void Surround(const WispPoints& points, size_t l, const WispScratch& scratch,
              WispNeighbours& neighbours) {
  const WispLink& link = scratch.links[l];
  const auto begin = static_cast<size_t>(link.point), end = begin + static_cast<size_t>(link.count);
  float sweep_2 = 0;
  for (size_t p = begin; p <= end; ++p) {
    sweep_2 = std::max(sweep_2, scratch.sweep[p].squaredNorm());
    neighbours.searched[p + l] = neighbours.place[p];
  }
  const float radius = std::min(points.radius[static_cast<size_t>(link.guide)], kLargestRadius);
  const float sweep = std::min(std::sqrt(sweep_2), neighbours.longest_sweep);
  const float ahead = kAhead * sweep;
  Around& around = neighbours.around[l];
  around.point = link.point;
  around.count = link.count;
  around.bulge = link.bulge;
  around.half = link.half;
  around.reach = link.reach;
  around.spare = sweep + kSpare * radius + (ahead < 2 * radius ? std::min(ahead, radius) : 0);
}

// Of a link's points when it was searched for.
const Eigen::Vector3f* Searched(const WispNeighbours& neighbours, size_t l) {
  return &neighbours.searched[static_cast<size_t>(neighbours.around[l].point) + l];
}

SegmentBox Box(const WispLink& link, const WispNeighbours& neighbours, size_t l) {
  const Around& around = neighbours.around[l];
  if (around.spare < 0) return {};
  const Eigen::Vector3f* const x = Searched(neighbours, l);
  Eigen::Array3f low = x[0].array(), high = low;
  for (int32_t k = 1; k <= around.count; ++k) {
    low = low.min(x[k].array());
    high = high.max(x[k].array());
  }
  const float by = around.reach + around.spare;
  return {low - by, high + by, link.guide};
}

bool Within(const Segment& s, const Segment& t, float distance) {
  const ClosestFractions at = ClosestPoints(s, t);
  return (s.At(at.s) - t.At(at.t)).squaredNorm() <= distance * distance;
}

// Whether points of two links may meet before either is searched for again: first by the lines
// between their ends, then by segments, as links may be much longer than they reach.
bool MayMeet(const WispNeighbours& neighbours, size_t l, size_t other) {
  const Around &a = neighbours.around[l], &b = neighbours.around[other];
  const Eigen::Vector3f *const x = Searched(neighbours, l), *const y = Searched(neighbours, other);
  const float reach = a.reach + a.spare + b.reach + b.spare;
  if (!Within({x[0], x[a.count]}, {y[0], y[b.count]}, reach + a.bulge + b.bulge)) return false;
  const float near = 2 * (reach + a.half + b.half);  // Of sums of two ends.
  for (int32_t i = 0; i < a.count; ++i) {
    const Eigen::Vector3f mine = x[i] + x[i + 1];
    for (int32_t j = 0; j < b.count; ++j) {
      if ((mine - y[j] - y[j + 1]).squaredNorm() > near * near) continue;
      if (Within({x[i], x[i + 1]}, {y[j], y[j + 1]}, reach)) return true;
    }
  }
  return false;
}

void MarkAll(WispScratch& scratch) {
  for (uint8_t& moved : scratch.moved) moved = std::max(moved, kMoved);
}

// Sets scratch.moved for the links to search for; whether there are any.
bool MarkMoved(WispScratch& scratch, WispNeighbours& neighbours) {
  size_t count = 0;
  for (size_t l = 0; l < neighbours.around.size(); ++l) {
    Around& around = neighbours.around[l];
    const WispLink& link = scratch.links[l];
    const bool part = link.reach > 0, known = around.spare >= 0;
    const bool changed = known != part || (part && link.point != around.point);
    scratch.moved[l] = changed ? kChanged : part && !(link.farthest <= around.spare) ? kMoved : 0;
    if (!part) around.spare = -1;
    count += scratch.moved[l] != 0;
  }
  // Of half of them all pairs are found twice.
  if (2 * count > scratch.moved.size()) MarkAll(scratch);
  return count > 0;
}

// Lists the moved links' neighbours in scratch.found.
void FindPairs(int guides, exec::WorkerPool& pool, const WispNeighbours& neighbours,
               WispScratch& scratch) {
  const bool all = std::ranges::all_of(scratch.moved, [](uint8_t moved) { return moved != 0; });
  pool.ParallelFor(guides, kGuidesAPiece, [&](int begin, int end) {
    auto& found = scratch.pieces[static_cast<size_t>(begin / kGuidesAPiece)].neighbours;
    found.clear();
    const auto first = static_cast<size_t>(neighbours.first_link[static_cast<size_t>(begin)]);
    const auto last = static_cast<size_t>(neighbours.first_link[static_cast<size_t>(end)]);
    for (size_t a = first; a < last; ++a) {
      if (!scratch.moved[a]) continue;
      const auto visit = [&](int32_t other) {
        const auto b = static_cast<size_t>(other);
        const bool later = b > a;
        if ((!later && scratch.moved[b]) || !MayMeet(neighbours, a, b)) {
          return;
        }
        const auto link = static_cast<int32_t>(a);
        found.push_back(
            {later ? link : other, later ? other : link, kUnknown, {WispNeighbours::kNone, 0}});
      };
      if (all) {
        scratch.grid.ForOverlapping(static_cast<int>(a), visit);
      } else {
        scratch.grid.ForOverlapping<true>(static_cast<int>(a), visit);
      }
    }
    std::sort(found.begin(), found.end(), Before);
    if (all) found.reserve(2 * found.size());  // In other searches some are seen from their second.
  });
  scratch.found.clear();
  scratch.found.reserve(neighbours.pairs.size());
  for (int begin = 0; begin < guides; begin += kGuidesAPiece) {
    const auto& found = scratch.pieces[static_cast<size_t>(begin / kGuidesAPiece)].neighbours;
    scratch.found.insert(scratch.found.end(), found.begin(), found.end());
  }
  if (!all) std::sort(scratch.found.begin(), scratch.found.end(), Before);
}

// Puts what was found in the place of the moved links' pairs; of those that were pairs before all
// that is known is kept.
void Merge(WispScratch& scratch, WispNeighbours& neighbours) {
  std::swap(scratch.neighbours, neighbours.pairs);
  neighbours.pairs.clear();
  auto found = scratch.found.cbegin();
  const auto moved = [&](const Pair& pair) {
    return std::max(scratch.moved[static_cast<size_t>(pair.first)],
                    scratch.moved[static_cast<size_t>(pair.second)]);
  };
  for (const Pair& old : scratch.neighbours) {
    for (; found != scratch.found.cend() && Before(*found, old); ++found) {
      neighbours.pairs.push_back(*found);
    }
    const bool again = found != scratch.found.cend() && !Before(old, *found);
    found += again;
    if (again) {
      neighbours.pairs.push_back(moved(old) == kChanged ? found[-1] : old);
    } else if (moved(old) == 0) {
      neighbours.pairs.push_back(old);
    }
  }
  neighbours.pairs.insert(neighbours.pairs.end(), found, scratch.found.cend());
  if (scratch.neighbours.capacity() < neighbours.pairs.size()) {
    for (auto* pairs : {&scratch.neighbours, &neighbours.pairs}) {
      pairs->reserve(neighbours.pairs.size() * 5 / 4);
    }
  }
  size_t k = 0;
  for (size_t g = 0; g + 1 < neighbours.first_of.size(); ++g) {
    neighbours.first_of[g] = static_cast<int32_t>(k);
    while (k < neighbours.pairs.size() &&
           neighbours.pairs[k].first < neighbours.first_link[g + 1]) {
      ++k;
    }
  }
  neighbours.first_of.back() = static_cast<int32_t>(k);
}

void Search(const WispPoints& points, WispScratch& scratch, exec::WorkerPool& pool,
            WispNeighbours& neighbours) {
  neighbours.longest_sweep = kLongestSweep;
  for (int tries = 0; tries < 6; ++tries) {
    ForGuides(points.guides(), pool, [&](size_t g) {
      for (auto l = static_cast<size_t>(neighbours.first_link[g]);
           l < static_cast<size_t>(neighbours.first_link[g + 1]); ++l) {
        const WispLink& link = scratch.links[l];
        if (scratch.moved[l] && link.reach > 0) Surround(points, l, scratch, neighbours);
        scratch.boxes[l] = Box(link, neighbours, l);
      }
    });
    scratch.grid.Build(scratch.boxes);
    if (scratch.grid.tests() <= kMostTests * (kFew + static_cast<double>(points.size()))) break;
    neighbours.longest_sweep *= 0.5f;
    MarkAll(scratch);
  }
  FindPairs(points.guides(), pool, neighbours, scratch);
  Merge(scratch, neighbours);
}

}  // namespace

void FindNeighbours(const WispPoints& points, const WispStep& step, const WispSettings& settings,
                    WispScratch& scratch, exec::WorkerPool& pool, WispNeighbours& neighbours) {
  if (!Settled(points, neighbours)) Start(points, neighbours);
  scratch.guide_of.resize(points.mass.size());
  scratch.guide_mass.resize(points.radius.size());
  scratch.last_place.resize(points.mass.size());
  scratch.sweep.resize(points.mass.size());
  scratch.links.resize(neighbours.around.size());
  scratch.boxes.resize(neighbours.around.size());
  scratch.moved.resize(neighbours.around.size());
  std::swap(scratch.last_place, neighbours.place);
  const WispFrame frame = WispFrame::Fit(points, step, &neighbours.turn);
  ForGuides(points.guides(), pool, [&](size_t g) {
    MeasureLinks(points, g, step, frame, static_cast<float>(settings.root_length), neighbours,
                 scratch);
  });
  if (MarkMoved(scratch, neighbours)) Search(points, scratch, pool, neighbours);
}

}  // namespace mane::contact
