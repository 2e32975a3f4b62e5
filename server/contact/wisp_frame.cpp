#include <algorithm>
#include <cmath>

#include "contact/wisp_links.h"

namespace mane::contact {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using Eigen::Vector3f;

constexpr size_t kSamples = 300;     // Points that tell how the hair moves.
constexpr float kFarthest = 100;     // Those that do are no farther from the origin [m]
constexpr float kFastest = 100;      // and no faster [m/s].
constexpr double kFastestTurn = 50;  // [rad/s]
constexpr double kRigid = 1e-3;      // Part of the inertia that turns with nothing.

// Calls visit(mass, position, velocity) for some points at the start of the step.
template <typename Visit>
void ForSamples(const WispPoints& points, const WispStep& step, const Visit& visit) {
  // An odd stride, so that of guides with as many points not always the same are taken.
  const size_t stride = points.mass.size() / kSamples | 1;
  for (size_t p = 0; p < points.mass.size(); p += stride) {
    const Vector3f u = points.velocity[p], x = points.Position(p) - step.h * u;
    const float m = points.mass[p];
    if (!Within(x, kFarthest) || !Within(u, kFastest) || !(m >= 1e-12f && m <= 1e6f)) continue;
    visit(static_cast<double>(m), Vector3d(x.cast<double>()), Vector3d(u.cast<double>()));
  }
}

}  // namespace

WispFrame WispFrame::Fit(const WispPoints& points, const WispStep& step, Eigen::Quaternionf* turn) {
  double mass = 0;
  Vector3d moment = Vector3d::Zero(), momentum = Vector3d::Zero();
  Matrix3d second = Matrix3d::Zero(), motion = Matrix3d::Zero();  // Of x x^T, and x u^T.
  ForSamples(points, step, [&](double m, const Vector3d& x, const Vector3d& u) {
    mass += m;
    moment += m * x;
    momentum += m * u;
    second += m * x * x.transpose();
    motion += m * x * u.transpose();
  });
  WispFrame frame{turn->conjugate().toRotationMatrix(), Vector3f::Zero(), Vector3f::Zero(),
                  Vector3f::Zero()};
  if (!(mass > 0)) return frame;
  const Vector3d x = moment / mass, u = momentum / mass;
  second -= mass * x * x.transpose();
  motion -= mass * x * u.transpose();
  const Matrix3d inertia = (1 + kRigid) * second.trace() * Matrix3d::Identity() - second;
  const Vector3d angular(motion(1, 2) - motion(2, 1), motion(2, 0) - motion(0, 2),
                         motion(0, 1) - motion(1, 0));
  Vector3d spin = Vector3d::Zero();
  if (second.trace() > 1e-6 * mass) spin = inertia.inverse() * angular;
  if (!(spin.norm() <= kFastestTurn)) spin.setZero();
  frame.position = x.cast<float>();
  frame.velocity = u.cast<float>();
  frame.spin = spin.cast<float>();
  const Vector3d by = step.dt * spin;
  if (by.norm() > 0) {
    const Eigen::AngleAxisd change(by.norm(), by.normalized());
    *turn = (Eigen::Quaterniond(change) * turn->cast<double>()).normalized().cast<float>();
  }
  return frame;
}

}  // namespace mane::contact
