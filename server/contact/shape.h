#pragma once

#include <memory>
#include <variant>

#include "base/result.h"
#include "contact/capsule.h"
#include "contact/distance.h"
#include "contact/ellipsoid.h"
#include "contact/mesh_field.h"

namespace mane::contact {

/// The shape of a body, in the frame of the bone that it hangs on.
using BodyShape = std::variant<Ellipsoid, Capsule, std::shared_ptr<const MeshField>>;

/// INVALID_ARGUMENT naming `radii`, `a`, `b` or `radius` unless radii lie in [1e-4, 100] m and are
/// at most 100 times each other, and ends within ±1000 m. A mesh was checked when its field was
/// built; none is a fault of this program.
[[nodiscard]] Result<void> Validate(const BodyShape& shape);

/// Distance and normal at a point in the shape's frame. A mesh answers in float32 and with the
/// error that its field states; the others are exact to rounding.
[[nodiscard]] Distance At(const BodyShape& shape, const Eigen::Vector3d& point);

/// The same for many points, in float32. No locks, no allocation, thread-safe.
void At(const BodyShape& shape, const PointSpans& points, const DistanceSpans& out);

}  // namespace mane::contact
