// Laws of a head's diagnostics:
//   rest          hair at rest has no kinetic energy and is in equilibrium
//   conservation  without friction, drag and damping of the scheme what energy there is turns from
//                 one kind into another
//   workers       any number of them gives the same bits

#include "head/diagnostics.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>

#include "head/sample_groom.h"

namespace mane::head {
namespace {

double Total(const Diagnostics& d) {
  return d.kinetic_energy + d.elastic_energy + d.gravity_energy;
}

TEST(DiagnosticsTest, RestIsAnEquilibriumWithoutMotion) {
  const auto groom = SampleGroom(20, 5);
  exec::WorkerPool pool(1);
  const Diagnostics rest = Diagnose(*groom, AtRest(*groom, {}), {}, pool);
  EXPECT_EQ(rest.kinetic_energy, 0);
  EXPECT_GT(rest.elastic_energy, 0);
  EXPECT_LT(rest.imbalance, 1e-4);
  // Under another gravity it is none.
  Environment sideways;
  sideways.gravity = {9.81, 0, 0};
  EXPECT_GT(Diagnose(*groom, AtRest(*groom, {}), sideways, pool).imbalance, 0.1);
}

TEST(DiagnosticsTest, EnergyTurnsFromOneKindIntoAnother) {
  const auto groom = SampleGroom(20, 5);
  exec::WorkerPool pool(1);
  Environment undamped;
  undamped.internal_friction_scale = 0;
  undamped.air_drag_scale = 0;
  undamped.gravity = {3, -9, 0};
  HeadState state = AtRest(*groom, {});
  const Diagnostics start = Diagnose(*groom, state, undamped, pool);
  double most_kinetic = 0, drift = 0;
  for (int i = 0; i < 100; ++i) {
    Advance(*groom, {{}, 1e-3, 10}, undamped, &state, pool);
    const Diagnostics now = Diagnose(*groom, state, undamped, pool);
    most_kinetic = std::max(most_kinetic, now.kinetic_energy);
    drift = std::max(drift, std::abs(Total(now) - Total(start)));
  }
  EXPECT_GT(most_kinetic, 0);
  EXPECT_LT(drift, 0.05 * most_kinetic);
}

TEST(DiagnosticsTest, TheLargestAngleIsThatOfTheElementThatIsBentMost) {
  const auto groom = SampleGroom(7, 3);
  exec::WorkerPool pool(1);
  const HeadState state = AtRest(*groom, {});
  double largest = 0;
  const std::vector<double> coordinates = Coordinates(*groom, state);
  for (int i = 0; i < groom->guide_count(); ++i) {
    const int each = groom->guides[i].wound ? 4 : 3;
    for (int k = groom->first_coordinate[i]; k < groom->first_coordinate[i + 1]; k += each) {
      const auto element = Eigen::Map<const Eigen::VectorXd>(&coordinates[k], each);
      largest = std::max(largest, element.norm());
    }
  }
  EXPECT_DOUBLE_EQ(Diagnose(*groom, state, {}, pool).largest_angle, largest);
}

TEST(DiagnosticsTest, WorkersDoNotMatter) {
  const auto groom = SampleGroom(50, 5);
  exec::WorkerPool one(1), many(4);
  HeadState state = AtRest(*groom, {});
  Advance(*groom, {{{0.1, 0, 0}, Eigen::Quaterniond::Identity()}, 0.02, 1}, {}, &state, one);
  const Diagnostics a = Diagnose(*groom, state, {}, one), b = Diagnose(*groom, state, {}, many);
  EXPECT_EQ(std::memcmp(&a, &b, sizeof(a)), 0);
}

}  // namespace
}  // namespace mane::head
