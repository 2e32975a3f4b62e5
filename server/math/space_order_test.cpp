#include "math/space_order.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <numeric>

namespace mane::math {
namespace {

using Eigen::Vector3d;

// In order, the corners of a cube of cells come one after the other, whatever larger cubes it is
// part of.
TEST(SpaceOrder, CellsOfACubeAreNeighbours) {
  std::vector<Vector3d> cells;
  for (int i = 0; i < 512; ++i) cells.emplace_back(i % 8, i / 8 % 8, i / 64);
  cells.emplace_back(8, 8, 8);  // So that a cell is 1/8 of the side.
  const std::vector<uint64_t> keys = SpaceOrder(cells);
  std::vector<size_t> order(512);
  std::iota(order.begin(), order.end(), size_t{0});
  std::ranges::sort(order, {}, [&](size_t i) { return keys[i]; });
  for (const size_t size : {8, 64}) {
    const double side = size == 8 ? 1 : 3;
    for (size_t begin = 0; begin < order.size(); begin += size) {
      Vector3d low = cells[order[begin]], high = low;
      for (size_t k = begin; k < begin + size; ++k) {
        low = low.cwiseMin(cells[order[k]]);
        high = high.cwiseMax(cells[order[k]]);
      }
      EXPECT_EQ((high - low).maxCoeff(), side) << begin;
    }
  }
}

TEST(SpaceOrder, AnyPointsAreTaken) {
  EXPECT_TRUE(SpaceOrder({}).empty());
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const std::vector<Vector3d> same(3, {0.1, -2, 1e9});
  EXPECT_EQ(SpaceOrder(same), std::vector<uint64_t>(3, 0));
  const std::vector<Vector3d> some{{nan, 0, 0}, {1, 2, 3}, {2, 2, 3}};
  const std::vector<uint64_t> keys = SpaceOrder(some);
  EXPECT_EQ(keys[0], 0);
  EXPECT_LT(keys[1], keys[2]);
}

}  // namespace
}  // namespace mane::math
