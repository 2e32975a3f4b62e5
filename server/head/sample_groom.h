#pragma once

#include <memory>

#include "groom/groom.h"

namespace mane::head {

/// What a sample groom holds: straight and curled guides by turns, wound ones, or wound ones as
/// every fourth of the others.
enum class SampleHair { kPlain, kWound, kMixed };

/// A small groom for tests: `guides` guides of `elements` elements, of lengths from 0.1 to 0.3 m,
/// on a ring around the head's vertical axis.
[[nodiscard]] std::shared_ptr<const groom::Groom> SampleGroom(int guides, int elements,
                                                              SampleHair hair = SampleHair::kMixed);

/// Guides of a preset, generated on the upper part of an ellipsoid the size of a head; `elements` 0
/// lets their number be chosen.
[[nodiscard]] std::shared_ptr<const groom::Groom> GeneratedGroom(groom::HairType type, int guides,
                                                                 double length, int elements);

}  // namespace mane::head
