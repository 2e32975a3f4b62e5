#include "contact/wisp_neighbours.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "simd/rows.h"

namespace mane::contact {
namespace {

using Around = WispNeighbours::Around;
using Pair = WispNeighbours::Pair;

constexpr int kGuidesAPiece = WispScratch::kGuidesAPiece;
constexpr float kLongestSweep = 0.25f;  // Of a point among the others [m].
constexpr float kSpare = 0.4f;  // What a point may move until the next search, by the radius,
constexpr float kAhead = 3;     // and steps more for which that lasts, up to it; if not twice it.
// What heads of more than a few thousand points may cost (Budget), by the point:
constexpr double kMore = 14e3;     // besides so many points,
constexpr double kMostTests = 12;  // boxes that are compared in a step, lest links take turns;
constexpr double kWorst = 500;     // boxes if all is new, with sweeps halved until it is so many;
constexpr double kMostNear = 2;    // and neighbours that are found, the nearest.
constexpr float kStraight = 0.2f;  // Links count as lines that bulge less, by what they may reach.
// What a point may move until the next search is no less than the step's sweep and that, by the
// radius; so what was left out may be met late.
constexpr float kLeastSpare = 0.25f;
constexpr float kWider = 1.4f;     // By which the next search is wider if it found few,
constexpr float kNarrower = 0.7f;  // and narrower if it found twice too many.

// Why a link's neighbours are searched: it left where it was, or is another.
constexpr uint8_t kMoved = 1, kChanged = 2;

uint64_t Key(const Pair& pair) {
  return uint64_t{static_cast<uint32_t>(pair.first)} << 32 | static_cast<uint32_t>(pair.second);
}

constexpr auto Before = [](const Pair& a, const Pair& b) { return Key(a) < Key(b); };

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
  neighbours.tests = 0;
  neighbours.next = 0;
  neighbours.around.assign(static_cast<size_t>(neighbours.first_link.back()), Around{});
  neighbours.searched.assign(points.mass.size() + neighbours.around.size(),
                             Eigen::Vector3f::Zero());
  neighbours.place.assign(points.mass.size(), Eigen::Vector3f::Zero());
  neighbours.pairs.clear();
  neighbours.first_of.assign(guides + 1, 0);
}

// Notes where a link is while its neighbours are searched.
void Surround(const WispPoints& points, size_t l, WispScratch& scratch,
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
  scratch.spare[l] = sweep + kLeastSpare * radius;
  around.spare = std::min(
      sweep + kSpare * radius + (ahead < 2 * radius ? std::min(ahead, radius) : 0), around.widest);
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

// Whether points of two links whose ends' lines are `apart` may meet before either is searched for
// again: as lines, or by their segments, as links may be much longer than they reach.
bool MayMeet(const WispStep& step, const WispNeighbours& neighbours, size_t l, size_t other,
             float apart) {
  const Around &a = neighbours.around[l], &b = neighbours.around[other];
  const float reach = a.reach + a.spare + b.reach + b.spare;
  if (apart > reach) return false;
  if (a.bulge + b.bulge < kStraight * reach) return true;
  const auto points = [&](const Around& around, size_t of) {
    const float* const x = Searched(neighbours, of)->data();
    return LinkPoints{x, x, around.count, around.half};
  };
  return step.kernels->closest(points(a, l), points(b, other)).distance <= reach;
}

// Adds those of `boxes` that a link may meet to `near`.
void AddNear(const WispStep& step, size_t a, const WispNeighbours& neighbours,
             std::span<const int32_t> boxes, std::vector<WispScratch::Near>& near) {
  SegmentPairRows lines{};
  std::array<simd::Row<float>, kLineRows> between;
  const auto ends = [&](size_t l) {
    const Eigen::Vector3f* const x = Searched(neighbours, l);
    return std::pair(x[0], x[neighbours.around[l].count]);
  };
  const auto [begin, end] = ends(a);
  for (size_t lane = 0; lane < simd::kLanes; ++lane) {
    Put(begin, kEnds, lane, lines);
    Put(end, kEnds + 3, lane, lines);
  }
  for (size_t first = 0; first < boxes.size(); first += simd::kLanes) {
    const auto some = boxes.subspan(first, std::min<size_t>(simd::kLanes, boxes.size() - first));
    for (size_t lane = 0; lane < some.size(); ++lane) {
      const auto [other_begin, other_end] = ends(static_cast<size_t>(some[lane]));
      Put(other_begin, kEnds + 6, lane, lines);
      Put(other_end, kEnds + 9, lane, lines);
    }
    step.kernels->lines(lines[0].lane, between[0].lane);
    for (size_t lane = 0; lane < some.size(); ++lane) {
      const auto other = static_cast<size_t>(some[lane]);
      const float apart = between[kLinesApart].lane[lane] - neighbours.around[a].bulge -
                          neighbours.around[other].bulge;
      if (MayMeet(step, neighbours, a, other, apart)) near.push_back({apart, some[lane]});
    }
  }
}

// Sets scratch.moved for the links to search for; whether there are any.
//
// Where all that moved are more than may be searched for, they take turns.
bool MarkMoved(const WispPoints& points, WispScratch& scratch, WispNeighbours& neighbours) {
  const size_t links = neighbours.around.size();
  size_t count = 0, changes = 0;
  for (size_t l = 0; l < links; ++l) {
    Around& around = neighbours.around[l];
    const WispLink& link = scratch.links[l];
    const bool part = link.reach > 0, known = around.spare >= 0;
    const bool changed = known != part || (part && link.point != around.point);
    scratch.moved[l] = changed ? kChanged : part && !(link.farthest <= around.spare) ? kMoved : 0;
    if (!part) around.spare = -1;
    count += scratch.moved[l] == kMoved;
    changes += scratch.moved[l] == kChanged;
  }
  auto most =
      static_cast<size_t>(Budget(kMostTests, kMore, points) / std::max(neighbours.tests, 1.0)) + 1;
  if (count <= most) return count + changes > 0;
  const size_t first = neighbours.next;
  for (size_t k = 0; k < links; ++k) {
    const size_t l = first + k < links ? first + k : first + k - links;
    if (scratch.moved[l] != kMoved) continue;
    if (most == 0) {
      scratch.moved[l] = 0;
      continue;
    }
    --most;
    neighbours.next = l + 1;
  }
  return true;
}

// Lists a moved link's neighbours, the nearest of them if they are many.
void FindNear(const WispStep& step, size_t a, size_t most, const WispNeighbours& neighbours,
              WispScratch& scratch, WispScratch::Piece& piece) {
  thread_local std::vector<int32_t> boxes;
  thread_local std::vector<WispScratch::Near> near;
  boxes.clear(), near.clear();
  scratch.grid.ForOverlapping(static_cast<int>(a), [&](int32_t other) { boxes.push_back(other); });
  piece.compared += static_cast<int64_t>(boxes.size());
  AddNear(step, a, neighbours, boxes, near);
  KeepRoom(boxes), KeepRoom(near);
  const Around& around = neighbours.around[a];
  float spare = around.spare, widest = around.widest;
  if (near.size() > 2 * most) widest = kNarrower * std::min(spare, widest);
  if (near.size() < most) widest = std::min(1.0f, kWider * widest);
  if (near.size() > most) {
    const auto cut = near.begin() + static_cast<ptrdiff_t>(most);
    std::nth_element(near.begin(), cut, near.end(), [](const auto& x, const auto& y) {
      return x.apart != y.apart ? x.apart < y.apart : x.link < y.link;
    });
    // Until then those that are left out do not meet it.
    for (auto left = cut; left != near.end(); ++left) {
      const Around& other = neighbours.around[static_cast<size_t>(left->link)];
      spare = std::min(spare, left->apart - around.reach - other.reach - other.spare);
    }
    near.erase(cut, near.end());
  }
  scratch.spare[a] = std::max(spare, std::min(around.spare, scratch.spare[a]));
  scratch.widest[a] = widest;
  for (const auto& [apart, other] : near) {
    const auto link = static_cast<int32_t>(a);
    piece.neighbours.push_back(
        {std::min(link, other), std::max(link, other), kUnknown, {WispNeighbours::kNone, 0}});
  }
}

// Lists the moved links' neighbours in scratch.found.
void FindPairs(const WispPoints& points, const WispStep& step, exec::WorkerPool& pool,
               const WispNeighbours& neighbours, WispScratch& scratch) {
  const int guides = points.guides();
  const auto links = static_cast<double>(neighbours.around.size());
  const auto most = static_cast<size_t>(Budget(kMostNear, kMore, points) / links) + 1;
  pool.ParallelFor(guides, kGuidesAPiece, [&](int begin, int end) {
    auto& piece = scratch.pieces[static_cast<size_t>(begin / kGuidesAPiece)];
    piece.neighbours.clear();
    piece.compared = 0;
    const auto first = static_cast<size_t>(neighbours.first_link[static_cast<size_t>(begin)]);
    const auto last = static_cast<size_t>(neighbours.first_link[static_cast<size_t>(end)]);
    piece.neighbours.reserve(most * (last - first));
    for (size_t a = first; a < last; ++a) {
      if (scratch.moved[a] != 0) FindNear(step, a, most, neighbours, scratch, piece);
    }
  });
  scratch.found.clear();
  scratch.found.reserve(most * neighbours.around.size());
  for (int begin = 0; begin < guides; begin += kGuidesAPiece) {
    const auto& piece = scratch.pieces[static_cast<size_t>(begin / kGuidesAPiece)];
    scratch.found.insert(scratch.found.end(), piece.neighbours.begin(), piece.neighbours.end());
    scratch.work.compared += piece.compared;
  }
  // What both have found is listed twice.
  std::sort(scratch.found.begin(), scratch.found.end(), Before);
  const auto same = [](const Pair& a, const Pair& b) { return Key(a) == Key(b); };
  scratch.found.erase(std::unique(scratch.found.begin(), scratch.found.end(), same),
                      scratch.found.end());
}

// Where a link of two guides that touched there begins elsewhere or ends, others of theirs that
// waited for it are looked at again.
void WakeWaiting(WispScratch& scratch, WispNeighbours& neighbours) {
  const auto guide = [&](int32_t link) { return scratch.links[static_cast<size_t>(link)].guide; };
  for (const Pair& ended : scratch.ended) {
    const auto g = static_cast<size_t>(guide(ended.first));
    for (int32_t k = neighbours.first_of[g]; k < neighbours.first_of[g + 1]; ++k) {
      Pair& pair = neighbours.pairs[static_cast<size_t>(k)];
      if (!pair.known() && guide(pair.second) == guide(ended.second)) pair.slack = kUnknown;
    }
  }
}

// Puts what was found in the place of the moved links' pairs, but for those that touch; of those
// that were pairs before all that is known is kept.
void Merge(WispScratch& scratch, WispNeighbours& neighbours) {
  std::swap(scratch.neighbours, neighbours.pairs);
  neighbours.pairs.clear();
  scratch.ended.clear();
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
    if (old.known() && moved(old) == kChanged) scratch.ended.push_back(old);
    if (again) {
      neighbours.pairs.push_back(moved(old) == kChanged ? found[-1] : old);
    } else if (moved(old) == 0 || (moved(old) == kMoved && old.known())) {
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
  KeepRoom(scratch.ended);
  WakeWaiting(scratch, neighbours);
}

void Search(const WispPoints& points, const WispStep& step, WispScratch& scratch,
            exec::WorkerPool& pool, WispNeighbours& neighbours) {
  const bool all = std::ranges::all_of(scratch.moved, [](uint8_t moved) { return moved != 0; });
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
    neighbours.tests = scratch.grid.tests();
    const double tests = neighbours.tests * static_cast<double>(neighbours.around.size());
    if (!all || tests <= Budget(kWorst, kMore, points)) break;
    neighbours.longest_sweep *= 0.5f;
  }
  FindPairs(points, step, pool, neighbours, scratch);
  for (size_t l = 0; l < neighbours.around.size(); ++l) {
    if (!scratch.moved[l] || neighbours.around[l].spare < 0) continue;
    neighbours.around[l].spare = scratch.spare[l];
    neighbours.around[l].widest = scratch.widest[l];
  }
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
  scratch.start.resize(points.mass.size());
  scratch.links.resize(neighbours.around.size());
  scratch.motions.resize(neighbours.around.size());
  scratch.boxes.resize(neighbours.around.size());
  scratch.moved.resize(neighbours.around.size());
  scratch.spare.resize(neighbours.around.size());
  scratch.widest.resize(neighbours.around.size());
  std::swap(scratch.last_place, neighbours.place);
  const WispFrame frame = WispFrame::Fit(points, step, &neighbours.turn);
  ForGuides(points.guides(), pool, [&](size_t g) {
    MeasureLinks(points, g, step, frame, static_cast<float>(settings.root_length), neighbours,
                 scratch);
  });
  scratch.work = {};
  if (MarkMoved(points, scratch, neighbours)) Search(points, step, scratch, pool, neighbours);
  scratch.work.neighbours = static_cast<int64_t>(neighbours.pairs.size());
}

}  // namespace mane::contact
