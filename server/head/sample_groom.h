#pragma once

#include <memory>

#include "groom/groom.h"

namespace mane::head {

/// A small groom for tests: `guides` guides of `elements` elements, straight and curled by turns,
/// every fourth a wound one, of lengths from 0.1 to 0.3 m, on a ring around the head's vertical
/// axis.
[[nodiscard]] std::shared_ptr<const groom::Groom> SampleGroom(int guides, int elements);

/// Guides of a preset, generated on the upper part of an ellipsoid the size of a head.
[[nodiscard]] std::shared_ptr<const groom::Groom> GeneratedGroom(groom::HairType type, int guides,
                                                                 double length, int elements);

}  // namespace mane::head
