#pragma once

/// Small vectors and matrices whose entries are lanes; only for sources that define MANE_ISA.

#include "simd/lanes.h"

namespace mane::simd {
namespace MANE_ISA {

template <typename V>
struct Vector {
  V x, y, z;

  friend Vector operator+(const Vector& a, const Vector& b) {
    return {a.x + b.x, a.y + b.y, a.z + b.z};
  }
  friend Vector operator-(const Vector& a, const Vector& b) {
    return {a.x - b.x, a.y - b.y, a.z - b.z};
  }
  friend Vector operator-(const Vector& a) { return {-a.x, -a.y, -a.z}; }
  friend Vector operator*(const V& s, const Vector& a) { return {s * a.x, s * a.y, s * a.z}; }
  Vector& operator+=(const Vector& a) { return *this = *this + a; }
  Vector& operator-=(const Vector& a) { return *this = *this - a; }
};

template <typename V>
V Dot(const Vector<V>& a, const Vector<V>& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}

template <typename V>
Vector<V> Cross(const Vector<V>& a, const Vector<V>& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

/// Component by component.
template <typename V>
Vector<V> Times(const Vector<V>& a, const Vector<V>& b) {
  return {a.x * b.x, a.y * b.y, a.z * b.z};
}

/// `a` where `mask` holds, else `b`.
template <typename M, typename V>
Vector<V> Select(const M& mask, const Vector<V>& a, const Vector<V>& b) {
  return {mask ? a.x : b.x, mask ? a.y : b.y, mask ? a.z : b.z};
}

/// A 3 x 3 matrix by its columns.
template <typename V>
struct Frame {
  Vector<V> n0, n1, n2;

  friend Vector<V> operator*(const Frame& R, const Vector<V>& a) {
    return a.x * R.n0 + a.y * R.n1 + a.z * R.n2;
  }
};

template <typename V>
Vector<V> TransposeTimes(const Frame<V>& R, const Vector<V>& a) {
  return {Dot(R.n0, a), Dot(R.n1, a), Dot(R.n2, a)};
}

/// A 3 x 3 matrix by its rows.
template <typename V>
struct Matrix {
  Vector<V> x, y, z;

  friend Vector<V> operator*(const Matrix& A, const Vector<V>& a) {
    return {Dot(A.x, a), Dot(A.y, a), Dot(A.z, a)};
  }
  friend Matrix operator-(const Matrix& a, const Matrix& b) {
    return {a.x - b.x, a.y - b.y, a.z - b.z};
  }
  Matrix& operator+=(const Matrix& a) {
    x += a.x, y += a.y, z += a.z;
    return *this;
  }
  Matrix& operator-=(const Matrix& a) {
    x -= a.x, y -= a.y, z -= a.z;
    return *this;
  }
};

template <typename V>
Vector<V> TransposeTimes(const Matrix<V>& A, const Vector<V>& a) {
  return a.x * A.x + a.y * A.y + a.z * A.z;
}

/// [a], the matrix of a x.
template <typename V>
Matrix<V> CrossMatrix(const Vector<V>& a) {
  return {{V{}, -a.z, a.y}, {a.z, V{}, -a.x}, {-a.y, a.x, V{}}};
}

template <typename V>
struct Symmetric {
  V xx, xy, xz, yy, yz, zz;

  friend Vector<V> operator*(const Symmetric& A, const Vector<V>& a) {
    return {A.xx * a.x + A.xy * a.y + A.xz * a.z, A.xy * a.x + A.yy * a.y + A.yz * a.z,
            A.xz * a.x + A.yz * a.y + A.zz * a.z};
  }
  friend Symmetric operator*(const V& s, const Symmetric& A) {
    return {s * A.xx, s * A.xy, s * A.xz, s * A.yy, s * A.yz, s * A.zz};
  }
  Symmetric& operator+=(const Symmetric& a) {
    xx += a.xx, xy += a.xy, xz += a.xz, yy += a.yy, yz += a.yz, zz += a.zz;
    return *this;
  }
};

/// A += a b^T, where that is symmetric.
template <typename V>
[[gnu::always_inline]] inline void AddOuter(Symmetric<V>& A, const Vector<V>& a,
                                            const Vector<V>& b) {
  A.xx += a.x * b.x, A.xy += a.x * b.y, A.xz += a.x * b.z;
  A.yy += a.y * b.y, A.yz += a.y * b.z, A.zz += a.z * b.z;
}

/// A += a b^T + b a^T.
template <typename V>
[[gnu::always_inline]] inline void AddTwice(Symmetric<V>& A, const Vector<V>& a,
                                            const Vector<V>& b) {
  A.xx += (a.x + a.x) * b.x, A.xy += a.x * b.y + a.y * b.x, A.xz += a.x * b.z + a.z * b.x;
  A.yy += (a.y + a.y) * b.y, A.yz += a.y * b.z + a.z * b.y, A.zz += (a.z + a.z) * b.z;
}

/// A += a b^T.
template <typename V>
[[gnu::always_inline]] inline void AddOuter(Matrix<V>& A, const Vector<V>& a, const Vector<V>& b) {
  A.x += a.x * b, A.y += a.y * b, A.z += a.z * b;
}

/// A += [a] + s 1.
template <typename V>
[[gnu::always_inline]] inline void AddCrossMatrix(Matrix<V>& A, const Vector<V>& a, const V& s) {
  A.x.x += s, A.x.y -= a.z, A.x.z += a.y;
  A.y.x += a.z, A.y.y += s, A.y.z -= a.x;
  A.z.x -= a.y, A.z.y += a.x, A.z.z += s;
}

/// S -= A^T B, where that is symmetric.
template <typename V>
[[gnu::always_inline]] inline void SubtractProduct(Symmetric<V>& S, const Matrix<V>& A,
                                                   const Matrix<V>& B) {
  S.xx -= A.x.x * B.x.x + A.y.x * B.y.x + A.z.x * B.z.x;
  S.xy -= A.x.x * B.x.y + A.y.x * B.y.y + A.z.x * B.z.y;
  S.xz -= A.x.x * B.x.z + A.y.x * B.y.z + A.z.x * B.z.z;
  S.yy -= A.x.y * B.x.y + A.y.y * B.y.y + A.z.y * B.z.y;
  S.yz -= A.x.y * B.x.z + A.y.y * B.y.z + A.z.y * B.z.z;
  S.zz -= A.x.z * B.x.z + A.y.z * B.y.z + A.z.z * B.z.z;
}

/// S -= A^T B.
template <typename V>
[[gnu::always_inline]] inline void SubtractProduct(Matrix<V>& S, const Matrix<V>& A,
                                                   const Matrix<V>& B) {
  S.x -= A.x.x * B.x + A.y.x * B.y + A.z.x * B.z;
  S.y -= A.x.y * B.x + A.y.y * B.y + A.z.y * B.z;
  S.z -= A.x.z * B.x + A.y.z * B.y + A.z.z * B.z;
}

/// A += trace(S) 1 - S, the rotational inertia of the second moments S.
template <typename V>
[[gnu::always_inline]] inline void AddInertiaOf(Symmetric<V>& A, const Symmetric<V>& S) {
  A.xx += S.yy + S.zz, A.yy += S.xx + S.zz, A.zz += S.xx + S.yy;
  A.xy -= S.xy, A.xz -= S.xz, A.yz -= S.yz;
}

/// A [d].
template <typename V>
[[gnu::always_inline]] inline Matrix<V> TimesCross(const Symmetric<V>& A, const Vector<V>& d) {
  const auto row = [&](const V& x, const V& y, const V& z) { return Cross(Vector<V>{x, y, z}, d); };
  return {row(A.xx, A.xy, A.xz), row(A.xy, A.yy, A.yz), row(A.xz, A.yz, A.zz)};
}

/// A += [d] Y - B^T [d], symmetric where Y = B - S [d] for a symmetric S.
template <typename V>
[[gnu::always_inline]] inline void AddCongruence(Symmetric<V>& A, const Matrix<V>& B,
                                                 const Matrix<V>& Y, const Vector<V>& d) {
  // [d] Y by rows: d x the columns of Y.
  // B^T [d] by rows: the columns of B, each x d.
  A.xx += d.y * Y.z.x - d.z * Y.y.x - (B.y.x * d.z - B.z.x * d.y);
  A.xy += d.y * Y.z.y - d.z * Y.y.y - (B.z.x * d.x - B.x.x * d.z);
  A.xz += d.y * Y.z.z - d.z * Y.y.z - (B.x.x * d.y - B.y.x * d.x);
  A.yy += d.z * Y.x.y - d.x * Y.z.y - (B.z.y * d.x - B.x.y * d.z);
  A.yz += d.z * Y.x.z - d.x * Y.z.z - (B.x.y * d.y - B.y.y * d.x);
  A.zz += d.x * Y.y.z - d.y * Y.x.z - (B.x.z * d.y - B.y.z * d.x);
}

/// A lower triangular 3 x 3 matrix with ones on its diagonal.
template <typename V>
struct Lower {
  V l10, l20, l21;

  /// L^-1 a, in place; of a matrix, each column's.
  void Forward(Vector<V>& a) const {
    a.y -= l10 * a.x;
    a.z -= l20 * a.x + l21 * a.y;
  }
  void Forward(Matrix<V>& A) const {
    A.y -= l10 * A.x;
    A.z -= l20 * A.x + l21 * A.y;
  }
  /// L^-T a.
  [[nodiscard]] Vector<V> Backward(const Vector<V>& a) const {
    const V y = a.y - l21 * a.z;
    return {a.x - l10 * y - l20 * a.z, y, a.z};
  }
};

/// L D L^T of a positive definite 3 x 3 matrix.
template <typename V>
struct Factor {
  Vector<V> inverse;  // 1 / D
  Lower<V> L;

  /// No pivot is taken below `smallest` of the trace, what rounding leaves of it at best: A is
  /// positive definite, but need not be so in rounded numbers.
  Factor(const Symmetric<V>& A, const V& smallest) {
    const V one = V{} + 1, least = smallest * (A.xx + A.yy + A.zz);
    const auto pivot = [&](const V& d) { return one / (d > least ? d : least); };
    inverse.x = pivot(A.xx);
    L.l10 = A.xy * inverse.x;
    L.l20 = A.xz * inverse.x;
    const V t = A.yz - L.l10 * A.xz;
    inverse.y = pivot(A.yy - L.l10 * A.xy);
    L.l21 = t * inverse.y;
    inverse.z = pivot(A.zz - L.l20 * A.xz - L.l21 * t);
  }

  /// D^-1 a.
  [[nodiscard]] Vector<V> OverD(const Vector<V>& a) const { return Times(inverse, a); }
  [[nodiscard]] Matrix<V> OverD(const Matrix<V>& A) const {
    return {inverse.x * A.x, inverse.y * A.y, inverse.z * A.z};
  }
};

}  // namespace MANE_ISA
}  // namespace mane::simd
