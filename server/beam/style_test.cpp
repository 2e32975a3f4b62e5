// Properties of hairstyles:
//   determinism   the same bits for any cutting of loops; a part's hair depends on no other part
//   hull          no node of any hair is inside it
//   numbers       lengths, rigidities and ambient factors are spread as the style says
//   forces        act on hair of their region alone
//   cuts          end hair at heights, planes and lengths exactly, and leave out what is cut whole
//   errors        name what does not fit the head

#include "beam/style.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <string>
#include <vector>

#include "beam/hull.h"

namespace mane::beam {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3f;
using std::numbers::pi;

const Hull kHead{Vector3d(0.01, 0.1, -0.02), Vector3d(0.08, 0.11, 0.1)};

// Calls work for pieces of so many.
Loop Pieces(int size) {
  return [size](int count, const std::function<void(int, int)>& work) {
    for (int first = 0; first < count; first += size) work(first, std::min(count, first + size));
  };
}

StyledHairs Apply(const BeamStyle& style, const Loop& loop = Pieces(1000)) {
  EXPECT_TRUE(ValidateBeamStyle(style, "style"));
  auto styled = ApplyBeamStyle(style, kHead, "style", loop);
  EXPECT_TRUE(styled) << styled.error().field << " " << styled.error().message;
  return *std::move(styled);
}

// Two parts, one of them tied, under forces and scissors.
BeamStyle AnyStyle() {
  BeamStyle style;
  style.seed = 3;
  Part top, tail;
  top.count = 1003;
  top.pores = {0, 1.6, -2.5, 2.5};
  top.length_fluctuation = 0.3;
  Force comb;
  comb.kind = Force::Kind::kAround;
  comb.point = {0.3, 0.1, 0};
  comb.strength = 20;
  comb.pores = {0, pi, 0, pi};
  style.forces = {comb};
  top.cuts.resize(1);
  top.cuts[0].height = 0.05;
  top.cuts[0].pores = {0, 1, -0.7, 0.7};
  tail.count = 117;
  tail.tied_at = Vector3d(0, 0.15, -0.15);
  tail.segments = 7;
  style.cuts.resize(1);
  style.cuts[0].keep = {{Vector3d(0, 1, 0.2), -0.1}};
  style.parts = {top, tail};
  return style;
}

std::span<const Vector3f> HairOf(const StyledHairs& styled, int hair) {
  return std::span(styled.nodes)
      .subspan(styled.first_node[hair], styled.first_node[hair + 1] - styled.first_node[hair]);
}

double LengthOf(std::span<const Vector3f> nodes) {
  double length = 0;
  for (size_t i = 1; i < nodes.size(); ++i) {
    length += (nodes[i].cast<double>() - nodes[i - 1].cast<double>()).norm();
  }
  return length;
}

void ExpectSame(const StyledHairs& a, const StyledHairs& b) {
  EXPECT_EQ(a.part, b.part);
  EXPECT_EQ(a.first_node, b.first_node);
  EXPECT_EQ(a.nodes, b.nodes);
  EXPECT_EQ(a.ambient, b.ambient);
}

TEST(BeamStyleTest, HasTheSameBitsHoweverLoopsAreCut) {
  const StyledHairs styled = Apply(AnyStyle());
  for (const int size : {1, 3, 64}) ExpectSame(Apply(AnyStyle(), Pieces(size)), styled);
  const Loop backwards = [](int count, const auto& work) {
    for (int i = count; i-- > 0;) work(i, i + 1);
  };
  ExpectSame(Apply(AnyStyle(), backwards), styled);
}

TEST(BeamStyleTest, PartsDoNotDependOnEachOther) {
  BeamStyle other = AnyStyle();
  other.parts[1].count = 5;
  other.parts[1].length = 0.1;
  const StyledHairs a = Apply(AnyStyle()), b = Apply(other);
  const auto hairs = std::ranges::count(a.part, 0U);
  ASSERT_EQ(hairs, std::ranges::count(b.part, 0U));
  const auto nodes = a.first_node[hairs];
  EXPECT_TRUE(std::equal(a.nodes.begin(), a.nodes.begin() + nodes, b.nodes.begin()));
  EXPECT_TRUE(std::equal(a.ambient.begin(), a.ambient.begin() + hairs, b.ambient.begin()));
}

TEST(BeamStyleTest, KeepsAllNodesOutOfTheHullAndLengths) {
  const StyledHairs styled = Apply(AnyStyle());
  for (const Vector3f& node : styled.nodes) EXPECT_GE(kHead.At(node.cast<double>()), 0);
  EXPECT_TRUE(std::ranges::is_sorted(styled.part));
  for (int hair = 0; hair < styled.count(); ++hair) {
    const auto nodes = HairOf(styled, hair);
    ASSERT_GE(nodes.size(), 2U);
    const float d = (nodes[1] - nodes[0]).norm();
    for (size_t i = 2; i + 1 < nodes.size(); ++i) {  // The last may be cut.
      EXPECT_NEAR((nodes[i] - nodes[i - 1]).norm(), d, 1e-6 * 0.25);
    }
  }
}

TEST(BeamStyleTest, FluctuatesAsItSays) {
  BeamStyle style;
  style.parts.resize(1);
  style.parts[0].length_fluctuation = 0.4;
  style.ambient_deviation = 0.2;
  const StyledHairs styled = Apply(style);
  double least = 1, most = 0, mean = 0, ambient = 0, square = 0;
  for (int hair = 0; hair < styled.count(); ++hair) {
    const double length = LengthOf(HairOf(styled, hair)), n = styled.count();
    least = std::min(least, length), most = std::max(most, length), mean += length / n;
    ambient += styled.ambient[hair] / n;
    square += std::pow(styled.ambient[hair] - 1, 2) / n;
    EXPECT_GT(styled.ambient[hair], 0);
  }
  EXPECT_NEAR(least, 0.25 * 0.6, 1e-3);
  EXPECT_NEAR(most, 0.25 * 1.4, 1e-3);
  EXPECT_NEAR(mean, 0.25, 2e-3);
  EXPECT_NEAR(ambient, 1, 0.01);
  EXPECT_NEAR(std::sqrt(square), 0.2, 0.005);
}

TEST(BeamStyleTest, ForcesActOnHairOfTheirRegion) {
  BeamStyle style;
  style.parts.resize(1);
  style.parts[0].count = 500;
  const StyledHairs before = Apply(style);
  Force right;
  right.vector = {20, 0, 0};
  right.pores = {0, pi, 0, pi};
  style.forces = {right};
  const StyledHairs after = Apply(style);
  int moved = 0;
  for (int hair = 0; hair < after.count(); ++hair) {
    const auto a = HairOf(before, hair), b = HairOf(after, hair);
    const bool is_right = a[0].x() > kHead.center.x();
    EXPECT_EQ(!std::ranges::equal(a, b), is_right);
    moved += is_right ? 1 : 0;
  }
  EXPECT_NEAR(moved, 250, 50);
}

// Ends of hair that one cut meets, and how many it left out.
TEST(BeamStyleTest, CutsAtAHeightEndThereExactly) {
  BeamStyle style;
  style.parts.resize(1);
  style.parts[0].pores = {0, 1.4, -pi, pi};
  style.cuts.resize(1);
  style.cuts[0].height = 0.03;
  style.cuts[0].pores = {0, 1.4, 0, pi};
  const StyledHairs styled = Apply(style);
  int at_height = 0;
  for (int hair = 0; hair < styled.count(); ++hair) {
    const auto nodes = HairOf(styled, hair);
    const bool is_cut = PolarOf(kHead, nodes[0].cast<double>()).azimuth > 1e-6;
    if (!is_cut) {
      EXPECT_EQ(nodes.size(), 21U);
      continue;
    }
    for (const Vector3f& node : nodes) EXPECT_GE(node.y(), 0.03F - 1e-8F);
    at_height += nodes.back().y() < 0.03F + 1e-6F ? 1 : 0;
  }
  EXPECT_GT(at_height, 4000);  // Of some 5000.
}

TEST(BeamStyleTest, CutsAtPlanesLeaveWhatIsBeforeThem) {
  BeamStyle style;
  style.parts.resize(1);
  style.cuts.resize(1);
  style.cuts[0].keep = {{Vector3d(2, 0, 0), 0}, {Vector3d(-1, 0, 1), -0.05}};  // A wedge.
  const StyledHairs styled = Apply(style);
  EXPECT_LT(styled.count(), 8000);  // Hair beyond is gone.
  EXPECT_GT(styled.count(), 1000);
  for (const Vector3f& node : styled.nodes) {
    EXPECT_GE(node.x(), -1e-7F);
    EXPECT_GE(node.z() - node.x(), -0.05F - 1e-7F);
  }
}

TEST(BeamStyleTest, CutsByPoreLeaveTheLengthOfTheirHeight) {
  BeamStyle style;
  style.parts.resize(1);
  style.cuts.resize(1);
  style.cuts[0].by_pore = Cut::ByPore{0.05, 0.02, 0.15, 0.2};
  const StyledHairs styled = Apply(style);
  int exact = 0;
  for (int hair = 0; hair < styled.count(); ++hair) {
    const auto nodes = HairOf(styled, hair);
    const double share = std::clamp((nodes[0].y() - 0.05) / 0.1, 0.0, 1.0);
    const double length = LengthOf(nodes), wanted = 0.02 + share * 0.18;
    EXPECT_LE(length, wanted + 1e-6);
    EXPECT_GT(length, wanted - 0.0125);  // Less than a segment where its end would be inside.
    exact += length > wanted - 1e-5 ? 1 : 0;
  }
  EXPECT_GT(exact, styled.count() / 3);
  EXPECT_LT(exact, styled.count());  // Some would have ended inside.
  for (const Vector3f& node : styled.nodes) EXPECT_GE(kHead.At(node.cast<double>()), 0);
}

TEST(BeamStyleTest, StopsWithWhateverItHasWhereWorkIsLeftOut) {
  BeamStyle style = AnyStyle();
  style.cuts.clear();
  for (Part& part : style.parts) part.cuts.clear();
  for (const int share : {0, 2}) {
    const Loop some = [share](int count, const auto& work) { work(0, count * share / 3); };
    const auto styled = ApplyBeamStyle(style, kHead, "style", some);
    ASSERT_TRUE(styled);
    int hairs = 0;
    for (const Part& part : style.parts) hairs += part.count;
    EXPECT_EQ(styled->count(), hairs);
  }
}

void ExpectRefused(const BeamStyle& style, const std::string& field) {
  ASSERT_TRUE(ValidateBeamStyle(style, "style"));
  const auto styled = ApplyBeamStyle(style, kHead, "style", Pieces(100));
  ASSERT_FALSE(styled);
  EXPECT_EQ(styled.error().code, ErrorCode::kInvalidArgument);
  EXPECT_EQ(styled.error().field, field);
}

TEST(BeamStyleTest, RefusesWhatDoesNotFitTheHead) {
  BeamStyle style = AnyStyle();
  style.parts[1].tied_at = kHead.center;
  ExpectRefused(style, "style.parts[1].tied_at");
  style = AnyStyle();
  style.parts[1].tied_radius = 0.1;  // Its disc reaches into the head.
  style.parts[1].tied_along = {0, 1, 0};
  ExpectRefused(style, "style.parts[1].tied_at");
  style = AnyStyle();
  style.parts[0].cuts[0].pores = {0.5, 1, 3, -3};  // Where no hair of the part grows.
  ExpectRefused(style, "style.parts[0].cuts[0].pores");
  style.cuts.emplace_back(style.parts[0].cuts[0]);
  style.cuts[1].pores = {2, 2.5, -0.1, 0.1};
  ExpectRefused(style, "style.cuts[1].pores");
  style = AnyStyle();
  style.parts[1].cuts.resize(2);
  style.parts[1].cuts[0].height = -0.05;
  style.parts[1].cuts[1].height = 1;
  ExpectRefused(style, "style.parts[1].cuts[1]");
  style = AnyStyle();
  style.cuts.resize(2);
  style.cuts[1].height = 1;
  ExpectRefused(style, "style.cuts[1]");
}

}  // namespace
}  // namespace mane::beam
