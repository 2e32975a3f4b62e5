#include "contact/winding.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <numbers>
#include <numeric>

#include "base/check.h"
#include "contact/search_budget.h"
#include "contact/triangle.h"

namespace mane::contact {
namespace {

using Eigen::Vector3d;

constexpr int kLeafSize = 8;

// A node is one dipole from this many radii on; its error falls with the square.
constexpr double kFar = 2;

// What a node and a triangle take [ns].
constexpr uint64_t kNodeWork = 5, kTriangleWork = 30;

}  // namespace

WindingTree::WindingTree(const SolidMesh& mesh) : mesh_(mesh), order_(mesh.triangles.size()) {
  MANE_CHECK(!mesh.triangles.empty());
  centres_.reserve(mesh.triangles.size());
  for (const auto& [a, b, c] : mesh.triangles) {
    centres_.emplace_back((mesh.vertices[a] + mesh.vertices[b] + mesh.vertices[c]) / 3);
  }
  std::iota(order_.begin(), order_.end(), 0);
  nodes_.reserve(mesh.triangles.size() / 2 + 1);
  Build(0, static_cast<int>(order_.size()));
}

int WindingTree::Build(int begin, int end) {
  const int index = static_cast<int>(nodes_.size());
  nodes_.emplace_back();
  Vector3d sum = Vector3d::Zero(), moment = Vector3d::Zero();
  Vector3d low = centres_[order_[begin]], high = low;
  double total = 0;
  for (int i = begin; i < end; ++i) {
    const auto& [a, b, c] = mesh_.triangles[order_[i]];
    const Vector3d& origin = mesh_.vertices[a];
    const Vector3d area = (mesh_.vertices[b] - origin).cross(mesh_.vertices[c] - origin) / 2;
    const Vector3d& centre = centres_[order_[i]];
    sum += area;
    moment += area.norm() * centre;
    total += area.norm();
    low = low.cwiseMin(centre);
    high = high.cwiseMax(centre);
  }
  const Vector3d centre = total > 0 ? Vector3d(moment / total) : Vector3d((low + high) / 2);
  double radius = 0;
  for (int i = begin; i < end; ++i) {
    for (const uint32_t v : mesh_.triangles[order_[i]]) {
      radius = std::max(radius, (mesh_.vertices[v] - centre).norm());
    }
  }
  int right = 0;
  if (end - begin > kLeafSize) {
    int axis;
    (high - low).maxCoeff(&axis);
    const int middle = (begin + end) / 2;
    std::nth_element(order_.begin() + begin, order_.begin() + middle, order_.begin() + end,
                     [&](int a, int b) {
                       const double x = centres_[a][axis], y = centres_[b][axis];
                       return x < y || (x == y && a < b);
                     });
    Build(begin, middle);
    right = Build(middle, end);
  }
  nodes_[index] = {centre, sum, radius, begin, end, right};
  return index;
}

double WindingTree::Number(const Vector3d& point) const {
  double angle = 0;
  uint64_t work = 0;
  std::array<int, 64> waiting;  // The tree halves its triangles: 24 levels at most.
  int count = 0;
  waiting[count++] = 0;
  while (count > 0) {
    const int index = waiting[--count];
    const Node& node = nodes_[index];
    work += kNodeWork;
    const Vector3d d = node.centre - point;
    const double squared = d.squaredNorm();
    if (squared > kFar * kFar * node.radius * node.radius) {
      angle += node.area_vector.dot(d) / (squared * std::sqrt(squared));
    } else if (node.right == 0) {
      work += kTriangleWork * (node.end - node.begin);
      for (int i = node.begin; i < node.end; ++i) {
        const auto& [a, b, c] = mesh_.triangles[order_[i]];
        angle += SolidAngle(point, mesh_.vertices[a], mesh_.vertices[b], mesh_.vertices[c]);
      }
    } else {
      waiting[count++] = node.right;
      waiting[count++] = index + 1;
    }
  }
  SearchBudget::Count(work);
  return angle / (4 * std::numbers::pi);
}

}  // namespace mane::contact
