#include "head/beam_follow.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "math/rigid.h"
#include "rod/coil_element.h"

namespace mane::head {
namespace {

using Eigen::Quaterniond;
using Eigen::Vector3d;

// The rotation vector of `q` that is nearest to `near`: hair may wind by more than half a turn.
Vector3d RotationNear(const Quaterniond& q, const Vector3d& near) {
  const Vector3d shortest = math::RotationVector(q);
  const double angle = shortest.norm();
  const Vector3d axis =
      angle > 1e-9 ? Vector3d(shortest / angle)
                   : (near.norm() > 1e-9 ? Vector3d(near.normalized()) : Vector3d::UnitX());
  const double turns = std::round((near.dot(axis) - angle) / (2 * std::numbers::pi));
  return (angle + 2 * std::numbers::pi * turns) * axis;
}

// An element bends by at most this [rad] more than at rest: kinks of a beam are more than a rod
// could stand.
constexpr double kLargestBend = 0.6;

// The rotation that takes `from` to `to`, or part of the way there.
Quaterniond Toward(const Vector3d& from, const Vector3d& to) {
  const Vector3d turn = math::RotationVector(Quaterniond::FromTwoVectors(from, to));
  const double angle = turn.norm();
  return math::FromRotationVector(angle > kLargestBend ? Vector3d(kLargestBend / angle * turn)
                                                       : turn);
}

// What turns segments from their rest directions, the least way.
void TurnsOf(std::span<const Vector3d> rest, std::span<const Vector3d> now,
             std::vector<Quaterniond>* turns) {
  turns->resize(rest.size());
  for (size_t i = 0; i < rest.size(); ++i) {
    (*turns)[i] = Quaterniond::FromTwoVectors(rest[i], now[i]);
  }
}

// The turn at a fraction of the beam, between those of the middles of segments.
Quaterniond TurnAt(std::span<const Quaterniond> turns, double fraction) {
  const auto last = static_cast<double>(turns.size() - 1);
  const double x = std::clamp(fraction * static_cast<double>(turns.size()) - 0.5, 0.0, last);
  const auto i = std::min(static_cast<size_t>(x), turns.size() - 1);
  const size_t next = std::min(i + 1, turns.size() - 1);
  return turns[i].slerp(x - static_cast<double>(i), turns[next]);
}

}  // namespace

void FollowBeam(const groom::Groom& groom, const Beams& beams, int guide,
                std::span<const Vector3d> directions, std::span<double> coordinates) {
  thread_local std::vector<Quaterniond> turns;
  TurnsOf(beams.rest_of(guide), directions, &turns);
  const groom::Guide& own = groom.guides[guide];
  const rod::Strand& strand = own.strand;
  const int width = own.wound ? 4 : 3;
  std::copy_n(&beams.coordinates[groom.first_coordinate[guide]], coordinates.size(),
              coordinates.begin());
  Quaterniond rest = own.root.q;  // The element's left frame at rest, and as it is now.
  if (own.wound) rest = rest * Quaterniond(own.wound->coil[0].F);
  Quaterniond now = rest;
  const double L = strand.TotalLength();
  double s = 0;
  for (int Q = 0; Q < strand.elements(); ++Q) {
    double* const x = &coordinates[static_cast<size_t>(Q) * width];
    s += strand.length[Q];
    const Vector3d angles = own.wound ? rod::AxisOfElement(own.wound->coil[Q], strand.length[Q],
                                                           Eigen::Map<const rod::Vector4d>(x))
                                            .beta
                                      : Vector3d(Eigen::Map<const Vector3d>(x));
    const Quaterniond turn = math::FromRotationVector(angles);
    rest = (rest * turn).normalized();
    const Quaterniond straight = now * turn;  // Where the element at rest would lead from here.
    const Vector3d wanted = TurnAt(turns, s / L) * (rest * Vector3d::UnitX());
    const Quaterniond end = Toward(straight * Vector3d::UnitX(), wanted) * straight;
    Vector3d bent = RotationNear(now.conjugate() * end, angles);
    bent[0] = angles[0];
    now = (now * math::FromRotationVector(bent)).normalized();
    for (int i = own.wound ? 1 : 0; i < 3; ++i) x[i] = bent[i];
  }
}

}  // namespace mane::head
