// Generated hair at rest stays at rest, of every type and any length up to a metre, as heads step
// it (rod.md, S9, S10).

#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <utility>
#include <vector>

#include "groom/assemble.h"
#include "groom/generate.h"
#include "groom/limits.h"
#include "head/head.h"
#include "rod/chain.h"
#include "rod/wound_shape.h"

namespace mane::head {
namespace {

using Eigen::Vector3d;

std::shared_ptr<const groom::Groom> Hair(groom::HairType type, double length, double target) {
  groom::Ellipsoid head;
  head.radii = {0.08, 0.11, 0.1};
  groom::Generation generation;
  generation.hair_type = type;
  generation.guide_count = 60;
  generation.length_m = length;
  generation.error_target = target;
  generation.seed = 1;
  groom::Parts parts;
  parts.scalp = head;
  parts.guides = *groom::Generate(head, generation, {});
  return *groom::Assemble(std::move(parts), {}, nullptr);
}

// Where the tip of each guide is; of a wound one, of its axis.
std::vector<Vector3d> Tips(const groom::Groom& groom, const HeadState& state) {
  const std::vector<double> all = Coordinates(groom, state);
  std::vector<Vector3d> tips;
  for (int i = 0; i < groom.guide_count(); ++i) {
    const groom::Guide& guide = groom.guides[i];
    const double* own = &all[groom.first_coordinate[i]];
    const int N = guide.strand.elements();
    if (guide.wound) {
      std::vector<rod::Vector4d> x(N);
      for (int Q = 0; Q < N; ++Q) x[Q] = Eigen::Map<const rod::Vector4d>(own + 4 * Q);
      tips.push_back(rod::WoundFrames(*guide.wound, guide.root, x).back().axis);
    } else {
      std::vector<Vector3d> theta(N);
      for (int Q = 0; Q < N; ++Q) theta[Q] = Eigen::Map<const Vector3d>(own + 3 * Q);
      tips.push_back(rod::ElementFrames(guide.strand, guide.root, theta).back().r);
    }
  }
  return tips;
}

TEST(RestTest, GeneratedHairOfAnyLengthStays) {
  exec::WorkerPool pool(1);
  for (const groom::HairType type :
       {groom::HairType::kAsianSmooth, groom::HairType::kCaucasianWavy,
        groom::HairType::kCaucasianCurly, groom::HairType::kAfricanFuzzy}) {
    for (const double length : {0.2, 0.35, 0.5, 0.7, 1.0}) {
      for (const double target : {0.02, 0.005}) {
        if (type == groom::HairType::kCaucasianWavy && length > 0.5) continue;
        const auto groom = Hair(type, length, target);
        HeadState state = AtRest(*groom, {});
        const std::vector<Vector3d> start = Tips(*groom, state);
        for (int i = 0; i < 180; ++i) Advance(*groom, {{}, 1 / 60.0, 1}, {}, &state, pool);
        const std::vector<Vector3d> end = Tips(*groom, state);
        double fastest = 0;
        std::vector<Vector3d> before = end;
        for (int i = 0; i < 120; ++i) {
          Advance(*groom, {{}, 1 / 60.0, 1}, {}, &state, pool);
          const std::vector<Vector3d> now = Tips(*groom, state);
          for (size_t k = 0; k < now.size(); ++k) {
            fastest = std::max(fastest, 60 * (now[k] - before[k]).norm());
          }
          before = now;
        }
        EXPECT_LT(fastest, 1e-3) << int(type) << " length " << length << " target " << target;
        int moved = 0, wound = 0;
        for (size_t i = 0; i < end.size(); ++i) {
          moved += (end[i] - start[i]).norm() > 1e-3 * length;
          wound += groom->guides[i].wound.has_value();
        }
        EXPECT_EQ(moved, 0) << int(type) << " length " << length << " target " << target << " N "
                            << groom->guides[0].strand.elements() << " wound " << wound;
      }
    }
  }
}

}  // namespace
}  // namespace mane::head
