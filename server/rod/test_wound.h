#pragma once

#include <Eigen/Core>

#include <cmath>
#include <vector>

#include "rod/test_strands.h"
#include "rod/wound.h"

/// Wound strands and their states that the tests of this folder share.
namespace mane::rod::fixtures {

/// Elements of lengths l_Q ~ ratio^Q, of the same sum.
inline Strand Graded(Strand strand, double ratio) {
  const double L = strand.TotalLength();
  double sum = 0;
  for (int Q = 0; Q < strand.elements(); ++Q) sum += std::pow(ratio, Q);
  for (int Q = 0; Q < strand.elements(); ++Q) strand.length[Q] = L * std::pow(ratio, Q) / sum;
  return strand;
}

/// A wound strand of Appendix B with the grading of coil.md for N = 5, 8 or 10.
inline WoundStrand MakeGraded(const Hair& hair, double length, int elements) {
  const double ratio = elements <= 5 ? 1.4 : elements <= 8 ? 1.2 : 1.15;
  return MakeWound(Graded(MakeStrand(hair, length, elements), ratio));
}

/// Root frame that puts the natural coil's axis along world -y ("down") or along world x.
inline math::Pose AxisClamp(const Strand& strand, bool down) {
  const Eigen::Vector3d to = down ? Eigen::Vector3d(0, -1, 0) : Eigen::Vector3d(1, 0, 0);
  return {Eigen::Vector3d::Zero(),
          Eigen::Quaterniond::FromTwoVectors(strand.natural[0], to).normalized()};
}

/// A strand whose natural curvature varies along it as groomed hair's does (groom/generate.h,
/// CurlVariation): each component by a smooth random function of the standard deviation `relative`.
inline Strand Varied(Strand strand, double relative, Random& random) {
  const Eigen::Vector3d mean = strand.natural[0];
  const double bend = mean.tail<2>().norm();
  const Eigen::Vector3d scale = relative * Eigen::Vector3d(mean[0], bend, bend);
  for (int k = 0; k < 3; ++k) {
    for (int wave = 0; wave < 3; ++wave) {
      const double frequency = random.Uniform(0, 2), phase = random.Uniform(0, 1);
      for (int Q = 0; Q < strand.elements(); ++Q) {
        const double u = (Q + 0.5) / strand.elements();
        strand.natural[Q][k] +=
            scale[k] * std::sqrt(2.0 / 3) * std::cos(2 * M_PI * (frequency * u + phase));
      }
    }
  }
  return strand;
}

/// About `length` [m] in elements of lengths within a factor 3, wound about `turns` times, with a
/// natural curvature that varies by the part `variation` (0: one coil) and stiffnesses of three
/// different components, with friction and drag.
inline WoundStrand AnyWound(Random& random, int elements, double length, double turns,
                            double variation = 0.05) {
  Strand strand = random.UnevenStrand(elements, length, 0);
  const Eigen::Vector3d natural =
      Eigen::Vector3d(0.5, 1, -0.4) * (2 * M_PI * turns / strand.TotalLength() / std::sqrt(1.41));
  strand.natural.assign(elements, natural);
  return MakeWound(variation == 0 ? strand : Varied(strand, variation, random));
}

/// What moves, owned.
struct WoundOwned {
  std::vector<Vector4d> x, rate;
  std::vector<Eigen::Vector3d> velocity;

  /// The natural shape at rest.
  explicit WoundOwned(const WoundStrand& wound)
      : x(wound.natural),
        rate(wound.elements(), Vector4d::Zero()),
        velocity(wound.elements() * kBeads, Eigen::Vector3d::Zero()) {}
  /// Any unknowns up to `angle` [rad] off the natural ones, any rates [rad/s], any velocities
  /// [m/s].
  WoundOwned(const WoundStrand& wound, Random& random, double angle, double speed,
             double velocities)
      : WoundOwned(wound) {
    for (Vector4d& v : x)
      v += (Vector4d() << random.Vector(angle), random.Uniform(-angle, angle)).finished();
    for (Vector4d& v : rate) v << random.Vector(speed), random.Uniform(-speed, speed);
    for (Eigen::Vector3d& v : velocity) v = random.Vector(velocities);
  }
  WoundState View() { return {x, rate, velocity}; }
};

}  // namespace mane::rod::fixtures
