#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <algorithm>
#include <random>
#include <span>
#include <string>
#include <vector>

#include "math/rigid.h"
#include "rod/chain.h"
#include "rod/graded_lengths.h"
#include "rod/rotary_inertia.h"
#include "rod/scheme.h"
#include "rod/step.h"
#include "rod/strand.h"

/// Strands and states that the tests of this folder share.
namespace mane::rod::fixtures {

inline constexpr double kL = 0.2;                    ///< Length of most strands [m].
inline const Eigen::Vector3d kGravity(0, -9.81, 0);  ///< [m/s^2]

/// A clamp whose tangent points straight up.
inline math::Pose Upright() {
  return {Eigen::Vector3d::Zero(),
          Eigen::Quaterniond::FromTwoVectors(Eigen::Vector3d::UnitX(), -kGravity)};
}

/// A row of [SH06] Appendix B, with the formulas of its section 4.2.
struct Hair {
  std::string name;
  double radius;         ///< [m]
  double ellipticity;    ///< Larger over smaller semi-axis.
  double helix_radius;   ///< [m]; 0 is straight.
  double helix_step;     ///< [m]
  double young_modulus;  ///< [Pa]
};

inline const std::vector<Hair>& AppendixB() {
  static const std::vector<Hair> hairs = {{"smooth", 50e-6, 1.0, 0, 0, 1e9},
                                          {"wavy", 35e-6, 1.1, 1e-2, 0.5e-2, 2e9},
                                          {"curly", 50e-6, 1.1, 0.6e-2, 0.5e-2, 1.5e9},
                                          {"fuzzy", 50e-6, 1.2, 0.1e-2, 1e-2, 0.5e9}};
  return hairs;
}

/// `elements` equal elements of a hair of `length` [m], with friction and drag from the middle of
/// the ranges of [SH06] 4.2.
inline Strand MakeStrand(const Hair& hair, double length, int elements) {
  const double root = std::sqrt(hair.ellipticity);
  const Section section{hair.radius * root, hair.radius / root};
  const Material material{hair.young_modulus, 0.48, 1300};
  Strand strand;
  strand.length.assign(elements, length / elements);
  Eigen::Vector3d natural = Eigen::Vector3d::Zero();
  if (hair.helix_radius > 0) {
    natural.x() = hair.helix_step / (2 * M_PI * hair.helix_radius * hair.helix_radius);
    natural.y() = 1 / hair.helix_radius;
  }
  strand.natural.assign(elements, natural);
  strand.stiffness = Stiffness(section, material);
  strand.linear_density = LinearDensity(section, material);
  strand.internal_friction = 1e-10;
  strand.air_drag = 1e-5;
  return strand;
}

/// A straight round strand of gravito-bending number rho S g L^3 / EI = `number` at g = 9.81 m/s^2,
/// L = 0.2 m, without friction or drag.
inline Strand HeavyStrand(double number, int elements) {
  Strand strand = MakeStrand(AppendixB()[0], 0.2, elements);
  const double ratio = strand.stiffness[0] / strand.stiffness[1];
  const double EI = strand.linear_density * 9.81 * 0.2 * 0.2 * 0.2 / number;
  strand.stiffness = {ratio * EI, EI, EI};
  strand.internal_friction = 0;
  strand.air_drag = 0;
  return strand;
}

/// The inertia matrix of the time step: by its Gauss points, with what S12 adds [kg m^2], (3N x
/// 3N).
inline Eigen::MatrixXd StepMassMatrix(const Strand& strand, const math::Pose& clamp,
                                      std::span<const Eigen::Vector3d> theta) {
  Eigen::MatrixXd M = MassMatrix(strand, clamp, theta, kGaussPoints);
  const double mu = RotaryInertia(strand);
  for (int Q = 0; Q < strand.elements(); ++Q) {
    const Eigen::MatrixXd apart =
        PointAt(strand, clamp, theta, {Q, kGauss.nodes[kGaussPoints - 1]}).J -
        PointAt(strand, clamp, theta, {Q, kGauss.nodes[0]}).J;
    M += mu * strand.linear_density * strand.length[Q] * apart.transpose() * apart;
  }
  return M;
}

/// `strand` with the element lengths that generated straight hair has.
inline Strand Graded(Strand strand) {
  strand.length = GradedLengths({.length = strand.TotalLength(),
                                 .stiffness = strand.stiffness.tail<2>().minCoeff(),
                                 .linear_density = strand.linear_density},
                                strand.elements());
  return strand;
}

/// What moves, owned.
struct State {
  std::vector<Eigen::Vector3d> theta, rate, velocity;

  /// The natural shape at rest.
  explicit State(const Strand& strand)
      : theta(strand.natural),
        rate(strand.elements(), Eigen::Vector3d::Zero()),
        velocity(strand.elements() * kGaussPoints, Eigen::Vector3d::Zero()) {
    for (int Q = 0; Q < strand.elements(); ++Q) theta[Q] *= strand.length[Q];
  }
  StrandState View() { return {theta, rate, velocity}; }
};

/// The tip of a strand of these angles.
inline Eigen::Vector3d Tip(const Strand& strand, const math::Pose& clamp,
                           std::span<const Eigen::Vector3d> theta) {
  return ElementFrames(strand, clamp, theta).back().r;
}

/// The longest of all vectors.
inline double Largest(const std::vector<Eigen::Vector3d>& vectors) {
  double largest = 0;
  for (const Eigen::Vector3d& v : vectors) largest = std::max(largest, v.norm());
  return largest;
}

/// The longest difference of equally many vectors.
inline double Difference(const std::vector<Eigen::Vector3d>& a,
                         const std::vector<Eigen::Vector3d>& b) {
  double largest = 0;
  for (size_t i = 0; i < a.size(); ++i) largest = std::max(largest, (a[i] - b[i]).norm());
  return largest;
}

/// Seeded random strands, states and poses.
class Random {
 public:
  explicit Random(uint64_t seed) : engine_(seed) {}

  double Uniform(double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(engine_);
  }
  Eigen::Vector3d Vector(double scale) {
    return {Uniform(-scale, scale), Uniform(-scale, scale), Uniform(-scale, scale)};
  }
  Eigen::Vector3d Direction() {
    std::normal_distribution<double> normal;
    return Eigen::Vector3d(normal(engine_), normal(engine_), normal(engine_)).normalized();
  }
  Eigen::Quaterniond Rotation() {
    std::normal_distribution<double> normal;
    return Eigen::Quaterniond(normal(engine_), normal(engine_), normal(engine_), normal(engine_))
        .normalized();
  }
  math::Pose Pose() { return {Vector(1), Rotation()}; }
  std::vector<Eigen::Vector3d> Vectors(int n, double scale) {
    std::vector<Eigen::Vector3d> result(n);
    for (Eigen::Vector3d& v : result) v = Vector(scale);
    return result;
  }

  /// About `length` [m] in elements of lengths within a factor 3, curved by up to `angle` [rad]
  /// each, three different stiffnesses, with friction and drag.
  Strand UnevenStrand(int elements, double length, double angle) {
    Strand strand = MakeStrand(AppendixB()[0], length, elements);
    for (int Q = 0; Q < elements; ++Q) {
      strand.length[Q] *= Uniform(0.5, 1.5);
      strand.natural[Q] = Vector(angle / strand.length[Q]);
    }
    strand.stiffness = strand.stiffness.cwiseProduct(Eigen::Vector3d(1, 1.4, 0.8));
    return strand;
  }

  /// A root anywhere on a head.
  math::Pose AnyRoot() { return {Vector(0.1), Rotation()}; }

  /// Any clamp motion within a step: up to a centimetre and half a radian along each axis.
  ClampMotion AnyMotion(double dt) {
    const math::Pose begin = Pose();
    const math::Pose end{begin.p + Vector(0.01), math::FromRotationVector(Vector(0.5)) * begin.q};
    return {begin, end, dt};
  }

  /// Any gravity, wind, friction and drag, some ten times what hair meets.
  Surroundings AnyAir() {
    Surroundings air;
    air.gravity = Vector(10);
    air.wind = Vector(3);
    air.internal_friction_scale = Uniform(0, 2);
    air.air_drag_scale = Uniform(0, 20);
    return air;
  }

  /// Any angles up to `angle` [rad] off the natural shape, any rates [rad/s], any velocities [m/s].
  State AnyState(const Strand& strand, double angle, double rate, double velocity) {
    State state(strand);
    for (Eigen::Vector3d& v : state.theta) v += Vector(angle);
    for (Eigen::Vector3d& v : state.rate) v = Vector(rate);
    for (Eigen::Vector3d& v : state.velocity) v = Vector(velocity);
    return state;
  }

 private:
  std::mt19937_64 engine_;
};

}  // namespace mane::rod::fixtures
