#pragma once

namespace mane::groom {

/// How large one groom may be. What exceeds a limit is refused with RESOURCE_EXHAUSTED.
struct Limits {
  /// Guides of one groom, >= 1. A frame grows in proportion; heads of this size run offline, not in
  /// real time.
  int max_guides = 20'000;
  /// Helical elements of all guides together, >= 1. Bounds the memory of a head, about 200 bytes an
  /// element, and the time to solve the rest shape, which is linear in it: 3 to 20 us of one core
  /// an element of hair, 35 us of random shapes and materials, 250 us where the search is hardest;
  /// so ten seconds at this limit, two minutes at worst.
  int max_elements = 400'000;
  /// Points of all imported strands, >= 2; 12 bytes each, while they are imported.
  int max_points = 4'000'000;
  /// Sum over imported strands of ImportCost [s], >= 0: half an hour of one core for tight coils,
  /// minutes for smooth hair. 12,000 strands of 100 points and 20 elements; 4,000 with a bound.
  double max_import_cost_s = 1800;
  /// Vertices of a scalp mesh, >= 3; 12 bytes each.
  int max_vertices = 2'000'000;
  /// Triangles of a scalp mesh, >= 1; 12 bytes each.
  int max_triangles = 2'000'000;
  /// Bodies that hair meets, >= 0.
  int max_bodies = 64;
  /// Vertices of all body meshes together, >= 0; 12 bytes each. With triangles they bound how long
  /// their distance fields take: seconds to a minute of one core at this limit.
  int max_body_vertices = 500'000;
  /// Triangles of all body meshes together, >= 0; 12 bytes each.
  int max_body_triangles = 1'000'000;
  /// Hairs that ride on the guides, >= 0; 14 bytes each.
  int max_hairs = 1'000'000;
  /// Control points of all hairs together, >= 0; 8 bytes each. An upload of this size holds 320 MB
  /// while it comes, and three times that while it is stored.
  int max_hair_points = 40'000'000;
};

}  // namespace mane::groom
