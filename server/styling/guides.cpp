#include "styling/guides.h"

#include <algorithm>

#include "base/check.h"
#include "styling/colour.h"
#include "wire/reconstruct.h"

namespace mane::styling {
namespace {

// A master's control points as far as its own length; the last is where it ends.
std::vector<Eigen::Vector3f> OwnPoints(const Masters& masters, int wisp) {
  const uint32_t first = masters.first_joint[wisp];
  const uint32_t count = masters.first_joint[wisp + 1] - first;
  const double segments = masters.length[wisp] / masters.segment_length;
  const auto whole = std::min(static_cast<uint32_t>(segments), count - 1);
  const auto part = static_cast<float>(segments - whole);
  const auto begin = masters.points.begin() + first;
  std::vector<Eigen::Vector3f> points(begin, begin + whole + 1);
  // Less than a hundredth of a segment is no segment.
  if (whole + 1 < count && (part > 0.01F || whole == 0)) {
    points.emplace_back(points.back() + part * (begin[whole + 1] - points.back()));
  }
  return points;
}

// The part of its arc length at each of a strand's points.
void PartsOfPoints(std::span<const Eigen::Vector3f> points, std::vector<float>* parts) {
  parts->assign(1, 0.0F);
  for (size_t i = 1; i < points.size(); ++i) {
    parts->push_back(parts->back() + (points[i] - points[i - 1]).norm());
  }
  const float length = parts->back();
  for (float& part : *parts) part = std::min(part / length, 1.0F);
}

}  // namespace

std::vector<groom::ImportedStrand> ToStrands(const Masters& masters) {
  std::vector<groom::ImportedStrand> strands(masters.wisps());
  for (int wisp = 0; wisp < masters.wisps(); ++wisp) {
    strands[wisp].points = OwnPoints(masters, wisp);
  }
  return strands;
}

groom::Hairs ToHairs(std::span<const groom::ImportedStrand> strands,
                     std::span<const uint32_t> first_member, const Members& members,
                     std::span<const Hsv> colours, std::span<const groom::Guide> guides,
                     std::span<const double> rest) {
  const int wisps = static_cast<int>(strands.size());
  MANE_CHECK(guides.size() == strands.size() && first_member.size() == strands.size() + 1);
  std::vector<Eigen::Vector3f> samples(static_cast<size_t>(wisps) * kGuideSamples);
  std::vector<groom::GuideAtRest> at_rest(wisps);
  size_t coordinate = 0;
  for (int wisp = 0; wisp < wisps; ++wisp) {
    const groom::Guide& guide = guides[wisp];
    MANE_CHECK(!guide.wound);
    std::vector<Eigen::Vector3d> theta(guide.strand.elements());
    for (Eigen::Vector3d& angles : theta) {
      angles = Eigen::Map<const Eigen::Vector3d>(&rest[coordinate]);
      coordinate += 3;
    }
    const auto points = std::span(samples).subspan(size_t{kGuideSamples} * wisp, kGuideSamples);
    wire::SamplePoints(guide.root, guide.strand.length, theta, points);
    at_rest[wisp] = {points, guide.root.q.cast<float>()};
  }

  // Parts of all members' points, then views of them.
  std::vector<float> parts(members.points.size());
  std::vector<groom::HairAtRest> hairs(members.strands());
  std::vector<float> of_points;
  for (int wisp = 0; wisp < wisps; ++wisp) {
    PartsOfPoints(strands[wisp].points, &of_points);
    for (uint32_t strand = first_member[wisp]; strand < first_member[wisp + 1]; ++strand) {
      const uint32_t first = members.first_point[strand];
      const auto points = members.strand(static_cast<int>(strand));
      for (size_t k = 0; k < points.size(); ++k) {
        parts[first + k] = k < of_points.size() ? of_points[k] : 1.0F;
      }
      hairs[strand] = {static_cast<uint32_t>(wisp), std::span(parts).subspan(first, points.size()),
                       points, HsvToRgb8(colours[strand])};
    }
  }
  return groom::RideOn(at_rest, hairs, true);
}

}  // namespace mane::styling
