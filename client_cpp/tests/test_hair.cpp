#include "test_hair.h"

#include <cmath>
#include <numbers>
#include <stdexcept>

namespace mane::client_test {
namespace {

// v turned by q: v + 2 u x (u x v + w v), u the vector part.
Vector3 Turn(const Quaternion& q, const Vector3& v) {
  const auto cross = [&](const Vector3& b) {
    return Vector3{q.y * b.z - q.z * b.y, q.z * b.x - q.x * b.z, q.x * b.y - q.y * b.x};
  };
  const Vector3 inner = cross(v);
  const Vector3 outer = cross({inner.x + q.w * v.x, inner.y + q.w * v.y, inner.z + q.w * v.z});
  return {v.x + 2 * outer.x, v.y + 2 * outer.y, v.z + 2 * outer.z};
}

}  // namespace

Guide WavyGuide() {
  Guide guide;
  guide.root_position = {0.08, 0.1, 0};
  guide.length_m = 0.2;
  guide.element_count = 5;
  guide.radius_1_m = 50e-6;
  guide.radius_2_m = 40e-6;
  guide.young_modulus_pa = 1e9;
  guide.poisson_ratio = 0.48;
  guide.density_kg_m3 = 1300;
  guide.internal_friction = 1e-10;
  guide.air_drag = 1e-5;
  guide.natural_twist = {20};
  guide.natural_curvature_1 = {60};
  return guide;
}

GroomUpload WavyGroom(int count) {
  std::vector<Guide> guides;
  for (int i = 0; i < count; ++i) {
    const double angle = 2 * std::numbers::pi * i / count;  // About +Y.
    Guide guide = WavyGuide();
    guide.root_position = {0.09 * std::cos(angle), 0.1, -0.09 * std::sin(angle)};
    guide.root_frame = {0, std::sin(angle / 2), 0, std::cos(angle / 2)};
    guide.length_m = 0.1 + 0.01 * (i % 10);
    guide.element_count = 3 + static_cast<std::uint32_t>(i % 4);
    guides.push_back(guide);
  }
  GroomUpload upload;
  upload.display_name = "test";
  upload.guides = std::move(guides);
  return upload;
}

Pose MotionAt(double time_s) {
  const double turn = 0.8 * std::sin(2 * time_s), nod = 0.5 * std::sin(5 * time_s);
  const double cy = std::cos(turn / 2), sy = std::sin(turn / 2);
  const double cx = std::cos(nod / 2), sx = std::sin(nod / 2);
  Pose pose;
  pose.position = {0.1 * std::sin(3 * time_s), 1.6, 0.2 * std::sin(time_s)};
  pose.orientation = {cy * sx, sy * cx, -sy * sx, cy * cx};  // Turn about Y after nod about X.
  return pose;
}

std::string Create(Client& client, const GroomUpload& upload) {
  auto groom = client.CreateGroom(upload);
  if (!groom) throw std::runtime_error(groom.error().field + ": " + groom.error().message);
  return groom->name;
}

std::string Fault(const Frame& frame, const GroomUpload& upload, double slack) {
  const auto& guides = std::get<std::vector<Guide>>(upload.guides);
  if (frame.guide_count != guides.size()) return "wrong number of guides";
  if (frame.positions.size() != std::size_t{3} * frame.guide_count * frame.points_per_guide) {
    return "wrong number of positions";
  }
  for (const float x : frame.positions) {
    if (!std::isfinite(x)) return "not finite";
  }
  for (std::uint32_t g = 0; g < frame.guide_count; ++g) {
    const std::string guide = "guide " + std::to_string(g);
    const Vector3 root = Apply(frame.head_pose, guides[g].root_position);
    if (Distance(PointOf(frame, g, 0), root) > slack) return guide + " has left its root";
    const double spacing = guides[g].length_m / (frame.points_per_guide - 1);
    for (std::uint32_t i = 1; i < frame.points_per_guide; ++i) {
      if (Distance(PointOf(frame, g, i), PointOf(frame, g, i - 1)) > spacing + slack) {
        return guide + " is longer than it is";
      }
    }
  }
  if (frame.repaired_guides) return "guides were repaired";
  return "";
}

Vector3 Apply(const Pose& pose, const Vector3& local) {
  const Vector3 turned = Turn(pose.orientation, local);
  const Vector3& p = pose.position;
  return {turned.x + p.x, turned.y + p.y, turned.z + p.z};
}

Vector3 ApplyInverse(const Pose& pose, const Vector3& outer) {
  const Quaternion& q = pose.orientation;
  const Vector3& p = pose.position;
  return Turn({-q.x, -q.y, -q.z, q.w}, {outer.x - p.x, outer.y - p.y, outer.z - p.z});
}

Vector3 PointOf(const Frame& frame, std::uint32_t guide, std::uint32_t point) {
  const float* x = &frame.positions[std::size_t{3} * (guide * frame.points_per_guide + point)];
  return {x[0], x[1], x[2]};
}

double Distance(const Vector3& a, const Vector3& b) {
  return std::hypot(a.x - b.x, a.y - b.y, a.z - b.z);
}

}  // namespace mane::client_test
