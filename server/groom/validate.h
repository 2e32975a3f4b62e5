#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <cstdint>
#include <string>
#include <vector>

#include "base/result.h"
#include "groom/groom.h"
#include "groom/limits.h"
#include "groom/range.h"

namespace mane::groom {

/// Bounds of one guide.
inline constexpr int kMaxElementsPerGuide = 256;
inline constexpr double kMaxLength = 5;            ///< [m]
inline constexpr double kMinElementLength = 1e-6;  ///< [m]
inline constexpr Range kWispRadiusRange{0, 0.1, "m"};
inline constexpr Range kYoungModulusRange{1e4, 1e13, "Pa"};
inline constexpr Range kCurvatureRange{-1e5, 1e5, "rad/m"};  ///< Of natural twist, too.

/// A guide as its author writes it: mane.v1.Guide field by field, whose comments give meanings,
/// units and ranges. Unset messages are replaced by their defaults; any number may be in it.
struct GuideDescription {
  Eigen::Vector3d root_position = Eigen::Vector3d::Zero();
  Eigen::Quaterniond root_frame = Eigen::Quaterniond::Identity();
  double length_m = 0;
  uint32_t element_count = 0;
  std::vector<double> element_lengths_m;
  double radius_1_m = 0;
  double radius_2_m = 0;
  double young_modulus_pa = 0;
  double poisson_ratio = 0;
  double density_kg_m3 = 0;
  double internal_friction = 0;
  double air_drag = 0;
  std::vector<double> natural_twist;
  std::vector<double> natural_curvature_1;
  std::vector<double> natural_curvature_2;
  StrandModel model = StrandModel::kSuperHelix;
  double wisp_radius_m = 0;
};

/// INVALID_ARGUMENT for the first of section, material and damping that is out of its range, named
/// as `path` followed by the field, such as `guides[3].` and `radius_1_m`.
[[nodiscard]] Result<void> ValidateProperties(const std::string& path,
                                              const GuideDescription& description);

/// The guide that `description` says, its stiffness and linear density derived.
///
/// Element lengths are taken as given, or are length_m / N. The root
/// frame is normalised, except where its squared norm is already one to 1e-14.
///
/// @param index  of the guide in its groom; errors name fields as `guides[<index>].length_m`.
/// @return INVALID_ARGUMENT for the first field out of its range; NaN is out of every range.
[[nodiscard]] Result<Guide> MakeGuide(const GuideDescription& description, int index);

/// INVALID_ARGUMENT naming `field` unless `model` is one of StrandModel's.
[[nodiscard]] Result<void> CheckModel(const std::string& field, StrandModel model);

/// Makes `guide` a wound strand.
///
/// @param index  as for MakeGuide. @return INVALID_ARGUMENT naming `guides[<index>].model` unless
/// rod::IsWound says that its natural shape is a coil for that.
[[nodiscard]] Result<void> MakeWound(int index, Guide* guide);

/// The inverse: MakeGuide(Describe(guide)) equals `guide` bit for bit, if MakeGuide made it. Lists
/// are as short as they can be.
[[nodiscard]] GuideDescription Describe(const Guide& guide);

/// Whether guides may grow on `scalp`, or none is given.
///
/// Mesh: RESOURCE_EXHAUSTED above `limits`; else INVALID_ARGUMENT unless vertices are within ±1e6
/// m, indices exist, and the hair region names no triangle twice and has an area of 1e-10 m^2 or
/// more. Errors name `scalp_mesh.vertices[7]` and the like. Ellipsoid: INVALID_ARGUMENT unless the
/// center is within ±1e6 m, radii in [1e-3, 10] m, the cap's axis of a length in [1e-6, 1e6] and
/// its angle in (0, pi], with the area as above. Errors name `header.ellipsoid.radii_m.x` and the
/// like.
[[nodiscard]] Result<void> ValidateScalp(const Scalp& scalp, const Limits& limits);

}  // namespace mane::groom
