#pragma once

#include "base/result.h"
#include "beam/hull.h"
#include "groom/groom.h"

namespace mane::groom {

/// The hull that stands for a head: an ellipsoid itself; of a mesh, the hull (beam::FitHull) of the
/// corners of the triangles on which hair grows, and of what lies above their middle height and
/// within their extent to the sides, front and back: neither of the jaw, which an ellipsoid around
/// the skull fits badly, nor of neck and shoulders. Hair that grows everywhere: of all of the mesh.
///
/// @param scalp  valid and not empty. @return INVALID_ARGUMENT naming `scalp_mesh`, also where a
///   radius would be above 10 m.
[[nodiscard]] Result<beam::Hull> ScalpHull(const Scalp& scalp);

}  // namespace mane::groom
