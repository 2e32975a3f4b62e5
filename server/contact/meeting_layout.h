#pragma once

/// How the points of a block of strands that meet bodies lie in memory for the batched kernels:
/// rows of rod::layout::kLanes float32 numbers, one lane a strand. Includes nothing: kernels may
/// share no function with other sources. K-numbers are those of contact.md.
namespace mane::contact {

/// Rows of what was last seen of a group of bodies from a point (K7).
enum Seen : int {
  kSeenAt = 0,                      ///< Where the point was, group's frame [m] (3).
  kSeenNormal = kSeenAt + 3,        ///< Out of the nearest body, group's frame (3).
  kSeenDistance = kSeenNormal + 3,  ///< To its surface [m].
  kSeenFriction,                    ///< How hair rubs on it: Friction::coefficient,
  kSeenAnisotropy,                  ///< Friction::anisotropy.
  kSeenRows                         ///< Rows in all.
};

/// Rows of how a point touched at the end of a step.
enum Touch : int {
  kTouched = 0,           ///< Its normal impulse (K8), negative where it slid.
  kDrift = kTouched + 1,  ///< How far it has crept since it is held, or would have to be drawn back
                          ///< as it is rubbed where it slides, world [m] (3) (K12).
  kTouchRows = kDrift + 3  ///< Rows in all.
};

/// Rows of a point and the nearest body in a step.
enum Meeting : int {
  kDistance = 0,                 ///< To its surface [m]; large where it is too far to matter.
  kMeetNormal = kDistance + 1,   ///< World (3).
  kSurface = kMeetNormal + 3,    ///< The body's velocity there, world [m/s] (3).
  kMeetFriction = kSurface + 3,  ///< Friction::coefficient.
  kMeetAnisotropy,               ///< Friction::anisotropy.
  kRoom,    ///< Half of what another body across leaves between the two (K13) [m].
  kMiddle,  ///< Of the way to the next point where a body turns sharply there (K14): distance [m],
            ///< large where nobody asks;
  kMiddleNormal = kMiddle + 1,         ///< the way out there for both points, world (3);
  kMiddleSurface = kMiddleNormal + 3,  ///< the body's velocity, world [m/s] (3).
  kMass = kMiddleSurface + 3,  ///< That the point stands for [rho S l0]; 0 where it meets nothing.
  kLeast,                      ///< v of (K2) [m/s].
  kStiff,      ///< What keeps it from going on, per speed that it lacks (K2) [rho S l0]; 0 where
               ///< nothing,
  kStopSpeed,  ///< and the speed that it lacks it to: v, or the body's own (K8) [m/s].
  kLift,       ///< What lifts it out, per speed that it lacks (K9) [rho S l0],
  kLiftSpeed,  ///< and to which speed along the normal [m/s].
  kRub,        ///< +1 where it is held across, -1 where it slides, 0 where it touches nothing.
  kDrawn,      ///< Velocity over the surface that takes back kDrift (K12) [m/s] (3).
  kMeetingRows = kDrawn + 3  ///< Rows in all.
};

/// How a group of bodies moves in a step: where its frame is at kTheta of the way, from the head's
/// place, in world axes, and how it goes on.
struct GroupMotion {
  float frame[9];     ///< Columns: from the group's frame to the world's axes.
  float position[3];  ///< [m]
  float velocity[3];  ///< Of the frame's origin [m/s].
  float spin[3];      ///< [rad/s]
};

/// Numbers of a step that all points share.
struct MeetingNumbers {
  float h;               ///< kTheta dt [s].
  float dt;              ///< [s]
  float thickness;       ///< Strands' centrelines keep this far from surfaces [m].
  float root_length;     ///< The first of a strand is not looked at [m].
  float recovery_speed;  ///< v_r of (K9) [m/s], and
  float recovery_pull;   ///< a_r [m/s^2].
  float surprise;        ///< How far strands may move in dt besides what they did before [m].
};

/// A block of strands and its points.
struct MeetingBlock {
  int elements;
  const int* first_point;  ///< Of each element, and how many there are (N + 1).
  bool wound;
  const float* constants;  ///< rod/batch_layout.h
  const float* points;     ///< rod::layout::Point rows.
  float* meetings;         ///< (points x kMeetingRows)
  float* loads;            ///< rod::layout::Load rows.
  unsigned char* loaded;   ///< (points)
  unsigned char* watched;  ///< Whether any lane is near a body; others are left alone (points).
};

/// The kernels of one instruction set; pure functions of their arguments, each lane's result
/// depends on nothing in others.
struct MeetingKernels {
  /// Points in the group's frame, and where they must be looked at anew (K7).
  ///
  /// @param local  out: (points x 3)
  /// @param stale  out: 1 or 0 (points)
  /// @param any_stale  in: 0; out: whether any lane is (points)
  /// @return whether any is stale.
  bool (*look)(int points, const float* point_rows, const GroupMotion& group,
               const MeetingNumbers& numbers, const float* seen, float* local, float* stale,
               unsigned char* any_stale);
  /// Joins the group with those before (K13); the first sets all.
  void (*meet)(int points, const float* point_rows, const GroupMotion& group, const float* seen,
               const float* local, bool first, float* meetings);
  /// Where the group turns so sharply between a point and the next that it must be looked at there,
  /// too (K14).
  ///
  /// @param local  as of look. @param places  out: group's frame (points x 3)
  /// @param sharp  out: 1 or 0 (points)
  /// @param any_sharp  in: 0; out: whether any lane is (points)
  /// @return whether any is.
  bool (*between)(int points, const float* point_rows, const GroupMotion& group, const float* seen,
                  const float* local, float* places, float* sharp, unsigned char* any_sharp);
  /// Loads of the first solution (K8). `touched`, (points x kTouchRows), is what Finish left a step
  /// ago. @return whether there are any.
  bool (*begin)(const MeetingBlock& block, const MeetingNumbers& numbers, const float* touched);
  /// Loads of the second, by the velocities of the first. @return whether any differ.
  bool (*revise)(const MeetingBlock& block, const float* velocities);
  /// Resists where a spring pulled, stops what falls (K8), and leaves in `touched` what the last
  /// solution says of it. @param last  whether there is but one more solution. @return whether any
  /// must be solved again.
  bool (*finish)(const MeetingBlock& block, const float* velocities, const MeetingNumbers& numbers,
                 bool last, float* touched);
};

}  // namespace mane::contact
