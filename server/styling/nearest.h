#pragma once

#include <Eigen/Core>

#include <cstdint>
#include <span>
#include <vector>

namespace mane::styling {

/// Finds the nearest of many points: a k-d tree. Immutable; any thread may ask.
class NearestPoint {
 public:
  /// @param points  one or more.
  explicit NearestPoint(std::span<const Eigen::Vector3d> points);

  /// Index of the point nearest to `x` by straight distance; of equally near ones the smallest.
  /// O(log points) where they lie on a surface.
  [[nodiscard]] int Find(const Eigen::Vector3d& x) const;

 private:
  // A point, and the plane that parts the range of which it is the middle one.
  struct Node {
    Eigen::Vector3d point;
    int index = 0;
    int axis = 0;
  };
  struct Best {
    double squared;
    int index;
  };

  void Build(int begin, int end);
  void Search(int begin, int end, const Eigen::Vector3d& x, Best& best) const;

  std::vector<Node> nodes_;
};

}  // namespace mane::styling
