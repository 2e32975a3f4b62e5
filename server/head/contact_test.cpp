// A head's hair among bodies, as heads step it.

#include "head/contact.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <string>
#include <vector>

#include "contact/shape.h"
#include "groom/assemble.h"
#include "groom/generate.h"
#include "head/frame.h"
#include "head/head.h"

namespace mane::head {
namespace {

using Eigen::Vector3d;

constexpr int kPoints = 31;

std::shared_ptr<const groom::Groom> Hair(groom::HairType type, double length, int guides) {
  groom::Ellipsoid head;
  head.center = {0, 0.1, 0.02};
  head.radii = {0.078, 0.11, 0.098};
  head.cap_axis = {0, 1, -0.3};
  head.cap_angle = 1.4;
  groom::Generation generation;
  generation.hair_type = type;
  generation.guide_count = static_cast<uint32_t>(guides);
  generation.length_m = length;
  generation.seed = 3;
  groom::Parts parts;
  parts.scalp = head;
  parts.guides = *groom::Generate(head, generation, {});
  auto groom = std::make_shared<groom::Groom>(**groom::Assemble(std::move(parts), {}, nullptr));
  groom->scalp_friction = groom::Friction{};
  return groom;
}

// Points of all guides at equal arc length in the world, (guides x kPoints).
std::vector<Vector3d> Points(const groom::Groom& groom, const HeadState& state,
                             exec::WorkerPool& pool) {
  const std::string bytes =
      EncodeFrame(groom, state, {FrameFormat::kPositionsFloat32, Space::kWorld, kPoints}, pool);
  std::vector<Vector3d> points(static_cast<size_t>(groom.guide_count()) * kPoints);
  EXPECT_EQ(bytes.size(), points.size() * 12);
  for (size_t i = 0; i < points.size(); ++i) {
    float p[3];
    std::memcpy(p, &bytes[12 * i], 12);
    points[i] = Vector3d(p[0], p[1], p[2]);
  }
  return points;
}

// How deep the deepest point beyond `root` [m] of its strand lies in the scalp.
double Deepest(const groom::Groom& groom, const HeadState& state, double root,
               exec::WorkerPool& pool) {
  const auto& scalp = std::get<groom::Ellipsoid>(groom.scalp);
  const contact::Ellipsoid shape(scalp.radii);
  const std::vector<Vector3d> points = Points(groom, state, pool);
  double deepest = -1e9;
  for (int g = 0; g < groom.guide_count(); ++g) {
    for (int k = 0; k < kPoints; ++k) {
      if (k * groom.guides[g].strand.TotalLength() / (kPoints - 1) < root) continue;
      const Vector3d p = state.pose.Inverse() * points[g * kPoints + k] - scalp.center;
      deepest = std::max(deepest, -shape.At(p).distance);
    }
  }
  return deepest;
}

TEST(ContactTest, Explore) {
  exec::WorkerPool pool(1);
  contact::FieldCache fields({}, size_t{1} << 30, 2);
  for (const groom::HairType type :
       {groom::HairType::kAsianSmooth, groom::HairType::kCaucasianWavy,
        groom::HairType::kCaucasianCurly, groom::HairType::kAfricanFuzzy}) {
    for (const double length : {0.12, 0.3}) {
      const auto groom = Hair(type, length, 100);
      HeadState state = AtRest(*groom, {});
      StartContact(*groom, *MakeBodies(*groom, &fields, pool), &state);
      std::printf("type %d length %.2f N %d wound %d\n", int(type), length,
                  groom->guides[0].strand.elements(), groom->guides[0].wound.has_value());
      std::vector<Vector3d> before = Points(*groom, state, pool);
      for (int i = 0; i <= 480; ++i) {
        const double t = i / 60.0;
        math::Pose pose;
        if (i > 240) pose.p = {0.05 * std::sin(6 * (t - 4)), 0, 0.02 * std::sin(9 * (t - 4))};
        const StepReport report = Advance(*groom, {pose, 1 / 60.0, 1}, {}, &state, pool);
        if (i % 60 == 0 || report.repaired_guides > 0) {
          const std::vector<Vector3d> now = Points(*groom, state, pool);
          double fastest = 0, tip = 0;
          for (size_t p = 0; p < now.size(); ++p) {
            fastest = std::max(fastest, 60 * (now[p] - before[p]).norm());
            if (p % kPoints == kPoints - 1) tip = std::max(tip, 60 * (now[p] - before[p]).norm());
          }
          std::printf(
              "  t %.2f deepest %.2f mm (beyond 2 cm: %.2f mm) fastest %.2f tip %.2f mm/s repaired "
              "%d\n",
              t, 1e3 * Deepest(*groom, state, 0.006, pool),
              1e3 * Deepest(*groom, state, 0.02, pool), 1e3 * fastest, 1e3 * tip,
              report.repaired_guides);
        }
        before = Points(*groom, state, pool);
      }
    }
  }
}

}  // namespace
}  // namespace mane::head
