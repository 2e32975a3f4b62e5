#pragma once

namespace mane::groom {

/// How large one groom may be. What exceeds a limit is refused with RESOURCE_EXHAUSTED.
struct Limits {
  /// Guides of one groom, >= 1. A frame grows in proportion; heads of this size run offline, not in
  /// real time.
  int max_guides = 20'000;
  /// Helical elements of all guides together, >= 1. Bounds the memory of a head, about 200 bytes an
  /// element, and the time of the rest shape, which also grows with the square of the elements of
  /// one guide.
  int max_elements = 400'000;
  /// Vertices of a scalp mesh, >= 3; 12 bytes each.
  int max_vertices = 2'000'000;
  /// Triangles of a scalp mesh, >= 1; 12 bytes each.
  int max_triangles = 2'000'000;
};

}  // namespace mane::groom
