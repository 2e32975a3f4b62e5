#pragma once

/// L D L^T of small positive definite matrices, lane by lane; only for sources that define
/// MANE_ISA.

#include "rod/batch_rows.h"

namespace mane::rod {
namespace MANE_ISA {

/// A lower triangular n x n matrix with ones on its diagonal.
template <typename V, int n>
struct LowerOf {
  V l[n][n];  ///< Below the diagonal.

  /// L^-1 a, in place; a holds numbers or rows of a matrix.
  template <typename Row>
  [[gnu::always_inline]] void Forward(Row (&a)[n]) const {
#pragma GCC unroll 4
    for (int i = 1; i < n; ++i) {
#pragma GCC unroll 4
      for (int j = 0; j < i; ++j) a[i] -= l[i][j] * a[j];
    }
  }
  /// L^-T a, in place.
  [[gnu::always_inline]] void Backward(V (&a)[n]) const {
#pragma GCC unroll 4
    for (int i = n - 2; i >= 0; --i) {
#pragma GCC unroll 4
      for (int j = i + 1; j < n; ++j) a[i] -= l[j][i] * a[j];
    }
  }
};

template <typename V, int n>
struct FactorOf {
  V inverse[n];  ///< 1 / D
  LowerOf<V, n> L;

  /// Of the matrix whose lower triangle is A. No pivot is taken below `smallest` of the trace, what
  /// rounding leaves of it at best: A is positive definite, but need not be so in rounded numbers.
  [[gnu::always_inline]] FactorOf(const V (&A)[n][n], const V& smallest) {
    const V one = V{} + 1;
    V least{};
#pragma GCC unroll 4
    for (int i = 0; i < n; ++i) least += A[i][i];
    least *= smallest;
#pragma GCC unroll 4
    for (int j = 0; j < n; ++j) {
      V column[n];  // D_j L_ij
#pragma GCC unroll 4
      for (int i = j; i < n; ++i) {
        column[i] = A[i][j];
#pragma GCC unroll 4
        for (int k = 0; k < j; ++k) column[i] -= L.l[i][k] * scaled_[j][k];
      }
      inverse[j] = one / (column[j] > least ? column[j] : least);
#pragma GCC unroll 4
      for (int i = j + 1; i < n; ++i) {
        scaled_[i][j] = column[i];
        L.l[i][j] = column[i] * inverse[j];
      }
    }
  }

 private:
  V scaled_[n][n];  // L D
};

}  // namespace MANE_ISA
}  // namespace mane::rod
