#include "rod/test_wound_oracle.h"

#include <Eigen/Dense>

#include <algorithm>
#include <cmath>

namespace mane::rod::oracle {
namespace {

constexpr Real kStep = 1e-4L;  // Of the fourth order differences [rad].

// Fourth order difference of `f` at 0.
template <class F>
auto Difference(const F& f) {
  return ((8 * (f(kStep) - f(-kStep)) - (f(2 * kStep) - f(-2 * kStep))) / (12 * kStep)).eval();
}

}  // namespace

Vector Stack(const std::vector<Vector4d>& vectors) {
  Vector x(4 * vectors.size());
  for (size_t i = 0; i < vectors.size(); ++i) x.segment<4>(4 * i) = vectors[i].cast<Real>();
  return x;
}

WoundRod::WoundRod(const Strand& strand) : strand_(strand) {
  for (const Eigen::Vector3d& kappa : strand.natural) {
    const Vector3 natural = kappa.cast<Real>();
    Helix helix;
    helix.winding = natural.norm();
    helix.rise = natural[0] / helix.winding;
    helix.slant = std::sqrt(1 - helix.rise * helix.rise);
    helix.F.col(0) = natural / helix.winding;
    helix.F.col(2) = helix.F.col(0).cross(Vector3::UnitX()).normalized();
    helix.F.col(1) = helix.F.col(2).cross(helix.F.col(0));
    helix_.push_back(helix);
  }
  // Axis frames that do not wind, along the natural shape of the hair itself; between two of them
  // the joint's frame is half way.
  const auto unwound = [](Real phase) {
    return Eigen::AngleAxis<Real>(-phase, Vector3::UnitX()).toRotationMatrix();
  };
  std::vector<Matrix3> joints;
  Frame hair{Matrix3::Identity(), Vector3::Zero()};
  Real phase = 0;
  Matrix3 last = helix_[0].F;
  for (int Q = 0; Q < elements(); ++Q) {
    const Matrix3 A = hair.n * helix_[Q].F * unwound(phase);
    const Eigen::AngleAxis<Real> kink(A * last.transpose());
    joints.push_back(Eigen::AngleAxis<Real>(kink.angle() / 2, kink.axis()) * last);
    hair = Advance(hair, strand.natural[Q].cast<Real>(), strand.length[Q]);
    phase += helix_[Q].winding * strand.length[Q];
    last = A;
  }
  joints.push_back(last);
  natural_ = Vector::Zero(4 * elements());
  for (int Q = 0; Q < elements(); ++Q) {
    const Eigen::AngleAxis<Real> turn(Matrix3(joints[Q].transpose() * joints[Q + 1]));
    natural_.segment<3>(4 * Q) = turn.angle() * turn.axis();
  }
}

Frame WoundRod::AxisRoot(const Frame& clamp) const {
  // The axis of a helix passes at its radius along the principal normal, axis x tangent the other
  // way round: the hair starts at -radius (axis x w).
  const Vector3 tangent = clamp.n.col(0), axis = clamp.n * helix_[0].F.col(0);
  const Vector3 towards = axis.cross(tangent).normalized();
  return {clamp.n * helix_[0].F, clamp.r + helix_[0].slant / helix_[0].winding * towards};
}

Frame WoundRod::Along(const Frame& left, const Vector& x, int Q, Real u) const {
  const Helix& helix = helix_[Q];
  const Real l = strand_.length[Q], W = helix.winding * l;
  // The hair's strain in the (axis, w) plane; its turn and its rise.
  const Real along = W + x[4 * Q], across = x[4 * Q + 3];
  const Real turn = std::sqrt(along * along + across * across);
  const Real stretch = (helix.rise * along + helix.slant * across) / turn;
  const Vector3 kappa = Vector3(turn - W, x[4 * Q + 1], x[4 * Q + 2]) / l;
  Frame frame = Advance(left, kappa, u * l);
  frame.r = left.r + stretch * (frame.r - left.r);
  return frame;
}

Matrix3X WoundRod::Beads(const Frame& clamp, const Vector& x) const {
  const Rule& rule = GaussRule(kBeads);
  Matrix3X beads(3, elements() * kBeads);
  Frame left = AxisRoot(clamp);
  for (int Q = 0; Q < elements(); ++Q) {
    const Real radius = helix_[Q].slant / helix_[Q].winding;
    for (int g = 0; g < kBeads; ++g) {
      const Frame at = Along(left, x, Q, rule.nodes[g]);
      const Real arm = radius / (2 * std::sqrt(rule.weights[g])) * (g < 2 ? 1 : -1);
      beads.col(Q * kBeads + g) = at.r + arm * at.n.col(g == 0 || g == 3 ? 1 : 2);
    }
    left = Along(left, x, Q, 1);
  }
  return beads;
}

std::vector<Matrix3X> WoundRod::Jacobians(const Frame& clamp, const Vector& x) const {
  std::vector<Matrix3X> J(elements() * kBeads, Matrix3X(3, x.size()));
  for (int i = 0; i < x.size(); ++i) {
    const Matrix3X d = Difference(
        [&](Real by) -> Matrix3X { return Beads(clamp, x + by * Vector::Unit(x.size(), i)); });
    for (size_t k = 0; k < J.size(); ++k) J[k].col(i) = d.col(k);
  }
  return J;
}

Vector WoundRod::Masses() const {
  Vector masses(elements() * kBeads);
  for (int i = 0; i < masses.size(); ++i) {
    masses[i] =
        strand_.linear_density * strand_.length[i / kBeads] * GaussRule(kBeads).weights[i % kBeads];
  }
  return masses;
}

Matrix WoundRod::Stiffness() const {
  // A force along the axis and a moment about it load the hair with moments along axis and w; the
  // hair's strains are conjugate to them. Across the axis, the mean compliance.
  Matrix K = Matrix::Zero(4 * elements(), 4 * elements());
  for (int Q = 0; Q < elements(); ++Q) {
    const Matrix3& F = helix_[Q].F;
    Matrix3 compliance = Matrix3::Zero();
    for (int i = 0; i < 3; ++i) {
      compliance += F.row(i).transpose() * F.row(i) / strand_.stiffness[i];
    }
    const Real det = compliance(0, 0) * compliance(1, 1) - compliance(0, 1) * compliance(1, 0);
    const Real l = strand_.length[Q];
    K(4 * Q, 4 * Q) = compliance(1, 1) / det / l;
    K(4 * Q + 3, 4 * Q + 3) = compliance(0, 0) / det / l;
    K(4 * Q, 4 * Q + 3) = K(4 * Q + 3, 4 * Q) = -compliance(0, 1) / det / l;
    K(4 * Q + 1, 4 * Q + 1) = K(4 * Q + 2, 4 * Q + 2) =
        2 / (compliance(1, 1) + compliance(2, 2)) / l;
  }
  return K;
}

Matrix WoundRod::Friction(Real scale, Real dt) const {
  Matrix D = kLeastFriction * kTheta * dt * Stiffness();
  for (int i = 0; i < D.rows(); ++i) {
    D(i, i) = std::max(D(i, i), scale * strand_.internal_friction / strand_.length[i / 4]);
  }
  return D;
}

Real WoundRod::Gravity(const Frame& clamp, const Vector3& g, const Vector& x) const {
  const Rule& rule = GaussRule(48);
  Real V = 0;
  Frame left = AxisRoot(clamp);
  for (int Q = 0; Q < elements(); ++Q) {
    const Real mass = strand_.linear_density * strand_.length[Q];
    for (size_t k = 0; k < rule.nodes.size(); ++k) {
      V -= mass * rule.weights[k] * g.dot(Along(left, x, Q, rule.nodes[k]).r - clamp.r);
    }
    left = Along(left, x, Q, 1);
  }
  return V;
}

Vector WoundRod::GravityGradient(const Frame& clamp, const Vector3& g, const Vector& x) const {
  Vector gradient(x.size());
  for (int i = 0; i < x.size(); ++i) {
    gradient[i] = Difference([&](Real by) {
      return Eigen::Matrix<Real, 1, 1>(Gravity(clamp, g, x + by * Vector::Unit(x.size(), i)));
    })[0];
  }
  return gradient;
}

Matrix WoundRod::Turning(const Frame& clamp, const Vector3& w, const Vector& x) const {
  const int N = elements();
  const Rule& rule = GaussRule(24);
  // Axis frames at joints when `x` moves.
  const auto joints = [&](const Vector& at) {
    std::vector<Frame> frames = {AxisRoot(clamp)};
    for (int Q = 0; Q < N; ++Q) frames.push_back(Along(frames[Q], at, Q, 1));
    return frames;
  };
  const std::vector<Frame> frames = joints(x);
  // Arms: an element carries itself and all beyond it.
  std::vector<Vector3> arm(N + 1, Vector3::Zero());
  Real beyond = 0;
  for (int Q = N - 1; Q >= 0; --Q) {
    const Real mass = strand_.linear_density * strand_.length[Q];
    for (size_t k = 0; k < rule.nodes.size(); ++k) {
      arm[Q] += mass * rule.weights[k] * (Along(frames[Q], x, Q, rule.nodes[k]).r - frames[Q].r);
    }
    arm[Q] += beyond * (frames[Q + 1].r - frames[Q].r);
    beyond += mass;
  }
  // Rotations of the right ends per rate.
  std::vector<Matrix3X> turns(N, Matrix3X(3, x.size()));
  for (int i = 0; i < x.size(); ++i) {
    const Matrix3X d = Difference([&](Real by) {
      const std::vector<Frame> moved = joints(x + by * Vector::Unit(x.size(), i));
      Matrix3X away(3, N);
      for (int Q = 0; Q < N; ++Q) {
        const Matrix3 R = moved[Q + 1].n * frames[Q + 1].n.transpose();
        away.col(Q) << R(2, 1) - R(1, 2), R(0, 2) - R(2, 0), R(1, 0) - R(0, 1);
      }
      return Matrix3X(away / 2);
    });
    for (int Q = 0; Q < N; ++Q) turns[Q].col(i) = d.col(Q);
  }
  Matrix form = Matrix::Zero(x.size(), x.size());
  for (int Q = 0; Q < N; ++Q) {
    const Vector3 D = (arm[Q] + arm[Q + 1]) / 2;
    const Matrix3 product = (w * D.transpose() + D * w.transpose()) / 2;
    const Eigen::SelfAdjointEigenSolver<Matrix3> solver(w.dot(D) * Matrix3::Identity() - product);
    const Matrix3 convex = solver.eigenvectors() *
                           solver.eigenvalues().cwiseMax(Real(0)).asDiagonal() *
                           solver.eigenvectors().transpose();
    form += turns[Q].transpose() * convex * turns[Q];
  }
  return form;
}

void DenseStep(const Strand& strand, const ClampMotion& clamp, const Surroundings& air,
               WoundState state) {
  const WoundRod rod(strand);
  const Real dt = clamp.dt, h = kTheta * dt;
  const Real c = Real(air.air_drag_scale) * strand.air_drag / strand.linear_density;
  const Eigen::Quaternion<Real> begin = clamp.begin.q.cast<Real>().normalized(),
                                end = clamp.end.q.cast<Real>().normalized();
  const Vector3 p0 = clamp.begin.p.cast<Real>(), p1 = clamp.end.p.cast<Real>();
  const Eigen::AngleAxis<Real> turn(end * begin.conjugate());
  const Vector3 velocity = (p1 - p0) / dt, spin = turn.axis() * (turn.angle() / dt);
  const Frame root{begin.slerp(Real(kTheta), end).toRotationMatrix(), p0 + kTheta * (p1 - p0)};

  const int N = rod.elements();
  Vector x(4 * N), rate(4 * N);
  for (int Q = 0; Q < N; ++Q) {
    x.segment<4>(4 * Q) = state.x[Q].cast<Real>();
    rate.segment<4>(4 * Q) = state.rate[Q].cast<Real>();
  }
  const Vector ahead = x + h * rate;
  const Matrix3X r = rod.Beads(root, ahead);
  const std::vector<Matrix3X> J = rod.Jacobians(root, ahead);
  const Vector masses = rod.Masses();

  const Matrix stiff = h * h * rod.Stiffness();
  Matrix H = stiff + h * rod.Friction(air.internal_friction_scale, dt);
  const Vector3 body = (air.gravity + static_cast<double>(c) * air.wind).cast<Real>();
  Vector b =
      -h * rod.Stiffness() * (x - rod.Natural()) - h * rod.GravityGradient(root, body, ahead);
  std::vector<Vector3> base(J.size());
  for (size_t k = 0; k < J.size(); ++k) {
    base[k] = velocity + spin.cross(r.col(k) - root.r);
    H += (1 + h * c) * masses[k] * J[k].transpose() * J[k];
    b += masses[k] * J[k].transpose() * (state.velocity[k].cast<Real>() - (1 + h * c) * base[k]);
  }
  const Vector3 passing = velocity + spin.cross(rod.AxisRoot(root).r - root.r);
  const Matrix turning = h * h * rod.Turning(root, body - c * passing, ahead);
  H += turning;
  b += turning * rate;
  const Vector v = H.ldlt().solve(b);
  for (size_t k = 0; k < J.size(); ++k) {
    const Vector3 u = state.velocity[k].cast<Real>(), ahead_u = base[k] + J[k] * v;
    state.velocity[k] = (u + (ahead_u - u) / kTheta).cast<double>();
  }
  for (int Q = 0; Q < N; ++Q) {
    state.rate[Q] = v.segment<4>(4 * Q).cast<double>();
    state.x[Q] += clamp.dt * state.rate[Q];
  }
}

}  // namespace mane::rod::oracle
