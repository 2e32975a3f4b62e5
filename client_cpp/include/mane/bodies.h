#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <variant>

#include "mane/geometry.h"

namespace mane::inline client {

/// What a surface is made of: how hair rubs on it.
enum class Material {
  kUnspecified = 0,  ///< In the middle of the others.
  kSkin = 1,
  kCotton = 2,
  kWool = 3,
  kSilk = 4,
  kLeather = 5,
  kPolished = 6,  ///< Lacquer, metal, glass.
};

/// About the origin of the body's frame, axes along it.
struct EllipsoidBody {
  Vector3 radii_m{0.1, 0.1, 0.1};  ///< [m], each in [1e-4, 100], at most 100 times each other.
};

/// All points within `radius_m` of the segment from `a` to `b`, which may coincide.
struct CapsuleBody {
  Vector3 a = {};  ///< Body frame [m], each component within ±1000.
  Vector3 b = {};
  double radius_m = 0.1;  ///< [m], in [1e-4, 100].
};

/// A rigid solid that hair meets. What bends is several of these, one a bone. Ranges are the
/// server's; a number outside them is refused by its field's name, a mesh that bounds no solid by
/// its body's.
struct Body {
  /// `[a-z0-9]([a-z0-9_-]{0,61}[a-z0-9])?`, unique in its groom; BodyPose names it.
  std::string name = {};
  /// A mesh is in the body's frame, its `hair_triangles` empty; holes are closed, up to a fifth of
  /// the surface.
  std::variant<EllipsoidBody, CapsuleBody, TriangleMesh> shape = {};
  Material material = Material::kUnspecified;
  /// Coulomb's coefficient across the hair, in [0, 10]; unset is that of `material`.
  std::optional<double> friction = std::nullopt;
  /// By how much it rises where hair slides towards its tip, and falls where it slides towards its
  /// root, in [0, 1]; unset is that of `material`.
  std::optional<double> friction_anisotropy = std::nullopt;
  bool moving = false;  ///< Whether poses may place it; else it is fixed to the head.
  Pose pose = {};       ///< body -> head; of a moving body: where it is until it is placed.
};

/// What the server found in a mesh that hair meets, and what it made of it.
struct MeshReport {
  std::uint32_t triangles = 0;  ///< As given.
  std::uint32_t holes = 0;      ///< That were closed.
  bool inverted = false;        ///< Every triangle faced inwards and was turned.
  double max_error_m = 0;       ///< Largest error found of the distance to its surface, near it.
  std::uint64_t bytes = 0;      ///< Memory of its distance field on the server.
};

/// That hair meets the scalp, and how it rubs there: as in Body.
struct ScalpContact {
  Material material = Material::kUnspecified;
  std::optional<double> friction = std::nullopt;
  std::optional<double> friction_anisotropy = std::nullopt;
  std::optional<MeshReport> mesh = std::nullopt;  ///< Of a mesh; told by the server, not sent.
};

/// What describes a body of a stored groom.
struct BodySummary {
  enum class Shape { kUnspecified = 0, kEllipsoid = 1, kCapsule = 2, kMesh = 3 };
  std::string name = {};
  Shape shape = Shape::kUnspecified;
  bool moving = false;
  std::optional<MeshReport> mesh = std::nullopt;  ///< Of a mesh.
};

/// Where a moving body is.
struct BodyPose {
  std::string name = {};  ///< Body::name
  Pose pose = {};         ///< body -> world.
};

}  // namespace mane::inline client
