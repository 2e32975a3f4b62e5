// Properties of the coarser levels of a groom:
//   counts  they have about half and a quarter of the elements, in the lanes of the groom's blocks
//   bound   strands of very many elements have none
//   rest    prolonged rest shape and rest detail sum to the rest shape
//   still   a strand at rest on any level stays there

#include "head/levels.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "head/kernels.h"
#include "head/sample_groom.h"

namespace mane::head {
namespace {

using Eigen::Vector3d;
using rod::layout::kLanes;

TEST(LevelsTest, HaveAboutHalfAndAQuarterOfTheElements) {
  exec::WorkerPool pool(2);
  for (const int N : {1, 2, 3, 5, 10, 16}) {
    const auto groom = GeneratedGroom(groom::HairType::kCaucasianCurly, 40, 0.1, N);
    const Levels levels(*groom, pool);
    int found = 0;
    for (int block = 0; block < std::ssize(groom->batch.blocks()); ++block) {
      int before = N;
      found = std::max(found, levels.Count(block));
      for (int k = 1; k <= levels.Count(block); ++k) {
        const Level& level = levels.At(block, k);
        EXPECT_GE(level.elements, std::max(2.0, std::ceil(std::ldexp(N, -k))));
        EXPECT_LE(level.elements, 0.75 * before);
        EXPECT_EQ(level.elements, level.parts.back() + 1);
        for (int Q = 1; Q < N; ++Q) EXPECT_LE(level.parts[Q] - level.parts[Q - 1], 1);
        EXPECT_TRUE(std::ranges::is_sorted(level.parts));
        EXPECT_EQ(level.batch.blocks()[0].elements, level.elements);
        EXPECT_EQ(level.batch.blocks()[0].count, groom->batch.blocks()[block].count);
        before = level.elements;
      }
    }
    // Short curly hair is far from buckling: nothing is in the way.
    EXPECT_EQ(found, N < 3 ? 0 : N == 3 ? 1 : 2) << N;
  }
}

TEST(LevelsTest, StrandsOfVeryManyElementsHaveNone) {
  exec::WorkerPool pool(1);
  for (const int N : {Levels::kMostElements, Levels::kMostElements + 1}) {
    const auto groom = GeneratedGroom(groom::HairType::kCaucasianCurly, 4, 0.1, N);
    EXPECT_EQ(Levels(*groom, pool).Count(0), N <= Levels::kMostElements ? 2 : 0) << N;
  }
}

TEST(LevelsTest, RestShapeIsTheProlongedOneAndTheRestDetail) {
  exec::WorkerPool pool(1);
  const auto groom = GeneratedGroom(groom::HairType::kCaucasianWavy, 21, 0.1, 7);
  const Levels levels(*groom, pool);
  for (int b = 0; b < std::ssize(groom->batch.blocks()); ++b) {
    const auto& block = groom->batch.blocks()[b];
    for (int k = 1; k <= levels.Count(b); ++k) {
      const Level& level = levels.At(b, k);
      for (int lane = 0; lane < kLanes; ++lane) {
        const int first = groom->first_element[block.strands[lane]];
        float whole = 0;
        for (int Q = 0; Q < 7; ++Q) {
          const int c = level.parts[Q];
          for (int i = 0; i < 3; ++i) {
            const float sum = level.share[Q].lane[lane] * level.rest[3 * c + i].lane[lane] +
                              level.rest_detail[3 * Q + i].lane[lane];
            EXPECT_NEAR(sum, groom->rest[3 * (first + Q) + i], 1e-5);
          }
          whole += level.share[Q].lane[lane];
        }
        EXPECT_NEAR(whole, level.elements, 1e-5);
      }
    }
  }
}

TEST(LevelsTest, HairAtRestStaysAtRest) {
  exec::WorkerPool pool(1);
  const auto groom = GeneratedGroom(groom::HairType::kCaucasianWavy, 32, 0.15, 10);
  const Levels levels(*groom, pool);
  std::array<rod::Row<float>, rod::layout::kDriveRows> drive;
  rod::SetDrive<float>({{}, {}, 1 / 60.0}, {}, 0, kLanes, drive);
  rod::BatchScratch scratch;
  for (int b = 0; b < std::ssize(groom->batch.blocks()); ++b) {
    for (int k = 1; k <= levels.Count(b); ++k) {
      const Level& level = levels.At(b, k);
      std::vector<rod::Row<float>> state(level.batch.state_rows());
      const auto angle = [&](int c, int i) -> rod::Row<float>& {
        return state[c * rod::layout::kStatePerElement + rod::layout::kAngles + i];
      };
      for (int c = 0; c < level.elements; ++c) {
        for (int i = 0; i < 3; ++i) angle(c, i) = level.rest[3 * c + i];
      }
      for (int i = 0; i < 120; ++i) {
        EXPECT_EQ(rod::StepBlock<float>(Kernels(), level.batch, level.batch.blocks()[0], drive,
                                        state, scratch),
                  0u);
      }
      for (int c = 0; c < level.elements; ++c) {
        for (int i = 0; i < 3; ++i) {
          for (int lane = 0; lane < kLanes; ++lane) {
            EXPECT_NEAR(angle(c, i).lane[lane], level.rest[3 * c + i].lane[lane], 2e-5);
          }
        }
      }
    }
  }
}

}  // namespace
}  // namespace mane::head
