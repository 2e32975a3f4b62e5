#pragma once

#include <Eigen/Core>

#include <span>

namespace mane::head {

/// A place on a polyline is a number from 0 at its first point to points - 1 at its last: the whole
/// part numbers an edge, the rest is the fraction of it.

/// Finds places along `curve`, a polyline of at least two points, that are all one straight stride
/// from each other and from its begin, none past its end; the last is on the end, or nearer to it
/// than one more stride.
///
/// A stride ends where the curve first is so far from where it began. Where curls are narrower than
/// strides, these pass over some of a coil, and a little longer they would leap to its next turns:
/// no length leads to the end. Then, of lengths about that one, places are those a stride away next
/// to where equal arcs would have them, by the length that leaves least of the curve.
///
/// @param length  of the curve's arc [m], > 0: no stride is longer than its part of it.
/// @param places  one for each stride; increasing.
/// @return length of a stride [m], to 1e-5 of it.
double Stride(std::span<const Eigen::Vector3f> curve, double length, std::span<double> places);

/// Directions from the begin of `curve` to the first place, and from place to place, unit.
///
/// @param directions  (places). Where two places are one point, as that before, or +Y.
void Between(std::span<const Eigen::Vector3f> curve, std::span<const double> places,
             std::span<Eigen::Vector3d> directions);

}  // namespace mane::head
