#include "contact/shape.h"

#include <fmt/format.h>

#include <string>

#include "base/check.h"

namespace mane::contact {
namespace {

constexpr double kLeastRadius = 1e-4;   // [m]
constexpr double kLargestRadius = 100;  // [m]
constexpr double kLargestRatio = 100;   // Of an ellipsoid's radii: float32 stays accurate.
constexpr double kFarthest = 1000;      // [m]

Result<void> CheckRadius(const std::string& field, double radius) {
  if (radius >= kLeastRadius && radius <= kLargestRadius) return {};
  return InvalidArgument(field, fmt::format("{} is {} m; it must lie in [{}, {}] m", field, radius,
                                            kLeastRadius, kLargestRadius));
}

Result<void> CheckEnd(const std::string& field, const Eigen::Vector3d& end) {
  if ((end.array().abs() <= kFarthest).all()) return {};  // False for NaN.
  return InvalidArgument(field, fmt::format("{} is ({}, {}, {}); coordinates must lie within ±{} m",
                                            field, end.x(), end.y(), end.z(), kFarthest));
}

Result<void> Check(const Ellipsoid& ellipsoid) {
  const Eigen::Vector3d& radii = ellipsoid.radii();
  for (int i = 0; i < 3; ++i) {
    const std::string field = fmt::format("radii.{}", "xyz"[i]);
    if (auto radius = CheckRadius(field, radii[i]); !radius) return radius;
  }
  const double ratio = radii.maxCoeff() / radii.minCoeff();
  if (ratio <= kLargestRatio) return {};
  return InvalidArgument("radii",
                         fmt::format("radii ({}, {}, {}) m have a ratio of {}; it must be "
                                     "at most {}",
                                     radii.x(), radii.y(), radii.z(), ratio, kLargestRatio));
}

Result<void> Check(const Capsule& capsule) {
  if (auto a = CheckEnd("a", capsule.a()); !a) return a;
  if (auto b = CheckEnd("b", capsule.b()); !b) return b;
  return CheckRadius("radius", capsule.radius());
}

Result<void> Check(const std::shared_ptr<const MeshField>& mesh) {
  MANE_CHECK(mesh != nullptr);
  return {};
}

// A shape, whether held directly or by a pointer.
template <typename Shape>
const Shape& Held(const Shape& shape) {
  return shape;
}
const MeshField& Held(const std::shared_ptr<const MeshField>& mesh) { return *mesh; }

}  // namespace

Result<void> Validate(const BodyShape& shape) {
  return std::visit([](const auto& held) { return Check(held); }, shape);
}

Distance At(const BodyShape& shape, const Eigen::Vector3d& point) {
  return std::visit([&](const auto& held) { return Held(held).At(point); }, shape);
}

void At(const BodyShape& shape, const PointSpans& points, const DistanceSpans& out) {
  std::visit([&](const auto& held) { Held(held).At(points, out); }, shape);
}

}  // namespace mane::contact
