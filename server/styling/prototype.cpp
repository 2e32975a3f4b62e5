#include "styling/prototype.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>

#include "groom/range.h"
#include "math/random.h"
#include "styling/outline.h"
#include "styling/spline.h"

namespace mane::styling {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr size_t kLeastPoints = 4, kMostPoints = 4096;
constexpr int kPointsAPeriod = 64;  // Of a shipped prototype.
// A spline through three points a period misses a crest by up to 31 % of a sine's amplitude, one
// through four by 12 %, (W7).
constexpr double kLeastControlPoints = 4;
// Of a curve to its outline, in tight coils: a longer curve has too many segments for certain.
constexpr double kMostWinding = 64;
constexpr int kMostPeriods = 12;  // Of a shipped prototype: enough that no two look alike.
constexpr int kLeastPeriods = 2;  // Synthesis finds no continuation in less.
constexpr uint64_t kSeed = 0x5741565953545244;

// Smooth noise over periods: a Catmull-Rom spline through a standard normal number at every
// integer.
class Noise {
 public:
  Noise(uint64_t stream, int periods) : values_(periods + 1) {
    math::RandomStream random(kSeed, stream);
    for (Vector3d& value : values_) value = {random.Normal(), 0, 0};
  }
  [[nodiscard]] double At(double x) const {
    return Spline<double>(values_).At(x / static_cast<double>(values_.size() - 1)).x();
  }

 private:
  std::vector<Vector3d> values_;
};

// How regular a shipped pattern is: relative deviations of its height and of the length of a turn.
struct Irregularity {
  double height, phase;
};

Irregularity IrregularityOf(StrandKind kind) {
  switch (kind) {
    case StrandKind::kWavy:
      return {0.12, 0.04};
    case StrandKind::kCurly:
      return {0.10, 0.04};
    case StrandKind::kFuzzy:
      return {0.30, 0.10};
    default:
      return {0.20, 0.06};
  }
}

// (W8): offset from the axis at x periods, for an amplitude of 1.
class Shape {
 public:
  Shape(StrandKind kind, int periods)
      : kind_(kind),
        irregular_(IrregularityOf(kind)),
        height_(StreamOf(0), periods),
        phase_(StreamOf(1), periods),
        y_(StreamOf(2), 2 * periods),
        z_(StreamOf(3), 2 * periods) {}

  [[nodiscard]] Vector2d At(double x) const {
    const double height = 1 + irregular_.height * std::clamp(height_.At(x), -2.0, 2.0);
    const double turn = 2 * std::numbers::pi * (x + irregular_.phase * phase_.At(x));
    switch (kind_) {
      case StrandKind::kWavy:  // A wave in a plane that sways a little.
        return height * Vector2d(std::sin(turn), 0.15 * std::cos(0.5 * turn));
      case StrandKind::kCurly:  // A helix.
        return height * Vector2d(std::cos(turn), std::sin(turn));
      case StrandKind::kFuzzy:  // Half a loose helix, half random at twice its pace.
        return height * Vector2d(0.5 * std::cos(turn) + 0.4 * y_.At(2 * x),
                                 0.5 * std::sin(turn) + 0.4 * z_.At(2 * x));
      default: {  // A zigzag, whose kinks the third harmonic sharpens, about a turning plane.
        const double zigzag = (std::sin(turn) - std::sin(3 * turn) / 9) / 1.11;
        const double plane = 0.6 * y_.At(0.5 * x);
        return height * Vector2d(zigzag * std::cos(plane), zigzag * std::sin(plane));
      }
    }
  }

 private:
  [[nodiscard]] uint64_t StreamOf(int number) const {
    return 4 * static_cast<uint64_t>(kind_) + static_cast<uint64_t>(number);
  }

  StrandKind kind_;
  Irregularity irregular_;
  Noise height_, phase_, y_, z_;
};

Result<void> CheckPoints(const std::vector<Vector3d>& points, const std::string& field) {
  if (points.size() < kLeastPoints || points.size() > kMostPoints) {
    return InvalidArgument(field, fmt::format("{} has {} points; a prototype has {} to {}", field,
                                              points.size(), kLeastPoints, kMostPoints));
  }
  for (size_t i = 0; i < points.size(); ++i) {
    const auto point =
        groom::CheckVector(fmt::format("{}[{}]", field, i), points[i], groom::kCoordinateRange);
    if (!point) return point;
  }
  return {};
}

Result<void> CheckSize(const Prototype& prototype, const std::string& field) {
  const groom::Range range{0, 1, "m"};
  if (!range.Contains(prototype.amplitude_m)) {
    return groom::OutOfRange(field + ".amplitude_m", prototype.amplitude_m, range);
  }
  if (!range.Contains(prototype.period_m)) {
    return groom::OutOfRange(field + ".period_m", prototype.period_m, range);
  }
  return {};
}

Error TooCoarse(const std::string& field, double period, double segment_length) {
  return InvalidArgument(
      field, fmt::format(
                 "{} has a period of {:.3g} m along the strand, and segments of {:.3g} m "
                 "make fewer than {:.0f} control points of it; use a segment_length_m of at "
                 "most {:.3g} m, or a longer period",
                 field, period, segment_length, kLeastControlPoints, period / kLeastControlPoints));
}

Pattern PatternOf(const Decomposition& decomposition, double segment_length) {
  Pattern pattern;
  pattern.structure = static_cast<int>(std::lround(decomposition.structure / segment_length));
  for (const Vector3d& delta : decomposition.details) {
    pattern.details.emplace_back(delta.cast<float>());
  }
  return pattern;
}

Result<Pattern> ShippedDetails(const Prototype& prototype, double segment_length,
                               const std::string& field) {
  if (auto size = CheckSize(prototype, field); !size) return size.error();
  if (prototype.kind == StrandKind::kStraight) return Pattern{{Eigen::Vector3f::Zero()}, 0};
  StrandSize size = SizeOf(prototype.kind);
  if (prototype.amplitude_m > 0) size.amplitude = prototype.amplitude_m;
  if (prototype.period_m > 0) size.period = prototype.period_m;
  if (size.period < kLeastControlPoints * segment_length * (1 - 1e-9)) {
    return TooCoarse(field + ".period_m", size.period, segment_length);
  }
  const auto room = static_cast<int>((kMostDetails - 1) * segment_length / size.period);
  if (room < kLeastPeriods) {
    return InvalidArgument(
        field + ".period_m",
        fmt::format("{}.period_m is {:.3g} m, more than {} segments of {:.3g} m; use a shorter "
                    "period, or a segment_length_m of at least {:.3g} m",
                    field, size.period, (kMostDetails - 1) / kLeastPeriods, segment_length,
                    size.period * kLeastPeriods / (kMostDetails - 1)));
  }
  const int periods = std::min(kMostPeriods, room);
  const auto points = ShippedStrand(prototype.kind, size, periods);
  Pattern pattern =
      PatternOf(Decompose(points, segment_length, Length(points) / periods), segment_length);
  // The outline of wide curls is longer than the axis that `room` counts: fewer turns are kept.
  if (pattern.details.size() > kMostDetails) pattern.details.resize(kMostDetails);
  return pattern;
}

}  // namespace

StrandSize SizeOf(StrandKind kind) {
  switch (kind) {
    case StrandKind::kStraight:
      break;
    // Waves and curls as set with rods: the turn's radius is that of [SH06] Appendix B for wavy
    // (10 mm) and curly hair (6 mm); the turns, 5 mm long there, are drawn out by the hair's weight
    // and by combing. A wave's height is less than its bend's radius.
    case StrandKind::kWavy:
      return {0.006, 0.050};
    case StrandKind::kCurly:
      return {0.006, 0.025};
    // As measured there: radius 1 mm, step 10 mm.
    case StrandKind::kFuzzy:
      return {0.001, 0.010};
    // Zigzag of some millimetres, an inner angle of 90 degrees.
    case StrandKind::kKinky:
      return {0.0015, 0.006};
  }
  return {};
}

std::vector<Vector3d> ShippedStrand(StrandKind kind, const StrandSize& size, int periods) {
  const Shape shape(kind, periods);
  std::vector<Vector3d> points;
  for (int i = 0; i <= periods * kPointsAPeriod; ++i) {
    const double x = static_cast<double>(i) / kPointsAPeriod;
    const Vector2d offset = size.amplitude * shape.At(x);
    points.emplace_back(size.period * x, offset.x(), offset.y());
  }
  return points;
}

Result<Pattern> PrototypeDetails(const Prototype& prototype, double segment_length,
                                 const std::string& field) {
  if (prototype.points.empty()) return ShippedDetails(prototype, segment_length, field);
  const std::string points = field + ".points";
  if (auto valid = CheckPoints(prototype.points, points); !valid) return valid.error();
  const double length = Length(prototype.points);
  if (!(length >= segment_length)) {
    return InvalidArgument(points, fmt::format("{} are {:.3g} m long, less than one segment of "
                                               "{:.3g} m",
                                               points, length, segment_length));
  }
  const Error too_long = InvalidArgument(
      points,
      fmt::format("{} make more than {} segments of {:.3g} m along the outline; shorten the "
                  "prototype",
                  points, kMostDetails - 1, segment_length));
  if (length > kMostWinding * kMostDetails * segment_length) return too_long;
  const Decomposition decomposition = Decompose(prototype.points, segment_length);
  if (decomposition.points() > kMostDetails) return too_long;
  const double period = decomposition.structure;
  if (period > 0 && period < kLeastControlPoints * segment_length) {
    return TooCoarse(points, period, segment_length);
  }
  return PatternOf(decomposition, segment_length);
}

}  // namespace mane::styling
