#include "groom/rest.h"

#include <algorithm>
#include <vector>

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

std::vector<Vector3d> NaturalAngles(const rod::Strand& strand) {
  std::vector<Vector3d> theta(strand.natural);
  for (size_t Q = 0; Q < theta.size(); ++Q) theta[Q] *= strand.length[Q];
  return theta;
}

}  // namespace

void SetNatural(const Guide& guide, std::span<double> coordinates) {
  MANE_CHECK(static_cast<int>(coordinates.size()) == guide.coordinate_count());
  if (guide.wound) {
    Flatten(guide.wound->natural, coordinates);
  } else {
    Flatten(NaturalAngles(guide.strand), coordinates);
  }
}

rod::StaticsReport SolveRest(const Guide& guide, const Vector3d& gravity,
                             std::span<double> coordinates) {
  MANE_CHECK(static_cast<int>(coordinates.size()) == guide.coordinate_count());
  rod::StaticsReport report;
  if (guide.wound) {
    std::vector<rod::Vector4d> x = guide.wound->natural;
    report = rod::SolveRestShape(*guide.wound, guide.root, gravity, x);
    Flatten(x, coordinates);
  } else {
    std::vector<Vector3d> theta = NaturalAngles(guide.strand);
    report = rod::SolveRestShape(guide.strand, guide.root, gravity, theta);
    Flatten(theta, coordinates);
  }
  return report;
}

}  // namespace mane::groom
