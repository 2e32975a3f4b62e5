#pragma once

#include <Eigen/Core>

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include "groom/body.h"
#include "math/rigid.h"
#include "rod/batch.h"
#include "rod/strand.h"
#include "rod/wound.h"

namespace mane::groom {

struct Hairs;  // groom/hairs.h

/// Hair types of [SH06] Appendix B; kCustom is hair whose guides were uploaded.
enum class HairType { kCustom, kAsianSmooth, kCaucasianWavy, kCaucasianCurly, kAfricanFuzzy };

/// How a guide is described by its unknowns: mane.v1.StrandModel.
enum class StrandModel : int { kSuperHelix, kWound };

/// Triangles in the head frame, counter-clockwise seen from outside.
struct TriangleMesh {
  std::vector<Eigen::Vector3f> vertices;           ///< [m]
  std::vector<std::array<uint32_t, 3>> triangles;  ///< Vertex indices.
  std::vector<uint32_t> hair_triangles;            ///< Where hair grows; empty means everywhere.
};

/// An ellipsoid with axes along the head frame; hair grows where the outward normal is within
/// `cap_angle` [rad] of `cap_axis`.
struct Ellipsoid {
  Eigen::Vector3d center = Eigen::Vector3d::Zero();  ///< [m]
  Eigen::Vector3d radii = Eigen::Vector3d::Ones();   ///< [m]
  Eigen::Vector3d cap_axis = Eigen::Vector3d::UnitY();
  double cap_angle = 3.14159265358979323846;  ///< In (0, pi].
};

using Scalp = std::variant<std::monostate, TriangleMesh, Ellipsoid>;

/// One guide strand as its author described it, and the rod that follows from it.
struct Guide {
  math::Pose root;  ///< Material frame at the clamped end, in the head frame; n0 leaves the scalp.
  rod::Section section;
  rod::Material material;
  rod::Strand strand;  ///< Stiffness and density already derived from section and material.
  /// Where the guide moves as a wound strand, that strand.
  std::optional<rod::WoundStrand> wound;
  /// Of the wisp that it stands for, which other guides' wisps do not enter [m]; 0 for none.
  double wisp_radius = 0;

  /// Numbers that say its shape: 3 for each element, 4 of a wound one.
  [[nodiscard]] int coordinate_count() const { return (wound ? 4 : 3) * strand.elements(); }
};

/// A hair asset. Immutable once it is built by `Assemble`, and shared by every head that animates
/// it.
struct Groom {
  std::string display_name;
  HairType hair_type = HairType::kCustom;
  uint64_t seed = 0;
  Scalp scalp;
  std::vector<Guide> guides;
  std::vector<Body> bodies;
  /// Whether hair meets the scalp itself, and how it rubs there; the scalp counts as a body fixed
  /// to the head.
  std::optional<Friction> scalp_friction;
  /// That ride on the guides, at least one; null for none. Heads do not look at them.
  std::shared_ptr<const Hairs> hairs;

  // Derived by Assemble().
  /// Whether its hair meets anything: a body, the scalp, or other wisps.
  bool has_contact = false;
  /// Index of each guide's first element in arrays over all elements, and their total at the end,
  /// (guides + 1).
  std::vector<int> first_element;
  /// The same of coordinates.
  std::vector<int> first_coordinate;
  /// Static equilibrium under standard gravity with the head upright [rad]: element angles
  /// theta_Q = l_Q kappa_Q, or unknowns of wound guides, (coordinates of all guides).
  std::vector<double> rest;
  /// Turning of guides at rest [rad], which all but one in twenty are below.
  double turning = 0;
  /// The guides packed for the batched step; strand i is guide i.
  rod::Batch<float> batch;

  [[nodiscard]] int guide_count() const { return static_cast<int>(guides.size()); }
  [[nodiscard]] int element_count() const { return first_element.back(); }
  [[nodiscard]] int coordinate_count() const { return first_coordinate.back(); }
  /// Plain elements that a time step costs as much as: a wound one costs two (tests/bench/run rod).
  [[nodiscard]] int stepped_elements() const { return coordinate_count() - 2 * element_count(); }
  [[nodiscard]] std::span<const double> rest_of(int guide) const {
    return std::span(rest).subspan(first_coordinate[guide], guides[guide].coordinate_count());
  }
};

}  // namespace mane::groom
