#pragma once

#include <string>
#include <vector>

#include "mane/client.h"

namespace mane::client_test {

/// A wavy strand of human hair, 20 cm in 5 elements, that leaves its root sideways.
Guide WavyGuide();

/// `count` such strands around a head, unequal in length and number of elements.
GroomUpload WavyGroom(int count);

/// A motion without end: the head nods, turns and sways. `time_s` from 0.
Pose MotionAt(double time_s);

/// Uploads the groom; its name. Throws on an error.
std::string Create(Client& client, const GroomUpload& upload);

/// Why `frame` is not a sound picture of `upload` in the world; empty when it is: numbers finite,
/// roots on the moved head, neighbouring points no farther apart than their arc length. Tolerances
/// are `slack` [m] for rounding.
std::string Fault(const Frame& frame, const GroomUpload& upload, double slack = 1e-5);

/// `pose` applied to a point of its frame, and its inverse.
Vector3 Apply(const Pose& pose, const Vector3& local);
Vector3 ApplyInverse(const Pose& pose, const Vector3& outer);

/// Point `point` of guide `guide`.
Vector3 PointOf(const Frame& frame, std::uint32_t guide, std::uint32_t point);
double Distance(const Vector3& a, const Vector3& b);

}  // namespace mane::client_test
