#include "styling/obstacles.h"

#include <gtest/gtest.h>

namespace mane::styling {
namespace {

TEST(ObstaclesTest, TheNearestOfPlacedShapesCounts) {
  const Obstacles two{{contact::Ellipsoid{Eigen::Vector3d(0.1, 0.1, 0.1)}, {}},
                      {contact::Capsule{Eigen::Vector3d(-1, 0, 0), Eigen::Vector3d(1, 0, 0), 0.05},
                       {Eigen::Vector3d(0, -0.3, 0), Eigen::Quaterniond::Identity()}}};
  const contact::Distance above = DistanceTo(two, {0, 0.15, 0});
  EXPECT_NEAR(above.distance, 0.05, 1e-9);
  EXPECT_NEAR(above.normal.y(), 1, 1e-9);
  const contact::Distance between = DistanceTo(two, {0.5, -0.2, 0});
  EXPECT_NEAR(between.distance, 0.05, 1e-9);
  EXPECT_NEAR(between.normal.y(), 1, 1e-9);
}

TEST(ObstaclesTest, WithoutObstaclesEverythingIsFarAway) {
  EXPECT_GT(DistanceTo({}, Eigen::Vector3d::Zero()).distance, 1e6);
}

}  // namespace
}  // namespace mane::styling
