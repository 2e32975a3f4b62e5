#pragma once

#include <Eigen/Core>

#include "simd/rows.h"

/// How vectors get into the numbers of kernels, and out of them.
namespace mane::beam {

template <typename T>
void Fill(const Eigen::Vector3d& v, T (&numbers)[3]) {
  for (int j = 0; j < 3; ++j) numbers[j] = static_cast<T>(v[j]);
}

/// By rows.
template <typename T>
void Fill(const Eigen::Matrix3d& M, T (&numbers)[9]) {
  for (int j = 0; j < 9; ++j) numbers[j] = static_cast<T>(M(j / 3, j % 3));
}

/// One lane of three rows.
template <typename T>
void SetLane(const Eigen::Vector3d& v, int lane, simd::Row<T>* rows) {
  for (int j = 0; j < 3; ++j) rows[j].lane[lane] = static_cast<T>(v[j]);
}
template <typename T>
[[nodiscard]] Eigen::Vector3d VectorAt(const simd::Row<T>* rows, int lane) {
  return {static_cast<double>(rows[0].lane[lane]), static_cast<double>(rows[1].lane[lane]),
          static_cast<double>(rows[2].lane[lane])};
}

}  // namespace mane::beam
