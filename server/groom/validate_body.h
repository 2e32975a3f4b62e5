#pragma once

#include <optional>
#include <span>
#include <string>

#include "base/result.h"
#include "groom/body.h"
#include "groom/groom.h"
#include "groom/limits.h"

namespace mane::groom {

/// Of ellipsoids that hair meets: the largest radius over the smallest.
inline constexpr double kLargestRadiusRatio = 100;

/// INVALID_ARGUMENT for a number of `friction` out of its range, named as `path` followed by
/// `friction` or `friction_anisotropy`.
[[nodiscard]] Result<void> ValidateFriction(const std::string& path, const Friction& friction);

/// `body`, its orientation of norm one: mane.v1.Body, whose comments give ranges. What a mesh
/// holds is not looked at: head::MakeBodies does, by making its distance field.
///
/// @param index  of the body in its groom; errors name fields as `bodies[<index>].friction`.
/// @return INVALID_ARGUMENT for the first field out of its range; NaN is out of every range.
[[nodiscard]] Result<Body> MakeBody(Body body, int index);

/// Whether `bodies`, each made by MakeBody, may be together, and whether hair that meets the scalp
/// has one to meet.
///
/// @return RESOURCE_EXHAUSTED above `limits`; INVALID_ARGUMENT naming the second of two bodies of
///   one name, a field of `header.scalp_contact`, or `header.ellipsoid.radii_m` where they are too
///   unlike.
[[nodiscard]] Result<void> ValidateBodies(std::span<const Body> bodies,
                                          const std::optional<Friction>& scalp_friction,
                                          const Scalp& scalp, const Limits& limits);

}  // namespace mane::groom
