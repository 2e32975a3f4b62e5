#pragma once

#include <Eigen/Core>

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace mane::styling {

/// A grey image over the scalp (ScalpChart): rows from top to bottom, values in [0, 1].
struct MapImage {
  int width = 0;              ///< 1 to 4096.
  int height = 0;             ///< 1 to 4096.
  std::vector<float> values;  ///< (height x width), row by row.
};

/// A number given at places along a line, linear between them and constant beyond them.
struct Stop {
  double at = 0;
  double value = 0;
};

/// A number for every point of the scalp: the product of what is set.
struct ScalpMap {
  double value = 1;                       ///< Everywhere.
  std::vector<Stop> by_polar;             ///< Over the polar angle [rad]; empty for 1.
  std::vector<Stop> by_azimuth;           ///< Over the azimuth [rad], periodic; empty for 1.
  std::shared_ptr<const MapImage> image;  ///< Null for 1.
};

/// A part of the scalp: where everything that is set holds; nothing set is the whole scalp.
struct Region {
  struct Interval {
    double low = 0, high = 0;
  };
  /// n . x >= offset, head frame [m].
  struct HalfSpace {
    Eigen::Vector3d normal = Eigen::Vector3d::UnitY();
    double offset = 0;
  };
  std::optional<Interval> polar;    ///< [rad]
  std::optional<Interval> azimuth;  ///< [rad]; low > high goes through pi.
  std::vector<HalfSpace> half_spaces;
  std::shared_ptr<const MapImage> mask;  ///< Above 0.5 is in; null for everywhere.
  std::vector<uint32_t> wisps;           ///< Numbers of wisps, increasing; empty for all.
};

/// A probability density of one number.
struct Distribution {
  enum class Form : int { kConstant, kUniform, kNormal, kSampled };
  Form form = Form::kConstant;
  double mean = 1;       ///< Of kConstant and kNormal.
  double deviation = 0;  ///< Standard deviation of kNormal, before it is cut off at low and high.
  double low = 0;        ///< Of all but kConstant: nothing is below,
  double high = 2;       ///< nor above.
  /// Of kSampled: densities at equal distances from low to high, two or more, linear between,
  /// >= 0, not all 0; their scale does not matter.
  std::vector<double> densities;
};

/// Shipped prototype strands.
enum class StrandKind : int { kStraight, kWavy, kCurly, kFuzzy, kKinky };

/// The strand whose pattern all master strands have.
struct Prototype {
  StrandKind kind = StrandKind::kStraight;  ///< Where `points` is empty.
  double amplitude_m = 0;  ///< Of a shipped one: radius of its curls; 0 for its own.
  double period_m = 0;     ///< Of a shipped one: length of a turn along its axis; 0 likewise.
  std::vector<Eigen::Vector3d> points;  ///< Polyline, root first [m]; any position and spacing.
};

/// How master strands are drawn from the prototype ([CK05] 2.2.2).
struct Synthesis {
  Prototype prototype;
  int window = 0;  ///< h, control points; 0 for the longest structure that is found.
  double temperature =
      0;  ///< T, relative to the rms size of the prototype's details; 0: best match.
};

/// One part of the styling force field ([CK05] 3.1, 6.1); all parts add up.
struct FieldTerm {
  enum class Kind : int {
    kUniform,     ///< strength * direction: gravity.
    kPulledBack,  ///< Toward `center`: hair is drawn to where it will be tied.
    kRadial,      ///< Away from `center`.
    kVortex,      ///< Around the axis `direction` through `center`.
    kGrid,        ///< Trilinear in `grid`.
  };
  /// Vectors at the nodes of a box; zero outside.
  struct Grid {
    Eigen::Vector3d low = Eigen::Vector3d::Zero();  ///< First node [m].
    double cell = 0.01;                             ///< [m]
    Eigen::Vector3i nodes = Eigen::Vector3i::Zero();
    std::vector<Eigen::Vector3f> values;  ///< x fastest, then y, then z.
  };
  Kind kind = Kind::kUniform;
  double strength = 1;
  Eigen::Vector3d direction = -Eigen::Vector3d::UnitY();
  Eigen::Vector3d center = Eigen::Vector3d::Zero();
  /// Within this distance of `center` (of the axis, of a vortex) it acts in full, and fades to
  /// nothing at twice that; 0 for everywhere. [m]
  double radius = 0;
  std::shared_ptr<const Grid> grid;
};

/// One styling constraint ([CK05] 4).
struct Constraint {
  enum class Kind : int { kPoint, kTrajectory, kDirection };
  Kind kind = Kind::kPoint;
  std::vector<Eigen::Vector3d> path;  ///< One point, or the polyline of the trajectory [m].
  double radius = 0.01;               ///< Tolerance, or influence of kDirection [m].
  double weight = 1;                  ///< w of (7), in [0, 1].
};

/// Constraints that a selected portion of the hair meets one after the other.
struct ConstraintQueue {
  std::string name;    ///< For reports.
  std::string source;  ///< Path of the operation that made it, which errors name; empty for none.
  Region selection;
  /// Of a braid or of strands that part: the selected wisps are dealt out by azimuth, or for
  /// `share_count` > 1 this queue takes every wisp of the `share`-th of so many equal parts.
  int share = 0, share_count = 1;
  std::vector<Constraint> constraints;
};

/// Where hair is cut ([CK05] 6.2): master strands of `region` are at most so long.
struct Cut {
  Region region;
  std::optional<double> length;            ///< [m]
  std::optional<Region::HalfSpace> plane;  ///< Ends deformed hair where it first leaves it.
};

/// Colour of strands ([CK05] 5): hue (turns), saturation and value in [0, 1], each of its own
/// distribution.
struct Colouring {
  Distribution hue, saturation, value;
  /// Part of each channel's deviation from its mean that all strands of a wisp share, in [0, 1].
  double wisp_share = 0;
};

/// A hairstyle, whole: [CK05]'s parameters. The same style, scalp and head make the same bits.
struct Style {
  uint64_t seed = 0;
  int wisp_count = 2000;     ///< N_w, 1 to 20,000.
  int strand_count = 20000;  ///< N_s, members of all wisps together, 0 to 1,000,000.

  ScalpMap density;     ///< Relative.
  ScalpMap length;      ///< Of master strands [m].
  ScalpMap protrusion;  ///< 1: roots leave along the normal; 0: along the surface, with the field.

  double segment_length = 0.01;  ///< Of the outline [m]; one control point a segment.
  Synthesis synthesis;
  /// Other prototypes for parts of the scalp; the last whose region holds wins.
  struct RegionalSynthesis {
    Region region;
    Synthesis synthesis;
  };
  std::vector<RegionalSynthesis> regional;

  Distribution member_length;  ///< l(u), of members, relative to their master.
  std::vector<double> radii{
      0.01};               ///< r(s) at equal distances from root to tip [m], linear between.
  double fuzziness = 0.1;  ///< sigma.

  std::vector<FieldTerm> field;    ///< Phi.
  double bending_stiffness = 0.5;  ///< kappa.
  double density_threshold = 0.9;  ///< tau.
  double strand_cross_section =
      7e-8;             ///< What a strand takes of the density field [m^2], air included.
  double cell = 0.008;  ///< Of the density field [m].
  std::vector<ConstraintQueue> queues;
  std::vector<Cut> cuts;

  Colouring colour;
};

}  // namespace mane::styling
