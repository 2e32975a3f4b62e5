#include "wire/reconstruct.h"

#include <Eigen/Geometry>
#include <cmath>
#include <complex>
#include <cstddef>

#include "base/check.h"
#include "math/stumpff.h"

namespace mane::wire {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3cd;
using Eigen::Vector3d;
using Eigen::Vector4d;
using std::complex;

// Where the part `u` of a helix of unit length and angles `theta` ends, in its left frame.
Vector3d ChordOfHelix(const Vector3d& theta, double u) {
  const Vector3d phi = u * theta;
  const auto c = math::StumpffC(phi.squaredNorm());
  const Vector3d turn = phi.cross(Vector3d::UnitX());
  return u * (Vector3d::UnitX() + c[2] * turn + c[3] * phi.cross(turn));
}

// exp([theta])
Matrix3d TurnOfHelix(const Vector3d& theta) {
  const auto c = math::StumpffC(theta.squaredNorm());
  const Matrix3d K = math::Cross(theta);
  return Matrix3d::Identity() + c[1] * K + c[2] * (K * K);
}

// An element of a plain strand.
class Helix {
 public:
  explicit Helix(const Vector3d& theta) : theta_(theta) {}

  [[nodiscard]] Vector3d Chord(double u) const { return ChordOfHelix(theta_, u); }
  [[nodiscard]] Matrix3d Turn() const { return TurnOfHelix(theta_); }

 private:
  Vector3d theta_;
};

// int_0^s e^(i rate sigma) dsigma
complex<double> IntegralOfTurning(double rate, double s) {
  const double half = 0.5 * rate * s;
  const double sinc = half == 0 ? 1 : std::sin(half) / half;
  return std::polar(s * sinc, half);
}

// An element of a wound strand, in its axis frame.
class WoundHelix {
 public:
  // `winding` is W = |kappa^n| l, `rise` and `across` are cos and sin(alpha), `phase` is the angle
  // wound before the element.
  WoundHelix(double winding, double rise, double across, const Vector4d& x, double phase)
      : winding_(winding) {
    // (C3); m - W is written without its cancellation where a coil winds often.
    const double along = winding + x[0], turn = std::hypot(along, x[3]);
    beta_ = {(x[0] * (2 * winding + x[0]) + x[3] * x[3]) / (turn + winding), x[1], x[2]};
    stretch_ = (rise * along + across * x[3]) / turn;
    const double slant = (across * along - rise * x[3]) / turn;

    // The parts of v along n = beta / |beta| and across it, which turn by e^(-+i |beta| s). They
    // add up to v whatever n is, so that a straight axis may have any.
    bend_ = beta_.norm();
    const Vector3d n = bend_ > 0 ? Vector3d(beta_ / bend_) : Vector3d::UnitX();
    const complex<double> i(0, 1);
    const Vector3cd v = slant * std::polar(1.0, phase) * Vector3cd(0, 1, -i);
    const Vector3cd turned = i * (math::Cross(n) * v);
    still_ = n * n.dot(v.real()) + i * (n * n.dot(v.imag()));
    forward_ = 0.5 * (v - still_ - turned);
    backward_ = 0.5 * (v - still_ + turned);
  }

  [[nodiscard]] Vector3d Chord(double u) const {
    const Vector3cd off = IntegralOfTurning(winding_, u) * still_ +
                          IntegralOfTurning(winding_ + bend_, u) * forward_ +
                          IntegralOfTurning(winding_ - bend_, u) * backward_;
    return stretch_ * ChordOfHelix(beta_, u) + off.real();
  }
  [[nodiscard]] Matrix3d Turn() const { return TurnOfHelix(beta_); }

 private:
  double winding_, stretch_, bend_;
  Vector3d beta_;
  Vector3cd still_, forward_, backward_;
};

// Lays elements one after another; `element(q)` makes them, and is asked for each once, in order.
template <typename MakeElement, typename Point>
void Sample(Matrix3d R, Vector3d r, std::span<const double> lengths, MakeElement element,
            std::span<Point> out) {
  MANE_CHECK(!lengths.empty() && out.size() >= 2);
  double total = 0;
  for (const double l : lengths) total += l;

  const size_t last = out.size() - 1;
  const double spacing = total / static_cast<double>(last);
  double start = 0;
  size_t i = 0;
  for (size_t q = 0; q < lengths.size(); ++q) {
    const double l = lengths[q];
    const auto helix = element(q);
    for (; i < last; ++i) {
      const double u = (static_cast<double>(i) * spacing - start) / l;
      if (u > 1) break;
      out[i] = (r + l * (R * helix.Chord(u))).template cast<typename Point::Scalar>();
    }
    r += l * (R * helix.Chord(1));
    R = R * helix.Turn();
    start += l;
  }
  // Rounding of the sums can leave points within an ulp of the tip unvisited.
  for (; i <= last; ++i) out[i] = r.template cast<typename Point::Scalar>();
}

template <typename Point>
void SamplePlain(const math::Pose& root, std::span<const double> lengths,
                 std::span<const Vector3d> theta, std::span<Point> out) {
  MANE_CHECK(lengths.size() == theta.size());
  Sample(
      root.q.toRotationMatrix(), root.p, lengths, [&](size_t q) { return Helix(theta[q]); }, out);
}

// (C1): the columns are the coil's axis a, w = (e0 - cos(alpha) a) / sin(alpha), and a x w.
Matrix3d CoilFrame(const Vector3d& natural) {
  const Eigen::Vector2d bend = natural.tail<2>().normalized();
  const double rise = natural.x() / natural.norm();
  const double across = natural.tail<2>().norm() / natural.norm();
  const Vector3d a(rise, across * bend.x(), across * bend.y());
  const Vector3d w(across, -rise * bend.x(), -rise * bend.y());
  Matrix3d F;
  F << a, w, a.cross(w);
  return F;
}

template <typename Point>
void SampleWound(const math::Pose& root, std::span<const double> lengths,
                 std::span<const Vector3d> natural, std::span<const Vector4d> x,
                 std::span<Point> out) {
  MANE_CHECK(!lengths.empty() && lengths.size() == natural.size() && lengths.size() == x.size());
  double phase = 0;
  const auto element = [&](size_t q) {
    const double omega = natural[q].norm(), across = natural[q].tail<2>().norm();
    MANE_CHECK(across > 0);
    const double winding = omega * lengths[q];
    const WoundHelix helix(winding, natural[q].x() / omega, across / omega, x[q], phase);
    phase += winding;
    return helix;
  };
  Sample(root.q.toRotationMatrix() * CoilFrame(natural[0]), root.p, lengths, element, out);
}

}  // namespace

void SamplePoints(const math::Pose& root, std::span<const double> lengths,
                  std::span<const Vector3d> theta, std::span<Vector3d> out) {
  SamplePlain(root, lengths, theta, out);
}

void SamplePoints(const math::Pose& root, std::span<const double> lengths,
                  std::span<const Vector3d> theta, std::span<Eigen::Vector3f> out) {
  SamplePlain(root, lengths, theta, out);
}

void SampleWoundPoints(const math::Pose& root, std::span<const double> lengths,
                       std::span<const Vector3d> natural, std::span<const Vector4d> x,
                       std::span<Vector3d> out) {
  SampleWound(root, lengths, natural, x, out);
}

void SampleWoundPoints(const math::Pose& root, std::span<const double> lengths,
                       std::span<const Vector3d> natural, std::span<const Vector4d> x,
                       std::span<Eigen::Vector3f> out) {
  SampleWound(root, lengths, natural, x, out);
}

}  // namespace mane::wire
