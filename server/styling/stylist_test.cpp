// Styles as a whole: what is kept between styles, what is counted, what is cut, what is refused.

#include "styling/stylist.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "styling/guides.h"
#include "styling/hairdressing.h"

namespace mane::styling {
namespace {

using Eigen::Vector3d;

groom::Ellipsoid Head() {
  groom::Ellipsoid head;
  head.radii = {0.08, 0.1, 0.09};
  head.cap_angle = 1.8;
  return head;
}

Obstacles HeadShape() { return {{contact::Ellipsoid{Head().radii}, {}}}; }

Style Short() {
  Style style;
  style.seed = 3;
  style.wisp_count = 60;
  style.strand_count = 900;
  style.length.value = 0.12;
  style.synthesis.prototype.kind = StrandKind::kWavy;
  style.synthesis.temperature = 0.2;
  style.member_length = {Distribution::Form::kUniform, 1, 0, 0.6, 1.2, {}};
  style.field.emplace_back();
  return style;
}

class StylistTest : public testing::Test {
 protected:
  Result<std::shared_ptr<const Hairstyle>> Apply(Stylist& stylist, const Style& style) {
    return stylist.Apply(style, "style", pool_);
  }

  exec::WorkerPool pool_{2};
};

bool Same(const Hairstyle& a, const Hairstyle& b) {
  return a.members.points == b.members.points && a.members.first_point == b.members.first_point &&
         a.masters.points == b.masters.points && a.colours == b.colours;
}

TEST_F(StylistTest, CountsComeOutExactly) {
  Stylist stylist(Head(), HeadShape());
  const auto made = Apply(stylist, Short());
  ASSERT_TRUE(made);
  EXPECT_EQ((*made)->roots.wisps(), 60);
  EXPECT_EQ((*made)->members.strands(), 900);
  EXPECT_EQ((*made)->colours.size(), 900U);
  for (int i = 0; i < 900; ++i) {
    for (const Eigen::Vector3f& p : (*made)->members.strand(i)) ASSERT_TRUE(p.allFinite());
  }
}

// Whatever was applied before, and however many workers there are.
TEST_F(StylistTest, AStyleDependsOnNothingButItself) {
  Stylist fresh(Head(), HeadShape());
  const auto wanted = *Apply(fresh, Short());

  Stylist used(Head(), HeadShape());
  Style other = Short();
  const auto change = [&](auto&& set) {
    other = Short();
    set(&other);
    ASSERT_TRUE(Apply(used, other));
    const auto again = *Apply(used, Short());
    EXPECT_TRUE(Same(*again, *wanted));
  };
  change([](Style* s) { s->fuzziness = 0.5; });
  change([](Style* s) { s->density.by_polar = {{0, 1}, {2, 0}}; });
  change([](Style* s) { s->bending_stiffness = 3; });
  change([](Style* s) { s->length.value = 0.05; });
  change([](Style* s) { s->colour.wisp_share = 1; });
  change([](Style* s) { s->cuts = {{{}, {}, Region::HalfSpace{Vector3d::UnitY(), 0.05}}}; });
  change([](Style* s) { s->seed = 4; });

  exec::WorkerPool many(5);
  Stylist parallel(Head(), HeadShape());
  EXPECT_TRUE(Same(**parallel.Apply(Short(), "style", many), *wanted));
}

TEST_F(StylistTest, StagesThatDidNotChangeAreKept) {
  Stylist stylist(Head(), HeadShape());
  Style style = Short();
  ASSERT_TRUE(Apply(stylist, style));
  ASSERT_TRUE(Apply(stylist, style));
  EXPECT_EQ(stylist.times().roots + stylist.times().masters + stylist.times().deformation +
                stylist.times().members,
            0);
  style.fuzziness = 0.4;
  ASSERT_TRUE(Apply(stylist, style));
  EXPECT_EQ(stylist.times().deformation, 0);
  EXPECT_GT(stylist.times().members, 0);
  style.bending_stiffness = 2;
  ASSERT_TRUE(Apply(stylist, style));
  EXPECT_EQ(stylist.times().masters, 0);
  EXPECT_GT(stylist.times().deformation, 0);
}

TEST_F(StylistTest, WhatWasGivenAwayStays) {
  Stylist stylist(Head(), HeadShape());
  const auto first = *Apply(stylist, Short());
  const Hairstyle copy = *first;
  Style other = Short();
  other.length.value = 0.2;
  ASSERT_TRUE(Apply(stylist, other));
  EXPECT_TRUE(Same(*first, copy));
}

TEST_F(StylistTest, NothingGrowsWhereTheLengthIsZero) {
  Stylist stylist(Head(), HeadShape());
  Style style = Short();
  style.length.by_polar = {{0.8, 1}, {0.8001, 0}};
  const auto made = Apply(stylist, style);
  ASSERT_TRUE(made);
  EXPECT_LT((*made)->roots.wisps(), 40);
  EXPECT_GT((*made)->roots.wisps(), 3);
  for (const groom::ScalpPoint& root : (*made)->roots.masters) {
    EXPECT_LT(stylist.chart().At(root.position).polar, 0.81);
  }
  style.length.by_polar = {{0, 0}};
  const auto none = Apply(stylist, style);
  ASSERT_FALSE(none);
  EXPECT_EQ(none.error().field, "style.length");
}

// Also where others grow nothing, and whichever way hair is cut.
TEST_F(StylistTest, NumbersOfWispsMeanThoseThatGrow) {
  Stylist stylist(Head(), HeadShape());
  Style style = Short();
  style.length.value = 0.3;
  style.length.by_polar = {{0.8, 1}, {0.8001, 0}};
  Region first;
  first.wisps = {0, 1, 2};
  for (const Cut& cut :
       {Cut{first, 0.1, {}}, Cut{first, {}, Region::HalfSpace{Vector3d::UnitY(), 0.09}}}) {
    style.cuts = {cut};
    const auto made = Apply(stylist, style);
    ASSERT_TRUE(made);
    for (int wisp = 0; wisp < (*made)->roots.wisps(); ++wisp) {
      EXPECT_EQ((*made)->masters.length[wisp] < 0.29F, wisp < 3) << wisp;
    }
  }
}

TEST_F(StylistTest, HairMayBeShorterThanASegment) {
  Stylist stylist(Head(), HeadShape());
  Style style = Short();
  style.member_length = {};
  style.synthesis = {};
  style.cuts = {{{}, 0.003, {}}};
  const auto made = Apply(stylist, style);
  ASSERT_TRUE(made);
  for (const float length : (*made)->masters.length) EXPECT_FLOAT_EQ(length, 0.003F);
  for (int i = 0; i < (*made)->members.strands(); ++i) {
    const auto strand = (*made)->members.strand(i);
    float length = 0;
    for (size_t k = 1; k < strand.size(); ++k) length += (strand[k] - strand[k - 1]).norm();
    EXPECT_NEAR(length, 0.003, 1e-5);
  }
  EXPECT_EQ(ToStrands((*made)->masters)[0].points.size(), 2U);
}

TEST_F(StylistTest, ErrorsNameTheOperationThatIsAtFault) {
  Stylist stylist(Head(), HeadShape());
  Style style = Short();
  Dress({"style.operations[0]", {}, Operation::Tie{Vector3d::Zero(), 0.01}}, &style);
  const auto made = Apply(stylist, style);
  ASSERT_FALSE(made);
  EXPECT_EQ(made.error().field, "style.operations[0]");
  EXPECT_EQ(made.error().message.find("queues"), std::string::npos);
}

TEST_F(StylistTest, SeedsThatDifferMakeOtherHair) {
  Stylist stylist(Head(), HeadShape());
  Style style = Short();
  style.seed = 1;
  const Hairstyle one = **Apply(stylist, style);
  style.seed += uint64_t{1} << 61;
  EXPECT_FALSE(Same(**Apply(stylist, style), one));
}

TEST_F(StylistTest, CutsEndHair) {
  Stylist stylist(Head(), HeadShape());
  Style style = Short();
  style.length.value = 0.3;
  style.member_length = {};
  style.synthesis = {};
  style.fuzziness = 0;
  Region left;
  left.half_spaces = {{Vector3d::UnitX(), 0}};
  style.cuts = {{left, 0.08, {}}, {{}, {}, Region::HalfSpace{Vector3d::UnitY(), -0.12}}};
  const auto made = Apply(stylist, style);
  ASSERT_TRUE(made);
  const Hairstyle& h = **made;
  int reached = 0;
  for (int wisp = 0; wisp < h.roots.wisps(); ++wisp) {
    if (h.roots.masters[wisp].position.x() >= 0) {
      EXPECT_LE(h.masters.length[wisp], 0.0801F);
    }
    const auto strand = ToStrands(h.masters)[wisp].points;
    EXPECT_GT(strand.back().y(), -0.1201F);
    reached += strand.back().y() < -0.1199F ? 1 : 0;
  }
  EXPECT_GT(reached, 10);  // The others are cut where they meet the plane, not before.
}

TEST_F(StylistTest, BraidsTakePartsOfTheHairThatLieSideBySide) {
  Stylist stylist(Head(), HeadShape());
  Style style = Short();
  style.length.value = 0.4;
  style.strand_count = 0;
  Region back;
  back.azimuth = Region::Interval{1.8, -1.8};
  for (int i = 0; i < 3; ++i) {
    style.queues.push_back(
        {"braid",
         "",
         back,
         i,
         3,
         {{Constraint::Kind::kPoint, {Vector3d(0.02 * (i - 1), -0.05, -0.12)}, 0.01, 1}}});
  }
  const auto made = Apply(stylist, style);
  ASSERT_TRUE(made);
  int selected = 0;
  for (const auto& queue : (*made)->solved.constraints) {
    EXPECT_EQ(queue[0].missed, 0);
    selected += queue[0].selected;
    EXPECT_NEAR(queue[0].selected, selected / (&queue - &(*made)->solved.constraints[0] + 1), 1);
  }
  EXPECT_GT(selected, 12);
}

TEST_F(StylistTest, WhatDoesNotFitTheHeadIsNamed) {
  Stylist stylist(Head(), HeadShape());
  Style style = Short();
  style.density.value = 0;
  EXPECT_EQ(Apply(stylist, style).error().field, "style.density");

  style = Short();
  Region nowhere;
  nowhere.half_spaces = {{Vector3d::UnitY(), 5}};
  const ConstraintQueue tie{
      "tie", "", nowhere, 0, 1, {{Constraint::Kind::kPoint, {Vector3d(0, 0, -0.2)}, 0.02, 1}}};
  style.queues = {tie};
  EXPECT_EQ(Apply(stylist, style).error().field, "style.queues[0].selection");

  style.queues[0].selection = {};
  style.queues.push_back(style.queues[0]);
  EXPECT_EQ(Apply(stylist, style).error().field, "style.queues[1].selection");

  style.queues.pop_back();
  style.queues[0].constraints[0].path[0] = Vector3d::Zero();
  EXPECT_EQ(Apply(stylist, style).error().field, "style.queues[0].constraints[0].path[0]");

  style = Short();
  style.length.value = 2;
  style.segment_length = 1e-3;
  EXPECT_EQ(Apply(stylist, style).error().field, "style.segment_length_m");

  style = Short();
  style.segment_length = 2e-3;
  Stylist bounded(Head(), HeadShape(), {1000, 1000});
  EXPECT_EQ(Apply(bounded, style).error().code, ErrorCode::kResourceExhausted);
  // A style that failed leaves nothing behind.
  EXPECT_TRUE(Apply(stylist, Short()));
}

TEST_F(StylistTest, ItStopsWhenNobodyWaits) {
  Stylist stylist(Head(), HeadShape());
  const auto made = stylist.Apply(Short(), "style", pool_, [] { return true; });
  ASSERT_FALSE(made);
  EXPECT_EQ(made.error().code, ErrorCode::kCancelled);
  EXPECT_TRUE(Apply(stylist, Short()));
}

}  // namespace
}  // namespace mane::styling
