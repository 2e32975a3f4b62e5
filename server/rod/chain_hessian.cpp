#include "rod/chain_hessian.h"

#include <algorithm>
#include <cmath>

#include "base/check.h"

namespace mane::rod {
namespace {

using Eigen::Matrix2d;
using Eigen::Vector2d;

// Lower Cholesky factor, or false.
template <int n>
bool Cholesky(const Eigen::Matrix<double, n, n>& A, Eigen::Matrix<double, n, n>* L) {
  L->setZero();
  double trace = 0;
  for (int j = 0; j < n; ++j) {
    double d = A(j, j);
    for (int k = 0; k < j; ++k) d -= (*L)(j, k) * (*L)(j, k);
    if (!(d > 0)) return false;
    (*L)(j, j) = std::sqrt(d);
    for (int i = j + 1; i < n; ++i) {
      double a = A(i, j);
      for (int k = 0; k < j; ++k) a -= (*L)(i, k) * (*L)(j, k);
      (*L)(i, j) = a / (*L)(j, j);
    }
    trace += (*L)(j, j);
  }
  return std::isfinite(trace);
}

template <int n, typename Block>
Block ForwardSolve(const Eigen::Matrix<double, n, n>& L, Block b) {
  for (int i = 0; i < n; ++i) {
    for (int k = 0; k < i; ++k) b.row(i) -= L(i, k) * b.row(k);
    b.row(i) /= L(i, i);
  }
  return b;
}

template <int n>
Eigen::Matrix<double, n, 1> BackwardSolve(const Eigen::Matrix<double, n, n>& L,
                                          Eigen::Matrix<double, n, 1> b) {
  for (int i = n - 1; i >= 0; --i) {
    for (int k = i + 1; k < n; ++k) b[i] -= L(k, i) * b[k];
    b[i] /= L(i, i);
  }
  return b;
}

template <class V>
double Dot(const std::vector<V>& a, const std::vector<V>& b) {
  double sum = 0;
  for (size_t i = 0; i < a.size(); ++i) sum += a[i].dot(b[i]);
  return sum;
}

}  // namespace

template <int n>
Eigen::MatrixXd ChainHessian<n>::Dense() const {
  const int N = static_cast<int>(elements_.size());
  Eigen::MatrixXd H(n * N, n * N);
  for (int Q = 0; Q < N; ++Q) {
    H.block<n, n>(n * Q, n * Q) = elements_[Q].H;
    for (int P = 0; P < Q; ++P) {
      H.block<n, n>(n * Q, n * P) = elements_[Q].U * elements_[P].V.transpose();
      H.block<n, n>(n * P, n * Q) = H.block<n, n>(n * Q, n * P).transpose();
    }
  }
  return H;
}

template <int n>
bool ChainHessian<n>::Factor(double shift) {
  Matrix2d S = Matrix2d::Zero();
  for (size_t Q = 0; Q < elements_.size(); ++Q) {
    Element& element = elements_[Q];
    const Matrixn2 US = element.U * S;
    Matrix pivot = element.H - US * element.U.transpose();
    pivot.diagonal() += shift * metric_[Q];
    if (!Cholesky<n>(pivot, &element.L)) return false;
    element.V_eliminated = element.V - US;
    const Matrixn2 Y = ForwardSolve<n>(element.L, element.V_eliminated);
    S += Y.transpose() * Y;
  }
  return true;
}

template <int n>
void ChainHessian<n>::Solve(std::span<const Vector> b, std::span<Vector> x) const {
  const int N = static_cast<int>(elements_.size());
  MANE_CHECK(static_cast<int>(b.size()) == N && static_cast<int>(x.size()) == N);
  Vector2d z = Vector2d::Zero();
  for (int Q = 0; Q < N; ++Q) {
    const Element& element = elements_[Q];
    const Vector y = ForwardSolve<n>(element.L, Vector(b[Q] - element.U * z));
    x[Q] = BackwardSolve<n>(element.L, y);
    z += element.V_eliminated.transpose() * x[Q];
  }
  z.setZero();
  for (int Q = N - 1; Q >= 0; --Q) {
    const Element& element = elements_[Q];
    const Vector y = ForwardSolve<n>(element.L, Vector(element.V_eliminated * z));
    x[Q] -= BackwardSolve<n>(element.L, y);
    z += element.U.transpose() * x[Q];
  }
}

template <int n>
double ChainHessian<n>::LowestEigenvalue(std::span<Vector> mode) {
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
  // Inverse iteration about `high`, from a vector of no symmetry; the Rayleigh quotient is good to
  // the square of the mode's error.
  constexpr double kRates[] = {1.7, 2.3, 1.3, 0.9}, kPhases[] = {0.3, 1.1, 1.77, 0.7};
  std::vector<Vector> x(N), Dx(N);
  for (size_t Q = 0; Q < N; ++Q) {
    const double q = static_cast<double>(Q + 1);
    for (int i = 0; i < n; ++i) x[Q][i] = std::sin(kRates[i] * q + kPhases[i]);
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
    for (const Vector& v : x) largest = std::max(largest, v.cwiseAbs().maxCoeff());
    for (size_t Q = 0; Q < N; ++Q) mode[Q] = x[Q] / largest;
  }
  return lambda;
}

template class ChainHessian<3>;
template class ChainHessian<4>;

}  // namespace mane::rod
