#pragma once

#include <vector>

#include "contact/mesh.h"

namespace mane::contact {

/// Generalised winding number of a mesh at any point: 1 inside, 0 outside a simple solid.
///
/// The sum of solid angles over 4 pi (D6), with triangles that are far for their spread replaced by
/// one dipole (D7), after Barill et al., "Fast Winding Numbers for Soups and Clouds" (2018). Of a
/// closed mesh it is an integer but for the dipoles' error, a tenth at most.
class WindingTree {
 public:
  /// Keeps a reference to `mesh`. O(T log T).
  explicit WindingTree(const SolidMesh& mesh);

  /// O(log T) where the mesh is well-behaved, else O(T); thread-safe, no allocation. Counted by the
  /// thread's SearchBudget.
  [[nodiscard]] double Number(const Eigen::Vector3d& point) const;

  /// Whether `point` is within the solid: where pieces overlap too, but not in a cavity.
  [[nodiscard]] bool Inside(const Eigen::Vector3d& point) const { return Number(point) > 0.5; }

 private:
  struct Node {
    Eigen::Vector3d centre;       // Of area [m].
    Eigen::Vector3d area_vector;  // Sum of the triangles' [m^2].
    double radius;                // Of the vertices about the centre [m].
    int begin, end;               // In order_.
    int right;                    // The second child; the first follows its parent. 0 in a leaf.
  };

  int Build(int begin, int end);

  const SolidMesh& mesh_;
  std::vector<Eigen::Vector3d> centres_;  // Of triangles.
  std::vector<int> order_;                // Triangles, by leaf.
  std::vector<Node> nodes_;
};

}  // namespace mane::contact
