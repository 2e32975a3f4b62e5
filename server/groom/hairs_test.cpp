// Hairs of a groom: what rides on guides at rest comes back within half a unit an axis and is held
// by int16; every fault is refused by its name; a groom's digest holds them.

#include "groom/hairs.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <memory>
#include <random>
#include <set>

#include "groom/assemble.h"
#include "groom/digest.h"
#include "groom/validate.h"
#include "wire/reconstruct.h"

namespace mane::groom {
namespace {

using Eigen::Quaternionf;
using Eigen::Vector3f;

std::vector<Guide> CurlyGuides(int count) {
  GuideDescription d;
  d.length_m = 0.2;
  d.element_count = 4;
  d.radius_1_m = d.radius_2_m = 50e-6;
  d.young_modulus_pa = 1e9;
  d.poisson_ratio = 0.48;
  d.density_kg_m3 = 1300;
  std::vector<Guide> guides;
  for (int i = 0; i < count; ++i) {
    d.root_position = {0.01 * i, 0.1, 0};
    d.root_frame = Eigen::Quaterniond(1, 0.1 * i, 0.3, -0.2).normalized();
    d.natural_curvature_1 = {30.0 - 5 * i};
    d.natural_curvature_2 = {10.0 * i};
    guides.push_back(*MakeGuide(d, i));
  }
  return guides;
}

// The natural shapes of guides, sampled.
struct Sampled {
  std::vector<std::vector<Vector3f>> points;
  std::vector<GuideAtRest> guides;

  explicit Sampled(const std::vector<Guide>& shapes, size_t count = 16) {
    for (const Guide& guide : shapes) {
      std::vector<Eigen::Vector3d> theta(guide.strand.elements());
      for (size_t e = 0; e < theta.size(); ++e) {
        theta[e] = guide.strand.length[e] * guide.strand.natural[e];
      }
      wire::SamplePoints(guide.root, guide.strand.length, theta,
                         std::span(points.emplace_back(count)));
    }
    for (size_t i = 0; i < shapes.size(); ++i) {
      guides.push_back({points[i], shapes[i].root.q.cast<float>()});
    }
  }
};

// Hairs that leave their guides by up to `spread`, unequal in points.
struct Wisps {
  std::vector<std::vector<float>> parts;
  std::vector<std::vector<Vector3f>> points;
  std::vector<HairAtRest> hairs;

  Wisps(const Sampled& rest, int per_guide, float spread) {
    std::mt19937 random(1);
    std::uniform_real_distribution<float> offset(-spread, spread);
    for (uint32_t g = 0; g < rest.guides.size(); ++g) {
      for (int i = 0; i < per_guide; ++i) {
        const int count = 2 + i;
        auto& part = parts.emplace_back();
        auto& curve = points.emplace_back();
        for (int k = 0; k < count; ++k) {
          part.push_back(static_cast<float>(k) / static_cast<float>(count - 1));
          curve.push_back(rest.points[g][15 * k / (count - 1)] +
                          Vector3f(offset(random), offset(random), offset(random)));
        }
      }
    }
    for (size_t i = 0; i < parts.size(); ++i) {
      hairs.push_back({static_cast<uint32_t>(i / per_guide),
                       parts[i],
                       points[i],
                       {static_cast<uint8_t>(i), 2, 3}});
    }
  }
};

Hairs ThreeHairs() {
  return {1e-6,
          {0, 1, 1},
          {0, 2, 5, 7},
          {{0, {1, 2, 3}}, {9, {}}, {0, {}}, {5, {}}, {5, {-4, 5, 6}}, {0, {}}, {65535, {}}},
          {{1, 2, 3}, {4, 5, 6}, {7, 8, 9}}};
}

TEST(HairsTest, WhatRidesOnGuidesComesBackWithinHalfAUnit) {
  const std::vector<Guide> shapes = CurlyGuides(5);
  const Sampled rest(shapes);
  for (const float spread : {0.f, 1e-4f, 0.02f, 1.f}) {
    SCOPED_TRACE(spread);
    const Wisps wisps(rest, 20, spread);
    const Hairs hairs = RideOn(rest.guides, wisps.hairs, true);
    ASSERT_TRUE(ValidateHairs(hairs, 5, {}));
    ASSERT_EQ(hairs.count(), wisps.hairs.size());
    EXPECT_LE(hairs.offset_unit, (1.8 * spread + 0.02) / 32767);  // Parts are not the samples'.
    for (size_t i = 0; i < hairs.count(); ++i) {
      const GuideAtRest& guide = rest.guides[hairs.guides[i]];
      std::vector<Quaternionf> frames(16);
      wire::CarryFrames(guide.root_frame, guide.points, frames);
      std::vector<Vector3f> out(hairs.places_of(i).size());
      wire::AssembleHair({guide.points, frames}, hairs.places_of(i),
                         static_cast<float>(hairs.offset_unit), out);
      ASSERT_EQ(out.size(), wisps.points[i].size());
      for (size_t k = 0; k < out.size(); ++k) {
        // Half a unit on each of three axes, and roundings of numbers near 1.
        const double bound = std::sqrt(0.75) * hairs.offset_unit + 5e-7 * (0.3 + spread);
        EXPECT_LT((out[k] - wisps.points[i][k]).norm(), bound);
      }
      EXPECT_EQ(hairs.colours[i], wisps.hairs[i].colour);
    }
  }
}

TEST(HairsTest, EveryFaultIsNamed) {
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  struct Case {
    const char* field;
    std::function<void(Hairs&)> spoil;
  };
  const Case cases[] = {
      {"", [](Hairs&) {}},
      {"", [](Hairs& h) { h.colours.clear(); }},
      {"header.hair_offset_unit_m", [](Hairs& h) { h.offset_unit = 0; }},
      {"header.hair_offset_unit_m", [](Hairs& h) { h.offset_unit = kNan; }},
      {"header.hair_offset_unit_m", [](Hairs& h) { h.offset_unit = 2e-3; }},
      {"hairs", [](Hairs& h) { h.first_point.pop_back(); }},
      {"hairs", [](Hairs& h) { h.first_point[1] = 6; }},
      {"hairs", [](Hairs& h) { h.places.pop_back(); }},
      {"hairs", [](Hairs& h) { h.colours.pop_back(); }},
      {"hairs[0].guide", [](Hairs& h) { h.guides[0] = 2; }},
      {"hairs[2].guide", [](Hairs& h) { h.guides[2] = 4'000'000'000; }},
      {"hairs[2].guide", [](Hairs& h) { h.guides[2] = 0; }},
      {"hairs[0].point_count", [](Hairs& h) { h.first_point[1] = 1; }},
      {"hairs[1].point_count", [](Hairs& h) { h.first_point[2] = 2; }},
      {"hairs[1].places[2]", [](Hairs& h) { h.places[4].part = 4; }},
      {"hairs[2].point_count",
       [](Hairs& h) {
         h.places.resize(5 + 1001, h.places.back());
         h.first_point[3] = 5 + 1001;
       }},
  };
  for (const Case& bad : cases) {
    Hairs hairs = ThreeHairs();
    bad.spoil(hairs);
    const auto result = ValidateHairs(hairs, 2, {});
    EXPECT_EQ(result ? "" : result.error().field, bad.field);
    EXPECT_TRUE(result || result.error().code == ErrorCode::kInvalidArgument);
  }
  for (Limits limits : {Limits{.max_hairs = 2}, Limits{.max_hair_points = 6}}) {
    const auto result = ValidateHairs(ThreeHairs(), 2, limits);
    ASSERT_FALSE(result);
    EXPECT_EQ(result.error().code, ErrorCode::kResourceExhausted);
    EXPECT_EQ(result.error().field, "hairs");
  }
}

TEST(HairsTest, AGroomHoldsItsHairsAndItsDigestTellsThem) {
  const auto digest_with = [](std::shared_ptr<const Hairs> hairs) {
    Parts parts;
    parts.guides = CurlyGuides(2);
    parts.hairs = std::move(hairs);
    const auto groom = Assemble(std::move(parts), {}, nullptr);
    EXPECT_TRUE(groom);
    return Digest(**groom);
  };
  EXPECT_EQ(digest_with(nullptr), digest_with(std::make_shared<Hairs>()));
  const std::function<void(Hairs&)> changes[] = {
      [](Hairs&) {},
      [](Hairs& h) { h.offset_unit = 2e-6; },
      [](Hairs& h) { h.guides[1] = 0; },
      [](Hairs& h) { h.first_point[1] = 3, h.first_point[2] = 5, h.places[2].part = 9; },
      [](Hairs& h) { h.places[0].part = 1; },
      [](Hairs& h) { h.places[0].offset[2] = 4; },
      [](Hairs& h) { h.colours[2][2] = 0; },
      [](Hairs& h) { h.colours.clear(); },
  };
  std::set<std::string> digests = {digest_with(nullptr)};
  for (const auto& change : changes) {
    auto hairs = std::make_shared<Hairs>(ThreeHairs());
    change(*hairs);
    EXPECT_TRUE(digests.insert(digest_with(hairs)).second);
  }
  Parts parts;
  parts.guides = CurlyGuides(1);
  parts.hairs = std::make_shared<Hairs>(ThreeHairs());
  EXPECT_EQ(Assemble(std::move(parts), {}, nullptr).error().field, "hairs[1].guide");
}

}  // namespace
}  // namespace mane::groom
