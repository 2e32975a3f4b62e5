#include "styling/beam_hairstyle.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <numeric>
#include <optional>
#include <utility>

#include "contact/first_hit.h"
#include "groom/scalp_hull.h"
#include "styling/farthest_points.h"

namespace mane::styling {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3f;

constexpr double kLeastDepth = 1e-3;  // Of skin below its pore [m].
constexpr Hsv kDarkBrown{0.07F, 0.5F, 0.3F};
// Pieces of work between two looks whether it is still wanted.
constexpr int kGrain = 16;

// The skin below the pores of a mesh's hull.
class Skin {
 public:
  Skin(const groom::TriangleMesh& mesh, Vector3d center)
      : center_(std::move(center)), hits_(InDouble(mesh.vertices), mesh.triangles) {}

  [[nodiscard]] Vector3f Below(const Vector3f& pore) const {
    const Vector3d from = pore.cast<double>();
    const Vector3d least = from + kLeastDepth * (center_ - from).normalized();
    return hits_.Find(least, center_).value_or(least).cast<float>();
  }

 private:
  static std::vector<Vector3d> InDouble(const std::vector<Vector3f>& vertices) {
    std::vector<Vector3d> result;
    result.reserve(vertices.size());
    for (const Vector3f& vertex : vertices) result.emplace_back(vertex.cast<double>());
    return result;
  }

  Vector3d center_;
  contact::FirstHit hits_;
};

// Members in this order of hairs.
Members InOrder(const beam::BeamStyle& style, const beam::StyledHairs& hairs,
                const std::vector<int>& order, const std::optional<Skin>& skin,
                exec::WorkerPool& pool) {
  const auto has_skin = [&](int hair) { return skin && !style.parts[hairs.part[hair]].tied_at; };
  Members members{{0}, {}};
  members.first_point.reserve(hairs.first_node.size());
  for (const int hair : order) {
    const uint32_t nodes = hairs.first_node[hair + 1] - hairs.first_node[hair];
    members.first_point.push_back(members.first_point.back() + nodes + (has_skin(hair) ? 1 : 0));
  }
  members.points.resize(members.first_point.back());
  pool.ParallelFor(hairs.count(), kGrain, [&](int begin, int end) {
    for (int i = begin; i < end; ++i) {
      const int hair = order[i];
      const auto nodes = hairs.nodes.begin() + hairs.first_node[hair];
      auto point = members.points.begin() + members.first_point[i];
      if (has_skin(hair)) *point++ = skin->Below(*nodes);
      std::copy(nodes, hairs.nodes.begin() + hairs.first_node[hair + 1], point);
    }
  });
  return members;
}

double LengthOf(std::span<const Vector3f> points) {
  double length = 0;
  for (size_t i = 1; i < points.size(); ++i) length += (points[i] - points[i - 1]).norm();
  return length;
}

// Cells of hairs [begin, end), numbered from 0.
std::vector<uint32_t> CellsOf(const beam::StyledHairs& hairs, int begin, int end, int count,
                              const base::Cancelled& cancelled) {
  std::vector<Vector3f> pores;
  pores.reserve(end - begin);
  for (int hair = begin; hair < end; ++hair) pores.push_back(hairs.nodes[hairs.first_node[hair]]);
  return FarthestPointCells(pores, count, cancelled);
}

// Where the hairs of each part end that has any, (parts with hair).
std::vector<int> EndsOfParts(const beam::StyledHairs& hairs) {
  std::vector<int> ends;
  for (int begin = 0; begin < hairs.count(); begin = ends.back()) {
    ends.push_back(static_cast<int>(
        std::upper_bound(hairs.part.begin() + begin, hairs.part.end(), hairs.part[begin]) -
        hairs.part.begin()));
  }
  return ends;
}

// Of `guide_count`, how many each part gets: at least one.
std::vector<int> SharesOf(const std::vector<int>& ends, int guide_count) {
  const double share = std::min(1.0, static_cast<double>(guide_count) / ends.back());
  std::vector<int> shares;
  int begin = 0, sum = 0;
  for (const int end : ends) {
    // Rounded so that the parts' numbers add up.
    const auto own = static_cast<int>(std::lround(share * end) - std::lround(share * begin));
    sum += shares.emplace_back(std::max(own, 1));
    begin = end;
  }
  // Those that got one more than their part have it from the largest.
  const int most = std::max(guide_count, static_cast<int>(ends.size()));
  for (; sum > most; --sum) --*std::ranges::max_element(shares);
  return shares;
}

// The guide that each hair rides on, all parts' numbers going on from each other.
std::vector<uint32_t> GuidesOf(const beam::StyledHairs& hairs, int guide_count,
                               const base::Cancelled& cancelled) {
  std::vector<uint32_t> guides;
  guides.reserve(hairs.count());
  const std::vector<int> ends = EndsOfParts(hairs), shares = SharesOf(ends, guide_count);
  uint32_t first = 0;
  for (size_t part = 0; part < ends.size(); ++part) {
    const int begin = part == 0 ? 0 : ends[part - 1];
    const auto cells = CellsOf(hairs, begin, ends[part], shares[part], cancelled);
    for (const uint32_t cell : cells) guides.push_back(first + cell);
    first += *std::ranges::max_element(cells) + 1;
  }
  return guides;
}

// Of the hairs of a guide, the one that it is.
std::span<const Vector3f> Longest(const Members& members, int begin, int end) {
  const auto rank = [&members](int hair) {
    const auto points = members.strand(hair);
    return std::pair(points.size(), LengthOf(points));
  };
  int longest = begin;
  for (int hair = begin + 1; hair < end; ++hair) {
    if (rank(hair) > rank(longest)) longest = hair;
  }
  return members.strand(longest);
}

}  // namespace

Result<BeamHairstyle> MakeBeamHairstyle(const beam::BeamStyle& style, int guide_count,
                                        const groom::Scalp& scalp, const std::string& field,
                                        exec::WorkerPool& pool, const base::Cancelled& cancelled) {
  const auto hull = groom::ScalpHull(scalp);
  if (!hull) return hull.error();
  const beam::Loop loop = [&](int count, const std::function<void(int, int)>& work) {
    pool.ParallelFor(count, kGrain, [&](int begin, int end) {
      if (!base::IsCancelled(cancelled)) work(begin, end);
    });
  };
  const auto hairs = beam::ApplyBeamStyle(style, *hull, field, loop);
  if (base::IsCancelled(cancelled)) return base::CancelledError();
  if (!hairs) return hairs.error();
  const std::vector<uint32_t> guides = GuidesOf(*hairs, guide_count, cancelled);
  std::vector<int> order(hairs->count());
  std::iota(order.begin(), order.end(), 0);
  std::ranges::stable_sort(order, {}, [&guides](int hair) { return guides[hair]; });

  std::optional<Skin> skin;
  const auto* mesh = std::get_if<groom::TriangleMesh>(&scalp);
  if (mesh != nullptr) skin.emplace(*mesh, hull->center);
  BeamHairstyle made;
  made.members = InOrder(style, *hairs, order, skin, pool);
  for (const int hair : order) {
    const auto [hue, saturation, value] = kDarkBrown;
    made.colours.push_back({hue, saturation, std::clamp(value * hairs->ambient[hair], 0.0F, 1.0F)});
  }
  for (int begin = 0, end; begin < hairs->count(); begin = end) {
    end = begin + 1;
    while (end < hairs->count() && guides[order[end]] == guides[order[begin]]) ++end;
    const auto points = Longest(made.members, begin, end);
    made.guides.emplace_back().points.assign(points.begin(), points.end());
    made.first_member.push_back(static_cast<uint32_t>(end));
  }
  return made;
}

}  // namespace mane::styling
