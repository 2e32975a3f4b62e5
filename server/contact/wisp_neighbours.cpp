#include "contact/wisp_neighbours.h"

#include <algorithm>
#include <cmath>

namespace mane::contact {
namespace {

using Eigen::Array3f;
using Eigen::Vector3d;
using Eigen::Vector3f;

constexpr int kGuidesAPiece = 8;
constexpr float kLongestSegment = 0.25f;  // [m]
constexpr float kFarthest = 1e4f;       // From the origin; beyond it float32 resolves no hair [m].
constexpr float kLongestSweep = 0.25f;  // Of a segment among the others [m].
constexpr float kLinkLength = 3;        // By the radius of the wisp,
constexpr float kLongestLink = 8;       // and in segments.
constexpr float kSpare = 0.4f;          // By which boxes are larger than need be, by the radius.
constexpr float kAhead = 3;         // Steps more for which they last, up to it; if not twice it.
constexpr double kMostTests = 500;  // A segment, at which sweeps are cut.
constexpr double kFew = 1000;       // Segments that may always be tested.

bool Usable(const WispPoints& points, size_t p) {
  return Within(points.Position(p), kFarthest) && Within(points.velocity[p], 1e6f) &&
         points.mass[p] >= 1e-12f && points.mass[p] <= 1e6f;
}

// What moves with the hair's mean: links are seen by it.
struct Frame {
  Vector3f position, velocity;
  float sweep;  // That counts at most [m].
};

// Of all usable points, by mass.
Frame MeanMotion(const WispPoints& points, const WispStep& step) {
  Vector3d momentum = Vector3d::Zero(), moment = Vector3d::Zero();
  double mass = 0;
  for (size_t p = 0; p < points.mass.size(); ++p) {
    if (!Usable(points, p)) continue;
    momentum += points.mass[p] * points.velocity[p].cast<double>();
    moment += points.mass[p] * points.Position(p).cast<double>();
    mass += points.mass[p];
  }
  if (!(mass > 0)) return {Vector3f::Zero(), Vector3f::Zero(), kLongestSweep};
  const Vector3d velocity = momentum / mass, position = moment / mass - step.h * velocity;
  return {position.cast<float>(), velocity.cast<float>(), kLongestSweep};
}

// Finds one guide's segments beyond its root, and joins them to links of some radii: where wisps
// are wide, that many segments more would only make more pairs of the same.
void LayOut(const WispPoints& points, size_t g, float root_length, WispNeighbours& neighbours) {
  const float radius = std::min(points.radius[g], kLargestRadius);
  const auto begin = static_cast<size_t>(points.first[g]);
  const auto end = static_cast<size_t>(points.first[g + 1]);
  WispNeighbours::Layout& layout = neighbours.layout[g];
  layout = {static_cast<int32_t>(end), 1};
  if (!(radius > 0)) return;
  float arc = 0;
  size_t lengths = 0;
  for (size_t p = begin; p + 1 < end; ++p) {
    const float length = (points.Position(p + 1) - points.Position(p)).norm();
    if (!(length <= kLongestSegment)) continue;
    if (arc >= root_length) layout.begin = std::min(layout.begin, static_cast<int32_t>(p));
    arc += length;
    ++lengths;
  }
  const float each = arc / static_cast<float>(std::max<size_t>(lengths, 1));
  const float most = kLinkLength * radius / std::max(each, 1e-6f);
  layout.link = static_cast<int32_t>(std::clamp(most + 0.75f, 1.0f, kLongestLink));
}

// Marks one guide's segments that can take part, and weighs them.
void MarkSegments(const WispPoints& points, size_t g, const WispNeighbours& neighbours,
                  WispScratch& scratch) {
  const auto begin = static_cast<size_t>(neighbours.layout[g].begin);
  const auto end = static_cast<size_t>(points.first[g + 1]);
  for (auto p = static_cast<size_t>(points.first[g]); p < end; ++p) scratch.guide_of[p] = -1;
  float mass = 0;
  bool usable = begin < end && Usable(points, begin);
  for (size_t p = begin; p + 1 < end; ++p) {
    const bool next = Usable(points, p + 1);
    if (usable && next &&
        (points.Position(p + 1) - points.Position(p)).squaredNorm() <=
            kLongestSegment * kLongestSegment) {
      scratch.guide_of[p] = static_cast<int32_t>(g);
      mass += points.mass[p];
    }
    usable = next;
  }
  scratch.guide_mass[g] = mass;
}

// Measures the link of `count` segments from `begin` on; the box around what it sweeps.
SegmentBox Measure(const WispPoints& points, size_t begin, size_t count, const WispStep& step,
                   const Frame& frame, const WispNeighbours& neighbours, WispScratch& scratch) {
  WispScratch::Link& link = scratch.links[begin];
  link.guide = scratch.guide_of[begin];
  link.count = static_cast<int32_t>(count);
  const float reach =
      (1 + kMargin) * std::min(points.radius[static_cast<size_t>(link.guide)], kLargestRadius);
  const auto start = [&](size_t p) -> Vector3f {
    return points.Position(p) - step.h * points.velocity[p];
  };
  const size_t end = begin + count;
  link.drift = 0.5f * (points.velocity[begin] + points.velocity[end]);
  link.moved = 0.5f * (start(begin) - neighbours.start[begin] + start(end) - neighbours.start[end]);
  link.reach = reach;
  link.middle = 0.5f * (start(begin) + start(end));
  float radius = 0, half = 0, wobble = 0, spread = 0;
  Array3f low = Array3f::Constant(1e30f), high = -low;
  Vector3f last_x = Vector3f::Zero(), last_u = Vector3f::Zero();
  for (size_t p = begin; p <= end; ++p) {
    const Vector3f u = points.velocity[p], x = start(p);
    radius = std::max(radius, (x - link.middle).squaredNorm());
    wobble = std::max(wobble, (x - neighbours.start[p] - link.moved).squaredNorm());
    spread = std::max(spread, (u - link.drift).squaredNorm());
    const Array3f at = (x - frame.position).array();
    const Array3f sweep =
        (step.dt * (u - frame.velocity)).array().min(frame.sweep).max(-frame.sweep);
    low = low.min(at + sweep.min(0.0f));
    high = high.max(at + sweep.max(0.0f));
    if (p > begin) {
      scratch.middles[p - 1] = {0.5f * (last_x + x), 0.5f * (x - last_x).norm(),
                                0.5f * (last_u + u)};
      half = std::max(half, scratch.middles[p - 1].half);
    }
    last_x = x;
    last_u = u;
  }
  link.radius = std::sqrt(radius);
  link.half = half;
  link.wobble = std::sqrt(wobble);
  link.spread = std::sqrt(spread) * step.dt;
  return {low - reach, high + reach, link.guide};
}

// Calls visit(first point, segments) for the links of a guide.
template <typename Visit>
void ForLinks(const WispPoints& points, size_t g, const WispNeighbours& neighbours,
              const WispScratch& scratch, const Visit& visit) {
  const WispNeighbours::Layout& layout = neighbours.layout[g];
  const auto end = static_cast<size_t>(points.first[g + 1]);
  for (auto p = static_cast<size_t>(layout.begin); p < end;) {
    size_t count = 0;
    while (count < static_cast<size_t>(layout.link) && p + count < end &&
           scratch.guide_of[p + count] == static_cast<int32_t>(g)) {
      ++count;
    }
    if (count > 0) visit(p, count);
    p += std::max<size_t>(count, 1);
  }
}

void NoteStarts(const WispPoints& points, size_t g, const WispStep& step,
                WispNeighbours& neighbours) {
  const auto end = static_cast<size_t>(points.first[g + 1]);
  for (auto p = static_cast<size_t>(points.first[g]); p < end; ++p) {
    neighbours.start[p] = points.Position(p) - step.h * points.velocity[p];
  }
}

// Whether a guide's links are in their boxes still.
bool Fits(const WispPoints& points, size_t g, const WispStep& step, const Frame& frame,
          const WispNeighbours& neighbours, WispScratch& scratch) {
  MarkSegments(points, g, neighbours, scratch);
  bool fits = true;
  int32_t links = 0;
  ForLinks(points, g, neighbours, scratch, [&](size_t begin, size_t count) {
    const SegmentBox box = Measure(points, begin, count, step, frame, neighbours, scratch);
    const SegmentBox& around = neighbours.boxes[begin];
    fits = fits && around.guide == box.guide && (box.low >= around.low).all() &&
           (box.high <= around.high).all();
    ++links;
  });
  return fits && links == neighbours.layout[g].links;
}

void Box(const WispPoints& points, size_t g, const WispStep& step, const Frame& frame,
         WispScratch& scratch, WispNeighbours& neighbours) {
  const auto end = static_cast<size_t>(points.first[g + 1]);
  for (auto p = static_cast<size_t>(points.first[g]); p < end; ++p) neighbours.boxes[p].guide = -1;
  const float radius = std::min(points.radius[g], kLargestRadius);
  neighbours.layout[g].links = 0;
  ForLinks(points, g, neighbours, scratch, [&](size_t begin, size_t count) {
    SegmentBox box = Measure(points, begin, count, step, frame, neighbours, scratch);
    const float ahead = kAhead * (scratch.links[begin].drift - frame.velocity).norm() * step.dt;
    const float spare = kSpare * radius + (ahead < 2 * radius ? std::min(ahead, radius) : 0);
    box.low -= spare;
    box.high += spare;
    neighbours.boxes[begin] = box;
    ++neighbours.layout[g].links;
  });
}

int32_t CountLinks(const WispPoints& points, size_t g, const WispNeighbours& neighbours,
                   const WispScratch& scratch) {
  int32_t links = 0;
  ForLinks(points, g, neighbours, scratch, [&](size_t, size_t) { ++links; });
  return links;
}

constexpr auto Before = [](const WispNeighbours::Pair& a, const WispNeighbours::Pair& b) {
  return a.first != b.first ? a.first < b.first : a.second < b.second;
};

// Neighbours of a guide that were so before keep what is known of them.
void GoOn(size_t g, const WispScratch& scratch, std::span<WispNeighbours::Pair> found) {
  auto old = scratch.neighbours.begin() + scratch.first_neighbour[g];
  const auto end = scratch.neighbours.begin() + scratch.first_neighbour[g + 1];
  for (WispNeighbours::Pair& pair : found) {
    while (old != end && Before(*old, pair)) ++old;
    if (old == end) return;
    if (!Before(pair, *old)) pair = *old;
  }
}

void Search(const WispPoints& points, const WispStep& step, const WispSettings& settings,
            Frame frame, WispScratch& scratch, exec::WorkerPool& pool, WispNeighbours& neighbours) {
  const int guides = points.guides();
  const auto for_guides = [&](const auto& visit) {
    pool.ParallelFor(guides, kGuidesAPiece, [&](int begin, int end) {
      for (auto g = static_cast<size_t>(begin); g < static_cast<size_t>(end); ++g) visit(g);
    });
  };
  bool same = std::ranges::equal(neighbours.first, points.first);
  neighbours.first.assign(points.first.begin(), points.first.end());
  neighbours.boxes.resize(points.mass.size());
  neighbours.start.resize(points.mass.size());
  neighbours.layout.resize(static_cast<size_t>(guides));
  neighbours.first_of.resize(static_cast<size_t>(guides) + 1);
  for_guides([&](size_t g) {
    const WispNeighbours::Layout before = neighbours.layout[g];
    LayOut(points, g, static_cast<float>(settings.root_length), neighbours);
    MarkSegments(points, g, neighbours, scratch);
    const WispNeighbours::Layout& now = neighbours.layout[g];
    scratch.fits[g] = before.begin == now.begin && before.link == now.link &&
                      before.links == CountLinks(points, g, neighbours, scratch);
  });
  same = same && std::ranges::all_of(scratch.fits, [](uint8_t fits) { return fits != 0; });
  std::swap(scratch.neighbours, neighbours.pairs);
  std::swap(scratch.first_neighbour, neighbours.first_of);
  neighbours.first_of.resize(static_cast<size_t>(guides) + 1);
  for (int tries = 0; tries < 6; ++tries, frame.sweep *= 0.5f) {
    for_guides([&](size_t g) { Box(points, g, step, frame, scratch, neighbours); });
    scratch.grid.Build(neighbours.boxes);
    if (scratch.grid.tests() <= kMostTests * (kFew + static_cast<double>(points.size()))) break;
  }

  pool.ParallelFor(guides, kGuidesAPiece, [&](int begin, int end) {
    auto& found = scratch.pieces[static_cast<size_t>(begin / kGuidesAPiece)].neighbours;
    found.clear();
    for (auto g = static_cast<size_t>(begin); g < static_cast<size_t>(end); ++g) {
      const size_t of_guide = found.size();
      ForLinks(points, g, neighbours, scratch, [&](size_t p, size_t) {
        const size_t of_link = found.size();
        scratch.grid.ForOverlapping(static_cast<int>(p), [&](int32_t q) {
          found.push_back({static_cast<int32_t>(p), q, kUnknown, {-1, -1}});
        });
        std::sort(found.begin() + static_cast<ptrdiff_t>(of_link), found.end(),
                  [](const auto& a, const auto& b) { return a.second < b.second; });
      });
      if (same) GoOn(g, scratch, std::span(found).subspan(of_guide));
      neighbours.first_of[g + 1] = static_cast<int32_t>(found.size());
    }
  });
  neighbours.pairs.clear();
  neighbours.first_of[0] = 0;
  for (int begin = 0; begin < guides; begin += kGuidesAPiece) {
    const auto& found = scratch.pieces[static_cast<size_t>(begin / kGuidesAPiece)].neighbours;
    const auto before = static_cast<int32_t>(neighbours.pairs.size());
    for (int g = begin; g < std::min(guides, begin + kGuidesAPiece); ++g) {
      neighbours.first_of[static_cast<size_t>(g) + 1] += before;
    }
    neighbours.pairs.insert(neighbours.pairs.end(), found.begin(), found.end());
  }
}

}  // namespace

void FindNeighbours(const WispPoints& points, const WispStep& step, const WispSettings& settings,
                    WispScratch& scratch, exec::WorkerPool& pool, WispNeighbours& neighbours) {
  scratch.middles.resize(points.mass.size());
  scratch.links.resize(points.mass.size());
  scratch.guide_of.resize(points.mass.size());
  scratch.guide_mass.resize(points.radius.size());
  scratch.fits.resize(points.radius.size());
  const Frame frame = MeanMotion(points, step);
  bool fits = false;
  if (std::ranges::equal(neighbours.first, points.first)) {
    pool.ParallelFor(points.guides(), kGuidesAPiece, [&](int begin, int end) {
      for (auto g = static_cast<size_t>(begin); g < static_cast<size_t>(end); ++g) {
        scratch.fits[g] = Fits(points, g, step, frame, neighbours, scratch);
      }
    });
    fits = std::ranges::all_of(scratch.fits, [](uint8_t of_guide) { return of_guide != 0; });
  }
  if (!fits) Search(points, step, settings, frame, scratch, pool, neighbours);
  pool.ParallelFor(points.guides(), kGuidesAPiece, [&](int begin, int end) {
    for (auto g = static_cast<size_t>(begin); g < static_cast<size_t>(end); ++g) {
      NoteStarts(points, g, step, neighbours);
    }
  });
}

}  // namespace mane::contact
