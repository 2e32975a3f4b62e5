#include "groom/rest.h"

#include <algorithm>
#include <cmath>

#include "base/check.h"
#include "rod/wound_statics.h"

namespace mane::groom {
namespace {

using Eigen::Vector3d;

template <typename Vector>
void Flatten(const std::vector<Vector>& elements, std::span<double> coordinates) {
  auto out = coordinates.begin();
  for (const Vector& element : elements) out = std::ranges::copy(element, out).out;
}

template <typename Vector>
std::vector<Vector> Elements(std::span<const double> coordinates) {
  constexpr int kEach = Vector::SizeAtCompileTime;
  std::vector<Vector> elements(coordinates.size() / kEach);
  for (size_t Q = 0; Q < elements.size(); ++Q) {
    elements[Q] = Eigen::Map<const Vector>(&coordinates[kEach * Q]);
  }
  return elements;
}

// SolveRestShape of either kind of strand.
template <typename Vector, typename Strand>
rod::StaticsReport Solve(const Strand& strand, const math::Pose& root, const Vector3d& gravity,
                         std::span<double> coordinates) {
  std::vector<Vector> elements = Elements<Vector>(coordinates);
  const rod::StaticsReport report = rod::SolveRestShape(strand, root, gravity, elements);
  Flatten(elements, coordinates);
  return report;
}

}  // namespace

std::vector<double> NaturalShape(const Guide& guide) {
  std::vector<double> coordinates(guide.coordinate_count());
  if (guide.wound) {
    Flatten(guide.wound->natural, coordinates);
    return coordinates;
  }
  std::vector<Vector3d> theta = guide.strand.natural;
  for (size_t Q = 0; Q < theta.size(); ++Q) theta[Q] *= guide.strand.length[Q];
  Flatten(theta, coordinates);
  return coordinates;
}

rod::StaticsReport SolveRest(const Guide& guide, const Vector3d& gravity,
                             std::span<double> coordinates) {
  MANE_CHECK(static_cast<int>(coordinates.size()) == guide.coordinate_count());
  if (guide.wound) return Solve<rod::Vector4d>(*guide.wound, guide.root, gravity, coordinates);
  return Solve<Vector3d>(guide.strand, guide.root, gravity, coordinates);
}

double Turning(const Guide& guide, std::span<const double> coordinates) {
  MANE_CHECK(static_cast<int>(coordinates.size()) == guide.coordinate_count());
  double turning = 0;
  for (int Q = 0; Q < guide.strand.elements(); ++Q) {
    turning += guide.wound ? guide.strand.length[Q] * guide.strand.natural[Q].tail<2>().norm()
                           : std::hypot(coordinates[3 * Q + 1], coordinates[3 * Q + 2]);
  }
  return turning;
}

}  // namespace mane::groom
