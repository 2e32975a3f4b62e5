#pragma once

#include "base/result.h"
#include "contact/mesh.h"

namespace mane::contact {

/// The solid that a mesh bounds, after what can be mended is mended: duplicate vertices, triangles
/// without area, duplicate triangles, holes, triangles turned the wrong way (alone or all).
///
/// The triangles' boundary, as directed edges counted with their sign, always falls into closed
/// loops (D8). A cone over each makes the mesh a closed chain, whose winding number is an integer
/// everywhere; a single triangle that faces the wrong way is three such edges, twice.
///
/// @param report  receives what was found; complete on success only.
/// @return INVALID_ARGUMENT naming `vertices`, `vertices[7]`, `triangles` or `triangles[7]` for a
///   mesh that is empty, not finite, out of range, refers to vertices that are not there, has too
///   large holes or encloses no volume; RESOURCE_EXHAUSTED above the counts of `limits`.
[[nodiscard]] Result<SolidMesh> Repair(const TriangleMesh& mesh, const MeshLimits& limits,
                                       MeshReport* report);

}  // namespace mane::contact
