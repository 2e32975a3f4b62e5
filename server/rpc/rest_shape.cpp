#include "rpc/rest_shape.h"

#include <algorithm>
#include <span>
#include <string>
#include <vector>

#include "groom/rest.h"
#include "rpc/convert_animation.h"
#include "rpc/limits.h"
#include "wire/reconstruct.h"

namespace mane::rpc {
namespace {

using Eigen::Vector3d;

const Vector3d kStandardGravity(0, -9.81, 0);
constexpr double kSameGravity = 1e-9;  // m/s^2
constexpr int kDefaultPoints = 16;
constexpr double kMaxGravity = 1000;
constexpr size_t kMaxAnswer = 64 << 20;

std::string Bytes(const auto& numbers) {
  return {reinterpret_cast<const char*>(numbers.data()), numbers.size() * sizeof(numbers[0])};
}

// Points of a guide at equal arc length, head frame [m].
void SamplePoints(const groom::Guide& guide, std::span<const double> coordinates,
                  std::span<Vector3d> points) {
  const auto elements = [&]<typename Vector>(Vector*) {
    std::vector<Vector> values(guide.strand.elements());
    for (size_t Q = 0; Q < values.size(); ++Q) {
      values[Q] = Eigen::Map<const Vector>(&coordinates[Q * Vector::SizeAtCompileTime]);
    }
    return values;
  };
  if (!guide.wound) {
    const auto theta = elements(static_cast<Vector3d*>(nullptr));
    wire::SamplePoints(guide.root, guide.strand.length, theta, points);
    return;
  }
  const auto x = elements(static_cast<rod::Vector4d*>(nullptr));
  wire::SampleWoundPoints(guide.root, guide.strand.length, guide.strand.natural, x, points);
}

}  // namespace

Result<void> ComputeRest(const groom::Groom& groom, const v1::ComputeRestShapeRequest& request,
                         exec::WorkerPool& pool, v1::ComputeRestShapeResponse* response) {
  Vector3d gravity = kStandardGravity;
  if (request.has_gravity()) {
    const auto given = ToVector(request.gravity(), "gravity", kMaxGravity);
    if (!given) return given.error();
    gravity = *given;
  }
  if (request.has_head_orientation()) {
    const auto head = ToQuaternion(request.head_orientation(), "head_orientation");
    if (!head) return head.error();
    gravity = head->conjugate() * gravity;  // The solver works in the head frame.
  }
  // Of several equilibria the one in which heads start: that of an import is its strands' shape.
  const bool standard = (gravity - kStandardGravity).norm() <= kSameGravity;
  int points = kDefaultPoints;
  if (request.points_per_guide() != 0) {
    const auto ok = CheckRange("points_per_guide", request.points_per_guide(), 2, 256);
    if (!ok) return ok;
    points = static_cast<int>(request.points_per_guide());
  }

  const size_t total = static_cast<size_t>(groom.guide_count()) * points;
  if (total * sizeof(Vector3d) > kMaxAnswer) {
    return Error{ErrorCode::kResourceExhausted,
                 fmt::format("{} guides of points_per_guide {} need {} bytes; at most {} are "
                             "allowed",
                             groom.guide_count(), points, total * sizeof(Vector3d), kMaxAnswer),
                 "points_per_guide"};
  }
  std::vector<Vector3d> positions(total);
  std::vector<double> curvatures(groom.coordinate_count());
  std::vector<double> residuals(groom.guide_count());
  pool.ParallelFor(groom.guide_count(), 1, [&](int guide, int) {
    const groom::Guide& description = groom.guides[guide];
    const auto rest = std::span(curvatures)
                          .subspan(groom.first_coordinate[guide], description.coordinate_count());
    // In standard gravity from where heads start: an import rests in its strands' shape.
    const std::vector<double> natural = groom::NaturalShape(description);
    std::ranges::copy(standard ? groom.rest_of(guide) : natural, rest.begin());
    residuals[guide] = groom::SolveRest(description, gravity, rest).residual;
    SamplePoints(description, rest, std::span(positions).subspan(size_t(guide) * points, points));
    const std::vector<double>& length = description.strand.length;
    const size_t per_element = rest.size() / length.size();
    for (size_t i = 0; i < rest.size(); ++i) rest[i] /= length[i / per_element];
  });
  response->set_points_per_guide(static_cast<uint32_t>(points));
  response->set_positions(Bytes(positions));
  response->set_curvatures(Bytes(curvatures));
  response->set_residuals(Bytes(residuals));
  return {};
}

}  // namespace mane::rpc
