#pragma once

#include <Eigen/Core>

#include <functional>
#include <optional>

#include "contact/mesh.h"

namespace mane::contact::fixtures {

/// Vertices on the unit sphere, 20 * 4^levels triangles, moved by `place`.
TriangleMesh Sphere(int levels,
                    const std::function<Eigen::Vector3d(const Eigen::Vector3d&)>& place);
/// A sphere of this radius [m] about `centre`.
TriangleMesh Sphere(int levels, double radius,
                    const Eigen::Vector3d& centre = Eigen::Vector3d::Zero());

/// A box from `low` to `high`, each side cut into cells * cells squares.
TriangleMesh Box(const Eigen::Vector3d& low, const Eigen::Vector3d& high, int cells = 1);

/// A torus about the y axis.
TriangleMesh Torus(double ring_radius, double tube_radius, int around, int across);

/// Tetrahedra with sides of some `size` at random places that overlap: a mesh of few bytes whose
/// surface is all folds, and no part of which is far from any other.
TriangleMesh Heap(int tetrahedra, double size);

/// Both meshes as one.
TriangleMesh Together(const TriangleMesh& a, const TriangleMesh& b);

/// The triangles of which `keep` says so, given their centroid.
TriangleMesh Part(const TriangleMesh& mesh,
                  const std::function<bool(const Eigen::Vector3f&)>& keep);

/// Every triangle turned.
TriangleMesh Inverted(TriangleMesh mesh);

/// The group `body` of the shared MakeHuman head, in metres; nothing where it is not there. Set
/// MANE_SHARED to look for it elsewhere than beside the repository.
std::optional<TriangleMesh> RealBody();

}  // namespace mane::contact::fixtures
