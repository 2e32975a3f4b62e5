// What happens every frame, or for every block of hairs, allocates nothing once it is warm:
// bending, a step of dynamics in all its ways, its nodes.

#include <gtest/gtest.h>

#include <vector>

#include "base/test_allocations.h"
#include "beam/test_hairs.h"
#include "beam/test_motion.h"

namespace mane::beam {
namespace {

const Hull kHull{{0.01, -0.02, 0.005}, {0.08, 0.11, 0.095}};

template <typename Work>
long AllocationsOf(const Work& work) {
  work();
  const mane::fixtures::AllocationCount count;
  work();
  return count.count();
}

TEST(BeamAllocationTest, BendingAllocatesNothing) {
  fixtures::Random random(21);
  const BendField field = fixtures::AnyField(random, kHull, 5);
  const BendBatch<float> batch(TurnWeights(20), field, Lifted(kHull, 1e-7));
  std::vector<BendHair> hairs;
  for (int i = 0; i < simd::kLanes; ++i) hairs.push_back(fixtures::AnyHair(random, kHull, 0.3, 20));
  std::vector<simd::Row<float>> rows(batch.hair_rows()), nodes(batch.node_rows());
  const auto& kernels = KernelsFor<float>(simd::Best());
  EXPECT_EQ(AllocationsOf([&] { batch.Bend(kernels, hairs, rows, nodes); }), 0);
}

TEST(BeamAllocationTest, MotionAllocatesNothing) {
  const auto& kernels = KernelsFor<float>(simd::Best());
  for (const Equations equations : {Equations::kAcross, Equations::kPolar}) {
    fixtures::Random random(22);
    MotionSettings settings;
    settings.equations = equations;
    settings.hull = kHull;
    settings.epsilon.assign(9, 0.1F);
    settings.largest_turn.assign(9, 0.4F);
    settings.fluctuation = 0.2;
    std::vector<fixtures::OwnHair> hairs;
    for (int i = 0; i < 20; ++i) hairs.push_back(fixtures::AnyHair(random, 9, kHull));
    fixtures::Moving<float> moving(hairs, settings, {0, -9.81, 0});
    MotionDrive drive = fixtures::AnyDrive(random, 0.02);
    drive.frame = 10;  // Fluctuates.
    std::vector<simd::Row<float>> nodes(3 * 10);
    EXPECT_EQ(AllocationsOf([&] {
                moving.Step(kernels, drive, {1, 2, 3});
                moving.batch().Nodes(kernels, 1, drive.head, moving.state(), nodes);
                moving.batch().Rotate(Eigen::Matrix3d::Identity(), moving.state());
              }),
              0);
  }
}

}  // namespace
}  // namespace mane::beam
