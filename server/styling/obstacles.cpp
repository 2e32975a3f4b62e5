#include "styling/obstacles.h"

namespace mane::styling {

contact::Distance DistanceTo(const Obstacles& obstacles, const Eigen::Vector3d& point) {
  contact::Distance nearest{1e9, Eigen::Vector3d::UnitY()};
  for (const Obstacle& obstacle : obstacles) {
    contact::Distance distance = contact::At(obstacle.shape, obstacle.pose.Inverse() * point);
    if (distance.distance >= nearest.distance) continue;
    nearest = {distance.distance, obstacle.pose.q * distance.normal};
  }
  return nearest;
}

}  // namespace mane::styling
