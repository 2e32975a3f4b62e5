#include "styling/solver_fixture.h"

#include <cmath>
#include <numbers>

#include "base/check.h"

namespace mane::styling::fixtures {

using Eigen::Vector3d;
using Eigen::Vector3f;

namespace {
const Vector3d kRadii(0.075, 0.11, 0.095);  // [m]
}  // namespace

Obstacles Head() { return {{contact::Ellipsoid(kRadii), {}}}; }

void AddWisp(Hair* hair, const Vector3d& root, const Vector3d& direction, int segments,
             float strands) {
  SolverInput& input = hair->input;
  Masters& masters = hair->masters;
  if (masters.first_joint.empty()) masters.first_joint.push_back(0);
  const auto joints = static_cast<size_t>(segments) + 1;
  input.roots.push_back({root, direction, -1});
  input.first_directions.push_back(direction);
  input.strands.resize(input.strands.size() + joints, strands);
  input.radii.resize(input.radii.size() + joints, 0.006f);
  masters.first_joint.push_back(masters.first_joint.back() + static_cast<uint32_t>(joints));
  masters.length.push_back(static_cast<float>(segments * masters.segment_length));
  masters.details.resize(masters.details.size() + joints, Vector3f::Zero());
}

Hair HairOn(const Obstacles& head, int wisps, int segments, double segment_length, float strands) {
  Hair hair;
  hair.masters.segment_length = segment_length;
  hair.input.obstacles = head;
  hair.input.field = {{}};
  for (int i = 0; i < wisps; ++i) {
    const double y = 1 - (i + 0.5) / wisps;  // Even over the upper half of the unit sphere.
    const double angle = std::numbers::pi * (3 - std::sqrt(5.0)) * i;
    const double ring = std::sqrt(1 - y * y);
    const Vector3d root =
        Vector3d(ring * std::cos(angle), y, ring * std::sin(angle)).cwiseProduct(kRadii);
    AddWisp(&hair, root, root.cwiseQuotient(kRadii).cwiseQuotient(kRadii).normalized(), segments,
            strands);
  }
  return hair;
}

Hair WispAt(const Vector3d& root, const Vector3d& direction, int segments, double segment_length) {
  Hair hair;
  hair.masters.segment_length = segment_length;
  hair.input.field = {{}};
  AddWisp(&hair, root, direction, segments, 10);
  return hair;
}

Deformed Solve(Hair* hair, int workers) {
  exec::WorkerPool pool(workers);
  auto solved = Deform(hair->input, &hair->masters, {}, {}, &pool);
  MANE_CHECK(solved.has_value());
  return *std::move(solved);
}

}  // namespace mane::styling::fixtures
