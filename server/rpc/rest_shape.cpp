#include "rpc/rest_shape.h"

#include <span>
#include <string>
#include <vector>

#include "rod/statics.h"
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
  std::vector<Vector3d> curvatures(groom.element_count());
  std::vector<double> residuals(groom.guide_count());
  pool.ParallelFor(groom.guide_count(), 1, [&](int guide, int) {
    const groom::Guide& description = groom.guides[guide];
    const rod::Strand& strand = description.strand;
    std::vector<Vector3d> theta(strand.elements());
    for (int Q = 0; Q < strand.elements(); ++Q) {
      theta[Q] = standard ? groom.rest_theta[groom.first_element[guide] + Q]
                          : strand.length[Q] * strand.natural[Q];
    }
    residuals[guide] = rod::SolveRestShape(strand, description.root, gravity, theta).residual;
    wire::SamplePoints(description.root, strand.length, theta,
                       std::span(positions).subspan(size_t(guide) * points, points));
    for (int Q = 0; Q < strand.elements(); ++Q) {
      curvatures[groom.first_element[guide] + Q] = theta[Q] / strand.length[Q];
    }
  });
  response->set_points_per_guide(static_cast<uint32_t>(points));
  response->set_positions(Bytes(positions));
  response->set_curvatures(Bytes(curvatures));
  response->set_residuals(Bytes(residuals));
  return {};
}

}  // namespace mane::rpc
