#pragma once

#include <Eigen/Core>

#include <span>

namespace mane::head {

/// Walks along `curve`, a polyline of at least two points, in strides that are straight and all of
/// one length: each ends where the curve first is that far from where the stride began. Past the
/// curve's end it goes on straight on.
///
/// @param stride      [m], > 0.
/// @param directions  of the strides, unit.
/// @return strides that end on the curve, with the part of one that reached its end.
double Stride(std::span<const Eigen::Vector3f> curve, double stride,
              std::span<Eigen::Vector3d> directions);

/// The length of which `strides` lead along `curve` to its end, or next to it where none does.
///
/// @param length  of the curve's arc [m]: no stride is longer than its part of it.
[[nodiscard]] double StrideLength(std::span<const Eigen::Vector3f> curve, double length,
                                  int strides);

}  // namespace mane::head
