#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "mane/bodies.h"
#include "mane/geometry.h"
#include "mane/hairs.h"
#include "mane/strands.h"

namespace mane::inline client {

/// Hair types of [SH06] Appendix B: F. Bertails, B. Audoly, M.-P. Cani, B. Querleux, F. Leroy,
/// J.-L. Leveque, "Super-Helices for Predicting the Dynamics of Natural Hair", SIGGRAPH 2006.
enum class HairType {
  kUnspecified = 0,  ///< Hair whose guides were uploaded.
  kAsianSmooth = 1,
  kCaucasianWavy = 2,
  kCaucasianCurly = 3,
  kAfricanFuzzy = 4,
};

/// How a strand's shape is described by the unknowns of its N elements.
enum class StrandModel {
  kUnspecified = 0,  ///< Of a Guide: kSuperHelix. Of a GuideGeneration: the server chooses.
  /// [SH06]: each element has constant material curvatures and twist. Right for any hair that its
  /// elements can follow: two of them, better three or four, for each turn of natural curl.
  kSuperHelix = 1,
  /// For hair that winds more often: the Super-Helix lies along the axis of the natural coil, and
  /// the coil around it twists and stretches. Five to ten elements are enough for any number of
  /// turns. Every element needs natural curvature, which should change little to the next.
  kWound = 2,
};

/// One guide strand: a Super-Helix of N elements, each of constant material curvatures and twist.
/// Ranges are the server's; a number outside them is refused by its field's name.
struct Guide {
  Vector3 root_position;  ///< Clamped end, head frame [m].
  /// Material frame at the root: takes (n0, n1, n2) coordinates to the head frame. n0, the image of
  /// (1, 0, 0), is the direction in which the strand leaves the scalp.
  Quaternion root_frame;

  double length_m = 0;              ///< Strand length L [m], in (0, 5].
  std::uint32_t element_count = 0;  ///< N, 1 to 256; 0 when `element_lengths_m` says it.
  /// Element lengths, root to tip [m]; empty for N equal ones. They add up to `length_m`, which may
  /// be left 0.
  std::vector<double> element_lengths_m;

  double radius_1_m = 0;  ///< Semi-axis of the elliptic section along n1 [m], in [1e-6, 1e-2].
  double radius_2_m = 0;  ///< Semi-axis along n2 [m], in [1e-6, 1e-2].
  double young_modulus_pa = 0;   ///< E [Pa], in [1e4, 1e13].
  double poisson_ratio = 0;      ///< In (-1, 0.5].
  double density_kg_m3 = 0;      ///< [kg/m^3], in [1, 1e5]. Hair: 1300.
  double internal_friction = 0;  ///< gamma of [SH06] (5d) [kg m^3/s], in [0, 1].
  double air_drag = 0;           ///< nu of [SH06] (5a) [kg/(m s)], in [0, 10].

  /// Natural twist and curvatures per element, root to tip [rad/m], within ±1e5: N numbers each, or
  /// one for all elements, or none for zero. Component i turns about n_i.
  std::vector<double> natural_twist;
  std::vector<double> natural_curvature_1;
  std::vector<double> natural_curvature_2;

  StrandModel model = StrandModel::kSuperHelix;

  /// Of the wisp of hair that the guide stands for, which other guides' wisps stay out of [m], in
  /// [0, 0.1]; 0 for none.
  double wisp_radius_m = 0;
};

/// An ellipsoid with axes along the head frame. Hair grows where the outward normal is within
/// `cap_angle` of `cap_axis`.
struct EllipsoidScalp {
  Vector3 center = {};             ///< [m]
  Vector3 radii_m{0.1, 0.1, 0.1};  ///< [m], each in [1e-3, 10].
  Vector3 cap_axis{0, 1, 0};
  double cap_angle = 0;  ///< [rad], in (0, pi]; 0 means the whole ellipsoid.
};

/// Asks the server to place and shape guides itself.
struct GuideGeneration {
  HairType hair_type = HairType::kUnspecified;  ///< Required.
  std::uint32_t guide_count = 0;    ///< 1 to the server's limit, blue noise over the hair region.
  double length_m = 0;              ///< [m], in (0, 5].
  std::uint32_t element_count = 0;  ///< N per guide, of graded lengths; 0 lets the server choose.
  /// With element_count 0: how far a tip may be from where infinitely many elements would have it,
  /// at rest and in a moderate shake, rms, relative to the length. In [1e-3, 0.2]; unset is 0.02.
  std::optional<double> error_target = std::nullopt;
  std::uint64_t seed = 0;  ///< Same scalp, same numbers, same seed: same bits.
  /// Relative variation of natural curvatures and twist along a strand, in [0, 1].
  double curl_variation = 0.05;
  /// How far roots lean from the scalp's normal toward the ground, 0 (not at all) to 1.
  double root_droop = 0.3;
  /// kUnspecified takes kWound for hair that turns at least five times, and more than N / 2 times.
  StrandModel model = StrandModel::kUnspecified;
  double wisp_radius_m = 0;  ///< Of all guides, as in Guide.
};

/// A new groom: a scalp if there is one, and guides, strands to make them of, or the wish to have
/// them generated on the scalp.
struct GroomUpload {
  std::string groom_id;      ///< Last part of the name; empty lets the server choose.
  std::string display_name;  ///< Free text, at most 200 bytes.
  std::string request_id;    ///< Any unique string of at most 64 bytes; makes a retry safe.
  std::variant<std::monostate, EllipsoidScalp, TriangleMesh> scalp;
  std::variant<std::vector<Guide>, GuideGeneration, StrandImport> guides;
  std::optional<ScalpContact> scalp_contact = {};  ///< Set where hair meets the scalp.
  std::vector<Body> bodies = {};                   ///< What else it meets, at most 64.
  Hairs hairs = {};  ///< That ride on the guides, however these are made; at most 1,000,000.
};

/// What the server tells about a stored groom.
struct GroomInfo {
  std::string name;  ///< `grooms/{groom}`
  std::string display_name;
  double create_time_s = 0;  ///< Seconds since 1970, UTC.
  std::uint32_t guide_count = 0;
  std::uint32_t element_count = 0;  ///< Of all guides together.
  double longest_guide_m = 0;       ///< [m]
  HairType hair_type = HairType::kUnspecified;
  std::uint64_t seed = 0;
  std::string etag;  ///< Digest of the content: equal content, equal etag.
  bool has_scalp = false;
  std::optional<ImportSummary> import_summary;  ///< Of a groom made from strands.
  std::uint32_t body_count = 0;                 ///< That its hair meets, but for the scalp.
  std::vector<BodySummary> bodies;              ///< Those; ListGrooms() leaves them out.
  std::optional<ScalpContact> scalp_contact;    ///< Set where its hair meets the scalp.
  std::uint32_t hair_count = 0;                 ///< Hairs that ride on its guides.
  std::uint64_t hair_point_count = 0;           ///< Their control points.
};

/// How the head is held for a rest shape.
struct RestShapeOptions {
  Quaternion head_orientation = {};     ///< head -> world.
  Vector3 gravity{0, -9.81, 0};         ///< World [m/s^2].
  std::uint32_t points_per_guide = 16;  ///< 2 to 256.
};

/// Static equilibrium of every guide under gravity with the head at rest.
struct RestShape {
  std::uint32_t points_per_guide = 0;
  /// Points at equal arc length, root first, tip last [m], head frame, (guide, point, 3).
  std::vector<double> positions;
  /// Guide by guide [rad/m]: (element, 3) twist and curvatures; of a StrandModel::kWound guide
  /// (element, 4) changes of the coil's twist, curvatures 1 and 2 of its axis, and change of the
  /// strain towards the hair's tangent.
  std::vector<double> curvatures;
  /// Largest unbalanced generalized force over the weight's largest one, (guide); at most 1e-6
  /// where the solver converged.
  std::vector<double> residuals;
};

}  // namespace mane::inline client
