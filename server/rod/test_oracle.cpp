#include "rod/test_oracle.h"

#include <Eigen/Dense>
#include <Eigen/Geometry>

#include <cmath>
#include <map>

namespace mane::rod::oracle {
namespace {

// Step of the differences: the fourth order error is h^4 / 30 = 3e-14 where derivatives are of
// order 1, the rounding 1e-19 / h = 1e-16.
constexpr Real kStep = 1e-3L;

// Forces, drag coefficients and wind in long double.
struct Air {
  Vector3 gravity, wind;
  Real friction, drag_rate;  // Scale of gamma; nu / (rho S) [1/s].

  Air(const Strand& strand, const Surroundings& air)
      : gravity(air.gravity.cast<Real>()),
        wind(air.wind.cast<Real>()),
        friction(air.internal_friction_scale),
        drag_rate(static_cast<Real>(air.air_drag_scale) * strand.air_drag / strand.linear_density) {
  }
};

}  // namespace

Frame ToFrame(const math::Pose& pose) {
  return {pose.q.cast<Real>().normalized().toRotationMatrix(), pose.p.cast<Real>()};
}

Vector Stack(std::span<const Eigen::Vector3d> vectors) {
  Vector stacked(3 * vectors.size());
  for (size_t i = 0; i < vectors.size(); ++i) stacked.segment<3>(3 * i) = vectors[i].cast<Real>();
  return stacked;
}

Frame Advance(const Frame& left, const Vector3& kappa, Real s) {
  const Vector3 darboux = left.n * kappa;
  const Real Omega = darboux.norm();
  if (Omega == 0) return {left.n, left.r + s * left.n.col(0)};
  const Vector3 omega = darboux / Omega;
  const Real angle = Omega * s, half = std::sin(angle / 2);
  const Real cosine = 1 - 2 * half * half, versine = 2 * half * half, sine = std::sin(angle);
  Frame right;
  for (int i = 0; i < 3; ++i) {
    const Vector3 n = left.n.col(i), parallel = n.dot(omega) * omega;
    right.n.col(i) = parallel + (n - parallel) * cosine + omega.cross(n) * sine;
  }
  const Vector3 n0 = left.n.col(0), parallel = n0.dot(omega) * omega;
  right.r = left.r + parallel * s + (n0 - parallel) * (sine / Omega) +
            omega.cross(n0) * (versine / Omega);
  return right;
}

Frame IntegrateRk4(const Frame& left, const Vector3& kappa, Real s, int steps) {
  const Real h = s / steps;
  const auto slope = [&](const Frame& x) {
    const Vector3 Omega = x.n * kappa;
    Frame d;
    for (int i = 0; i < 3; ++i) d.n.col(i) = Omega.cross(x.n.col(i));
    d.r = x.n.col(0);
    return d;
  };
  const auto plus = [](const Frame& x, const Frame& d, Real w) {
    return Frame{x.n + w * d.n, x.r + w * d.r};
  };
  Frame x = left;
  for (int i = 0; i < steps; ++i) {
    const Frame a = slope(x), b = slope(plus(x, a, h / 2)), c = slope(plus(x, b, h / 2)),
                d = slope(plus(x, c, h));
    x = plus(plus(plus(plus(x, a, h / 6), b, h / 3), c, h / 3), d, h / 6);
  }
  return x;
}

const Rule& GaussRule(int points) {
  static std::map<int, Rule> rules;
  Rule& rule = rules[points];
  if (!rule.nodes.empty()) return rule;
  Matrix jacobi = Matrix::Zero(points, points);
  for (int k = 1; k < points; ++k) {
    jacobi(k, k - 1) = jacobi(k - 1, k) = k / std::sqrt(4 * Real(k) * k - 1);
  }
  const Eigen::SelfAdjointEigenSolver<Matrix> modes(jacobi);
  for (int k = 0; k < points; ++k) {
    rule.nodes.push_back((1 + modes.eigenvalues()[k]) / 2);
    rule.weights.push_back(modes.eigenvectors()(0, k) * modes.eigenvectors()(0, k));
  }
  return rule;
}

Frame Rod::At(const Frame& clamp, const Vector& theta, int Q, Real u) const {
  Frame frame = clamp;
  for (int P = 0; P < Q; ++P) {
    frame = Advance(frame, theta.segment<3>(3 * P) / length(P), length(P));
  }
  return Advance(frame, theta.segment<3>(3 * Q) / length(Q), u * length(Q));
}

Matrix3X Rod::Points(const Frame& clamp, const Vector& theta, const Rule& rule) const {
  const int G = static_cast<int>(rule.nodes.size());
  Matrix3X points(3, elements() * G);
  Frame frame = clamp;
  for (int Q = 0; Q < elements(); ++Q) {
    const Vector3 kappa = theta.segment<3>(3 * Q) / length(Q);
    for (int g = 0; g < G; ++g) {
      points.col(Q * G + g) = Advance(frame, kappa, rule.nodes[g] * length(Q)).r;
    }
    frame = Advance(frame, kappa, length(Q));
  }
  return points;
}

Vector Rod::Masses(const Rule& rule) const {
  const int G = static_cast<int>(rule.nodes.size());
  Vector masses(elements() * G);
  for (int i = 0; i < masses.size(); ++i) {
    masses[i] = strand_.linear_density * length(i / G) * rule.weights[i % G];
  }
  return masses;
}

std::vector<Matrix3X> Rod::Jacobians(const Frame& clamp, const Vector& theta,
                                     const Rule& rule) const {
  const int n = static_cast<int>(theta.size());
  const auto shifted = [&](int i, int k) {
    Vector moved = theta;
    moved[i] += k * kStep;
    return Points(clamp, moved, rule);
  };
  std::vector<Matrix3X> J(elements() * rule.nodes.size(), Matrix3X(3, n));
  for (int i = 0; i < n; ++i) {
    const Matrix3X d =
        (8 * (shifted(i, 1) - shifted(i, -1)) - (shifted(i, 2) - shifted(i, -2))) / (12 * kStep);
    for (size_t k = 0; k < J.size(); ++k) J[k].col(i) = d.col(k);
  }
  return J;
}

Matrix Rod::StepMasses() const {
  constexpr int kPoints = 3;
  const Rule& rule = GaussRule(kPoints);
  Matrix W = Masses(rule).asDiagonal();
  Real L = 0;
  for (int Q = 0; Q < elements(); ++Q) L += length(Q);
  const Real softer = std::min(strand_.stiffness[1], strand_.stiffness[2]);
  const Real number = 9.81L * strand_.linear_density * L * L * L / softer;
  // The second moment of mass is a twelfth; half as much again for light hair.
  const Real more = (number < 4 ? 1 : 4 / number) / 24;
  const Real distance = rule.nodes[2] - rule.nodes[0];
  for (int Q = 0; Q < elements(); ++Q) {
    const Real each = strand_.linear_density * length(Q) * more / (distance * distance);
    const int first = kPoints * Q, last = first + kPoints - 1;
    W(first, first) += each, W(last, last) += each;
    W(first, last) -= each, W(last, first) -= each;
  }
  return W;
}

namespace {

// sum W_kl J_k^T J_l
Matrix Congruence(const Matrix& W, const std::vector<Matrix3X>& J) {
  Matrix M = Matrix::Zero(J[0].cols(), J[0].cols());
  for (size_t k = 0; k < J.size(); ++k) {
    for (size_t l = 0; l < J.size(); ++l) {
      if (W(k, l) != 0) M += W(k, l) * J[k].transpose() * J[l];
    }
  }
  return M;
}

// sum W_kl J_k^T u_l
Vector Momentum(const Matrix& W, const std::vector<Matrix3X>& J, const Matrix3X& u) {
  Vector p = Vector::Zero(J[0].cols());
  const Matrix3X Wu = u * W;
  for (size_t k = 0; k < J.size(); ++k) p += J[k].transpose() * Wu.col(k);
  return p;
}

}  // namespace

Matrix Rod::StepMass(const Frame& clamp, const Vector& theta) const {
  return Congruence(StepMasses(), Jacobians(clamp, theta, GaussRule(kGaussPoints)));
}

Matrix Rod::Mass(const Frame& clamp, const Vector& theta, int points) const {
  const Rule& rule = GaussRule(points);
  const std::vector<Matrix3X> J = Jacobians(clamp, theta, rule);
  const Vector masses = Masses(rule);
  Matrix M = Matrix::Zero(theta.size(), theta.size());
  for (size_t k = 0; k < J.size(); ++k) M += masses[k] * J[k].transpose() * J[k];
  return M;
}

Real Rod::Elastic(const Vector& theta) const {
  Real U = 0;
  for (int Q = 0; Q < elements(); ++Q) {
    for (int i = 0; i < 3; ++i) {
      const Real bend = theta[3 * Q + i] / length(Q) - strand_.natural[Q][i];
      U += length(Q) * strand_.stiffness[i] * bend * bend / 2;
    }
  }
  return U;
}

Real Rod::Gravity(const Frame& clamp, const Vector3& g, const Vector& theta) const {
  const Rule& rule = GaussRule(48);
  const Matrix3X points = Points(clamp, theta, rule).colwise() - clamp.r;
  return -g.dot(points * Masses(rule));
}

Vector Rod::Gradient(const Frame& clamp, const Vector3& g, const Vector& theta) const {
  Vector gradient(theta.size());
  for (int i = 0; i < theta.size(); ++i) {
    const auto energy = [&](int k) {
      Vector moved = theta;
      moved[i] += k * kStep;
      return Elastic(moved) + Gravity(clamp, g, moved);
    };
    gradient[i] = (8 * (energy(1) - energy(-1)) - (energy(2) - energy(-2))) / (12 * kStep);
  }
  return gradient;
}

Vector Rod::Stiffness() const {
  Vector K(3 * elements());
  for (int i = 0; i < K.size(); ++i) K[i] = strand_.stiffness[i % 3] / length(i / 3);
  return K;
}

Vector Rod::Friction() const {
  Vector D(3 * elements());
  for (int i = 0; i < D.size(); ++i) D[i] = strand_.internal_friction / length(i / 3);
  return D;
}

Vector Rod::Natural() const {
  Vector natural(3 * elements());
  for (int i = 0; i < natural.size(); ++i)
    natural[i] = strand_.natural[i / 3][i % 3] * length(i / 3);
  return natural;
}

Matrix Rod::Turning(const Frame& clamp, const Vector3& w, const Vector& theta) const {
  const int N = elements();
  const Real e = 1e-3L;
  const auto frame = [&](const Vector& at, int Q, Real u) { return At(clamp, at, Q, u); };
  // Arms: an element carries itself and all beyond it.
  std::vector<Vector3> arm(N + 1, Vector3::Zero());
  Real beyond = 0;
  for (int Q = N - 1; Q >= 0; --Q) {
    const Vector3 left = frame(theta, Q, 0).r;
    const Rule& fine = GaussRule(24);
    for (size_t g = 0; g < fine.nodes.size(); ++g) {
      arm[Q] += strand_.linear_density * length(Q) * fine.weights[g] *
                (frame(theta, Q, fine.nodes[g]).r - left);
    }
    arm[Q] += beyond * (frame(theta, Q, 1).r - left);
    beyond += strand_.linear_density * length(Q);
  }
  Matrix form = Matrix::Zero(theta.size(), theta.size());
  for (int Q = 0; Q < N; ++Q) {
    const Vector3 D = (arm[Q] + arm[Q + 1]) / 2;
    const Matrix3 product = (w * D.transpose() + D * w.transpose()) / 2;
    const Eigen::SelfAdjointEigenSolver<Matrix3> solver(w.dot(D) * Matrix3::Identity() - product);
    const Matrix3 convex = solver.eigenvectors() *
                           solver.eigenvalues().cwiseMax(Real(0)).asDiagonal() *
                           solver.eigenvectors().transpose();
    // Rotation of the right end per rate.
    Matrix3X turn(3, theta.size());
    const Matrix3 at = frame(theta, Q, 1).n;
    for (int i = 0; i < theta.size(); ++i) {
      // Fourth order differences of the rotation away from `at`.
      const auto away = [&](Real step) -> Vector3 {
        Vector moved = theta;
        moved[i] += step;
        const Matrix3 R = frame(moved, Q, 1).n * at.transpose();
        return Vector3(R(2, 1) - R(1, 2), R(0, 2) - R(2, 0), R(1, 0) - R(0, 1)) / 2;
      };
      turn.col(i) = (8 * (away(e) - away(-e)) - (away(2 * e) - away(-2 * e))) / (12 * e);
    }
    form += turn.transpose() * convex * turn;
  }
  return form;
}

void DenseStep(const Strand& strand, const ClampMotion& clamp, const Surroundings& surroundings,
               StrandState state) {
  const Rod rod(strand);
  const Air air(strand, surroundings);
  const Real dt = clamp.dt, h = kTheta * dt, c = air.drag_rate;
  const Eigen::Quaternion<Real> begin = clamp.begin.q.cast<Real>().normalized(),
                                end = clamp.end.q.cast<Real>().normalized();
  const Vector3 p0 = clamp.begin.p.cast<Real>(), p1 = clamp.end.p.cast<Real>();
  const Eigen::AngleAxis<Real> turn(end * begin.conjugate());
  const Vector3 velocity = (p1 - p0) / dt, spin = turn.axis() * (turn.angle() / dt);
  const Frame root{begin.slerp(Real(kTheta), end).toRotationMatrix(), p0 + kTheta * (p1 - p0)};

  // (S2): geometry at the extrapolated angles.
  const Vector theta = Stack(state.theta), rate = Stack(state.rate), ahead = theta + h * rate;
  const Rule& few = GaussRule(kGaussPoints);
  const Matrix3X r = rod.Points(root, ahead, few);
  const std::vector<Matrix3X> J = rod.Jacobians(root, ahead, few);
  const Matrix masses = rod.StepMasses();

  // (S3): the minimum of the quadratic form.
  Matrix H = Matrix::Zero(theta.size(), theta.size());
  Vector b = -h * rod.Stiffness().cwiseProduct(theta - rod.Natural());
  const Vector stiff = h * h * rod.Stiffness();
  H.diagonal() = stiff + (h * air.friction * rod.Friction()).cwiseMax(kLeastFriction * stiff);
  Matrix3X base(3, J.size()), u(3, J.size());
  for (size_t k = 0; k < J.size(); ++k) {
    base.col(k) = velocity + spin.cross(r.col(k) - root.r);
    u.col(k) = state.velocity[k].cast<Real>();
  }
  H += (1 + h * c) * Congruence(masses, J);
  b += Momentum(masses, J, u - (1 + h * c) * base);
  const Vector3 body = air.gravity + c * air.wind;
  b -= h * (rod.Gradient(root, body, ahead) - rod.Gradient(root, Vector3::Zero(), ahead));
  const Matrix turning = h * h * rod.Turning(root, body - c * velocity, ahead);
  H += turning;
  b += turning * rate;
  const Vector v = H.ldlt().solve(b);

  // (S4).
  for (size_t k = 0; k < J.size(); ++k) {
    const Vector3 ahead_u = base.col(k) + J[k] * v;
    state.velocity[k] = (u.col(k) + (ahead_u - u.col(k)) / kTheta).cast<double>();
  }
  for (int Q = 0; Q < rod.elements(); ++Q) {
    state.rate[Q] = v.segment<3>(3 * Q).cast<double>();
    state.theta[Q] = (theta + dt * v).segment<3>(3 * Q).cast<double>();
  }
}

namespace {

// Points when time goes on by `dt` at constant rates.
Matrix3X Ahead(const Rod& rod, const std::function<Frame(Real)>& clamp, Real t,
               const Motion& motion, const Rule& rule, Real dt) {
  return rod.Points(clamp(t + dt), motion.theta + dt * motion.rate, rule);
}

Vector Acceleration(const Strand& strand, const std::function<Frame(Real)>& clamp,
                    const Surroundings& surroundings, Real t, const Motion& motion) {
  const Rod rod(strand);
  const Air air(strand, surroundings);
  const Frame root = clamp(t);
  const Rule &few = GaussRule(kGaussPoints), &fine = GaussRule(12);
  const Real e = 1e-3L;
  Matrix3X x[5];
  for (int i = -2; i <= 2; ++i) x[i + 2] = Ahead(rod, clamp, t, motion, few, i * e);
  const Matrix3X velocity = (8 * (x[3] - x[1]) - (x[4] - x[0])) / (12 * e);
  const Matrix3X bias = (16 * (x[3] + x[1]) - (x[4] + x[0]) - 30 * x[2]) / (12 * e * e);
  Vector f = -rod.Stiffness().cwiseProduct(motion.theta - rod.Natural()) -
             air.friction * rod.Friction().cwiseProduct(motion.rate);
  const std::vector<Matrix3X> J = rod.Jacobians(root, motion.theta, few);
  const Matrix masses = rod.StepMasses(), M = Congruence(masses, J);
  f -= Momentum(masses, J, bias + air.drag_rate * velocity);
  const std::vector<Matrix3X> weight_J = rod.Jacobians(root, motion.theta, fine);
  const Vector weights = rod.Masses(fine);
  for (size_t k = 0; k < weight_J.size(); ++k) {
    f += weights[k] * weight_J[k].transpose() * (air.gravity + air.drag_rate * air.wind);
  }
  return M.ldlt().solve(f);
}

}  // namespace

Motion IntegrateLagrange(const Strand& strand, const std::function<Frame(Real)>& clamp,
                         const Surroundings& air, Motion motion, Real duration, int steps) {
  const Real h = duration / steps;
  const auto slope = [&](Real t, const Motion& x) {
    return Motion{x.rate, Acceleration(strand, clamp, air, t, x)};
  };
  const auto plus = [](const Motion& x, const Motion& d, Real w) {
    return Motion{x.theta + w * d.theta, x.rate + w * d.rate};
  };
  for (int i = 0; i < steps; ++i) {
    const Real t = i * h;
    const Motion a = slope(t, motion), b = slope(t + h / 2, plus(motion, a, h / 2)),
                 c = slope(t + h / 2, plus(motion, b, h / 2)), d = slope(t + h, plus(motion, c, h));
    motion = plus(plus(plus(plus(motion, a, h / 6), b, h / 3), c, h / 3), d, h / 6);
  }
  return motion;
}

Matrix3X PointVelocities(const Strand& strand, const std::function<Frame(Real)>& clamp, Real t,
                         const Motion& motion, const Rule& rule) {
  const Rod rod(strand);
  const Real e = 1e-3L;
  const auto x = [&](int i) { return Ahead(rod, clamp, t, motion, rule, i * e); };
  return (8 * (x(1) - x(-1)) - (x(2) - x(-2))) / (12 * e);
}

}  // namespace mane::rod::oracle
