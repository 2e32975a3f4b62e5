#include "rod/hessian.h"

#include <algorithm>
#include <cmath>

#include "base/check.h"

namespace mane::rod {
namespace {

using Eigen::Matrix2d;
using Eigen::Matrix3d;
using Eigen::Vector2d;
using Eigen::Vector3d;
using math::Cross;
using Matrix32 = Eigen::Matrix<double, 3, 2>;

// f of (H3), 2 df/dz and 4 d^2f/dz^2.
struct Coefficient {
  double f, g, k;
};

// Second derivative by theta of w.(f2 theta x a + f3 theta x (theta x a)), the curves of an element
// and its rotation (Q2).
Matrix3d SecondDerivative(const Vector3d& theta, const Vector3d& w, const Vector3d& a,
                          const Coefficient& f2, const Coefficient& f3) {
  const Vector3d dA = a.cross(w);  // Derivatives of w.A and of w.B.
  const Vector3d dB = theta.dot(a) * w + theta.dot(w) * a - 2 * a.dot(w) * theta;
  const double wA = theta.dot(dA),
               wB = theta.dot(a) * theta.dot(w) - a.dot(w) * theta.squaredNorm();
  const Vector3d slope = f2.g * dA + f3.g * dB + (0.5 * (f2.k * wA + f3.k * wB)) * theta;
  const Matrix3d half = f3.f * w * a.transpose() + slope * theta.transpose();
  Matrix3d H = half + half.transpose();
  H.diagonal().array() += f2.g * wA + f3.g * wB - 2 * f3.f * a.dot(w);
  return H;
}

// Lower Cholesky factor of a 3 x 3, or false.
bool Cholesky(const Matrix3d& A, Matrix3d* L) {
  const double d0 = A(0, 0);
  if (!(d0 > 0)) return false;
  const double l00 = std::sqrt(d0), l10 = A(1, 0) / l00, l20 = A(2, 0) / l00;
  const double d1 = A(1, 1) - l10 * l10;
  if (!(d1 > 0)) return false;
  const double l11 = std::sqrt(d1), l21 = (A(2, 1) - l20 * l10) / l11;
  const double d2 = A(2, 2) - l20 * l20 - l21 * l21;
  if (!(d2 > 0)) return false;
  *L << l00, 0, 0, l10, l11, 0, l20, l21, std::sqrt(d2);
  return std::isfinite(l00 + l11 + (*L)(2, 2));
}

template <typename Block>
Block ForwardSolve(const Matrix3d& L, const Block& b) {
  Block x;
  x.row(0) = b.row(0) / L(0, 0);
  x.row(1) = (b.row(1) - L(1, 0) * x.row(0)) / L(1, 1);
  x.row(2) = (b.row(2) - L(2, 0) * x.row(0) - L(2, 1) * x.row(1)) / L(2, 2);
  return x;
}

Vector3d BackwardSolve(const Matrix3d& L, const Vector3d& b) {
  Vector3d x;
  x[2] = b[2] / L(2, 2);
  x[1] = (b[1] - L(2, 1) * x[2]) / L(1, 1);
  x[0] = (b[0] - L(1, 0) * x[1] - L(2, 0) * x[2]) / L(0, 0);
  return x;
}

double Dot(std::span<const Vector3d> a, std::span<const Vector3d> b) {
  double sum = 0;
  for (size_t i = 0; i < a.size(); ++i) sum += a[i].dot(b[i]);
  return sum;
}

}  // namespace

void PotentialHessian::Linearize(const Strand& strand, const math::Pose& clamp,
                                 const Vector3d& gravity, std::span<const Vector3d> theta) {
  const int N = strand.elements();
  MANE_CHECK(static_cast<int>(theta.size()) == N);
  elements_.resize(N);
  shapes_.resize(N);
  gradient_.resize(N);
  metric_.resize(N);
  // Two world axes across gravity, e1 x e2 along it: |g| (e2 e1^T - e1 e2^T) is [g].
  const double g = gravity.norm();
  const Vector3d down = g > 0 ? Vector3d(gravity / g) : Vector3d::UnitX();
  int least;
  (void)down.cwiseAbs().minCoeff(&least);
  const Vector3d e1 = down.cross(Vector3d::Unit(least)).normalized(), e2 = down.cross(e1);

  Matrix3d R = clamp.q.toRotationMatrix();
  for (int Q = 0; Q < N; ++Q) {
    elements_[Q].R = R;
    Shape& shape = shapes_[Q];
    shape.C = math::StumpffC(theta[Q].squaredNorm());
    shape.end = EndOfElement(theta[Q], shape.C);
    R = R * shape.end.E;
  }

  energy_ = 0;
  double mass_beyond = 0;
  Vector3d moment = Vector3d::Zero();  // Mass times position beyond, from the right end, world.
  for (int Q = N - 1; Q >= 0; --Q) {
    Element& element = elements_[Q];
    const Vector3d& th = theta[Q];
    const double l = strand.length[Q], mass = strand.linear_density * l;
    const math::Stumpff& C = shapes_[Q].C;
    const ElementEnd& end = shapes_[Q].end;
    const math::StumpffTail tail = math::StumpffCTail(C, th.squaredNorm());
    const auto coefficient = [&](int n) {
      return Coefficient{C[n], math::TwiceDerivative(C, n),
                         math::FourTimesSecondDerivative(C, tail, n)};
    };
    const Coefficient c1 = coefficient(1), c2 = coefficient(2), c3 = coefficient(3),
                      c4 = coefficient(4);
    const auto sum = [&](const Coefficient& a, const Coefficient& b) {
      const double u = l * mass_beyond, v = l * mass;
      return Coefficient{u * a.f + v * b.f, u * a.g + v * b.g, u * a.k + v * b.k};
    };
    const Matrix3d& R_left = element.R;
    const Vector3d w = R_left.transpose() * gravity;
    const Vector3d beyond = end.E.transpose() * (R_left.transpose() * moment);  // In right frame.

    // The load matrix B_Q: what a uniform field does to the element's angles.
    const Matrix3d B = l * mass * end.G.transpose() + l * mass_beyond * end.J.transpose() +
                       end.T.transpose() * Cross(end.E * beyond);
    metric_[Q] = strand.stiffness / l;
    const Vector3d stretch = th - l * strand.natural[Q];
    const Vector3d elastic = metric_[Q].cwiseProduct(stretch);
    gradient_[Q] = elastic - B * w;
    energy_ += 0.5 * elastic.dot(stretch) - l * w.dot(mass * end.c + mass_beyond * end.p);
    element.H = -SecondDerivative(th, w, Vector3d::UnitX(), sum(c2, c3), sum(c3, c4)) -
                SecondDerivative(th, w, beyond, c1, c2);
    element.H.diagonal() += metric_[Q];
    const Matrix3d B_world = B * R_left.transpose();
    element.U << g * (B_world * e1), -g * (B_world * e2);
    const Matrix3d W = R_left * end.T;
    element.V << W.transpose() * e2, W.transpose() * e1;

    moment += R_left * (l * mass_beyond * end.p + l * mass * end.c);
    mass_beyond += mass;
  }
}

Eigen::MatrixXd PotentialHessian::Dense() const {
  const int N = static_cast<int>(elements_.size());
  Eigen::MatrixXd H(3 * N, 3 * N);
  for (int Q = 0; Q < N; ++Q) {
    H.block<3, 3>(3 * Q, 3 * Q) = elements_[Q].H;
    for (int P = 0; P < Q; ++P) {
      H.block<3, 3>(3 * Q, 3 * P) = elements_[Q].U * elements_[P].V.transpose();
      H.block<3, 3>(3 * P, 3 * Q) = H.block<3, 3>(3 * Q, 3 * P).transpose();
    }
  }
  return H;
}

bool PotentialHessian::Factor(double shift) {
  Matrix2d S = Matrix2d::Zero();
  for (size_t Q = 0; Q < elements_.size(); ++Q) {
    Element& element = elements_[Q];
    const Matrix32 US = element.U * S;
    Matrix3d pivot = element.H - US * element.U.transpose();
    pivot.diagonal() += shift * metric_[Q];
    if (!Cholesky(pivot, &element.L)) return false;
    element.V_eliminated = element.V - US;
    const Matrix32 Y = ForwardSolve(element.L, element.V_eliminated);
    S += Y.transpose() * Y;
  }
  return true;
}

void PotentialHessian::Solve(std::span<const Vector3d> b, std::span<Vector3d> x) const {
  const int N = static_cast<int>(elements_.size());
  MANE_CHECK(static_cast<int>(b.size()) == N && static_cast<int>(x.size()) == N);
  Vector2d z = Vector2d::Zero();
  for (int Q = 0; Q < N; ++Q) {
    const Element& element = elements_[Q];
    const Vector3d y = ForwardSolve(element.L, Vector3d(b[Q] - element.U * z));
    x[Q] = BackwardSolve(element.L, y);
    z += element.V_eliminated.transpose() * x[Q];
  }
  z.setZero();
  for (int Q = N - 1; Q >= 0; --Q) {
    const Element& element = elements_[Q];
    const Vector3d y = ForwardSolve(element.L, Vector3d(element.V_eliminated * z));
    x[Q] -= BackwardSolve(element.L, y);
    z += element.U.transpose() * x[Q];
  }
}

double PotentialHessian::LowestEigenvalue(std::span<Vector3d> mode) {
  const size_t N = elements_.size();
  // H + s D is positive definite just above s = -lambda.
  double low = -2, high = 1;
  while (!Factor(high)) {
    low = high;
    high *= 4;
    if (!(high < 1e12)) break;  // Not finite.
  }
  while (low < 0 && low > -1e12 && Factor(low)) {
    high = low;
    low *= 4;
  }
  while (high - low > 1e-5 * (1 + std::abs(high))) {
    const double middle = 0.5 * (low + high);
    (Factor(middle) ? high : low) = middle;
  }
  // Inverse iteration about `high`; the Rayleigh quotient is good to the square of the mode's
  // error.
  std::vector<Vector3d> x(N), Dx(N);
  for (size_t Q = 0; Q < N; ++Q) {
    const double q = static_cast<double>(Q + 1);
    x[Q] = {std::sin(1.7 * q + 0.3), std::sin(2.3 * q + 1.1), std::cos(1.3 * q + 0.2)};
    x[Q] = x[Q].cwiseQuotient(metric_[Q].cwiseSqrt());
  }
  double lambda = -high;
  if (!Factor(high)) return lambda;
  for (int i = 0; i < 12; ++i) {
    for (size_t Q = 0; Q < N; ++Q) Dx[Q] = metric_[Q].cwiseProduct(x[Q]);
    const double norm = std::sqrt(Dot(x, Dx));
    for (size_t Q = 0; Q < N; ++Q) Dx[Q] /= norm;
    Solve(Dx, x);
    // x = (H + s D)^-1 D y with |y|_D = 1: the quotient of x is y.D x / x.D x - s.
    double xDx = 0;
    for (size_t Q = 0; Q < N; ++Q) xDx += x[Q].dot(metric_[Q].cwiseProduct(x[Q]));
    const double next = Dot(Dx, x) / xDx - high;
    const bool settled = std::abs(next - lambda) < 1e-10 * (1 + std::abs(next)) && i >= 3;
    lambda = next;
    if (settled) break;
  }
  if (!mode.empty()) {
    MANE_CHECK(mode.size() == N);
    double largest = 0;
    for (const Vector3d& v : x) largest = std::max(largest, v.cwiseAbs().maxCoeff());
    for (size_t Q = 0; Q < N; ++Q) mode[Q] = x[Q] / largest;
  }
  return lambda;
}

}  // namespace mane::rod
