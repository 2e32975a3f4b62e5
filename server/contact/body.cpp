#include "contact/body.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <limits>

namespace mane::contact {
namespace {

using Eigen::Vector3d;

constexpr size_t kBlock = 128;  // Points at a time, so that what is between lies on the stack.

// A body at one moment, in float32.
struct Snapshot {
  Snapshot(const Body& body, double fraction) {
    const math::Pose pose = body.motion.PoseAt(fraction);
    const Vector3d linear = body.motion.LinearVelocity(), turn = body.motion.AngularVelocity();
    const Eigen::Matrix3d rotation = pose.q.toRotationMatrix();
    for (int i = 0; i < 3; ++i) {
      p[i] = static_cast<float>(pose.p[i]);
      v[i] = static_cast<float>(linear[i]);
      w[i] = static_cast<float>(turn[i]);
      for (int j = 0; j < 3; ++j) R[i][j] = static_cast<float>(rotation(i, j));
    }
  }
  float R[3][3], p[3], v[3], w[3];
};

// Points of a block in a bone's frame, and their distances there.
struct Block {
  std::array<float, kBlock> x, y, z, distance, nx, ny, nz;

  [[nodiscard]] PointSpans Points(size_t n) const {
    return {{x.data(), n}, {y.data(), n}, {z.data(), n}};
  }
  [[nodiscard]] DistanceSpans Distances(size_t n) {
    return {{distance.data(), n}, {nx.data(), n}, {ny.data(), n}, {nz.data(), n}};
  }
};

void ToBone(const Snapshot& at, const PointSpans& points, Block* block) {
  for (size_t i = 0; i < points.size(); ++i) {
    const float d[3] = {points.x[i] - at.p[0], points.y[i] - at.p[1], points.z[i] - at.p[2]};
    block->x[i] = at.R[0][0] * d[0] + at.R[1][0] * d[1] + at.R[2][0] * d[2];
    block->y[i] = at.R[0][1] * d[0] + at.R[1][1] * d[1] + at.R[2][1] * d[2];
    block->z[i] = at.R[0][2] * d[0] + at.R[1][2] * d[1] + at.R[2][2] * d[2];
  }
}

// Takes over what is deeper or nearer than what earlier bodies left.
void Merge(const Snapshot& at, int32_t body, const PointSpans& points, const Block& block,
           size_t first, const BodyDistanceSpans& out) {
  for (size_t i = 0; i < points.size(); ++i) {
    const size_t o = first + i;
    if (!(block.distance[i] < out.distance.distance[o])) continue;
    const float n[3] = {block.nx[i], block.ny[i], block.nz[i]};
    const float d[3] = {points.x[i] - at.p[0], points.y[i] - at.p[1], points.z[i] - at.p[2]};
    out.distance.distance[o] = block.distance[i];
    out.distance.nx[o] = at.R[0][0] * n[0] + at.R[0][1] * n[1] + at.R[0][2] * n[2];
    out.distance.ny[o] = at.R[1][0] * n[0] + at.R[1][1] * n[1] + at.R[1][2] * n[2];
    out.distance.nz[o] = at.R[2][0] * n[0] + at.R[2][1] * n[1] + at.R[2][2] * n[2];
    out.vx[o] = at.v[0] + at.w[1] * d[2] - at.w[2] * d[1];
    out.vy[o] = at.v[1] + at.w[2] * d[0] - at.w[0] * d[2];
    out.vz[o] = at.v[2] + at.w[0] * d[1] - at.w[1] * d[0];
    out.body[o] = body;
  }
}

void Fill(std::span<float> list, float value) { std::fill(list.begin(), list.end(), value); }

}  // namespace

Vector3d BodyMotion::LinearVelocity() const {
  if (!(duration > 0)) return Vector3d::Zero();
  return (end.p - begin.p) / duration;
}

Vector3d BodyMotion::AngularVelocity() const {
  if (!(duration > 0)) return Vector3d::Zero();
  return begin.q * math::RotationVector(begin.q.conjugate() * end.q) / duration;
}

Vector3d BodyMotion::VelocityAt(const Vector3d& point, double fraction) const {
  return LinearVelocity() + AngularVelocity().cross(point - PoseAt(fraction).p);
}

BodyDistance At(std::span<const Body> bodies, double fraction, const Vector3d& point) {
  BodyDistance out;
  out.distance.distance = std::numeric_limits<double>::infinity();
  for (size_t i = 0; i < bodies.size(); ++i) {
    const math::Pose pose = bodies[i].motion.PoseAt(fraction);
    const Distance local = At(bodies[i].shape, pose.Inverse() * point);
    if (!(local.distance < out.distance.distance)) continue;
    out.distance = {local.distance, pose.q * local.normal};
    out.velocity = bodies[i].motion.VelocityAt(point, fraction);
    out.body = static_cast<int>(i);
  }
  return out;
}

void At(std::span<const Body> bodies, double fraction, const PointSpans& points,
        const BodyDistanceSpans& out) {
  Fill(out.distance.distance, std::numeric_limits<float>::infinity());
  for (const auto& list : {out.distance.nx, out.distance.nz, out.vx, out.vy, out.vz}) Fill(list, 0);
  Fill(out.distance.ny, 1);
  std::fill(out.body.begin(), out.body.end(), -1);
  Block block;
  for (size_t i = 0; i < bodies.size(); ++i) {
    const Snapshot at(bodies[i], fraction);
    for (size_t first = 0; first < points.size(); first += kBlock) {
      const PointSpans part = points.Part(first, std::min(kBlock, points.size() - first));
      ToBone(at, part, &block);
      At(bodies[i].shape, block.Points(part.size()), block.Distances(part.size()));
      Merge(at, static_cast<int32_t>(i), part, block, first, out);
    }
  }
}

}  // namespace mane::contact
