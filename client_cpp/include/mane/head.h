#pragma once

#include <chrono>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "mane/bodies.h"
#include "mane/error.h"
#include "mane/geometry.h"

namespace mane::inline client {

/// How simulated time passes.
enum class Pacing {
  /// The server's clock ticks at `HeadOptions::rate_hz`; the newest frame wins, nothing queues.
  kRealtime = 1,
  /// Every pose yields exactly one frame: same messages, same bits.
  kLockstep = 2,
};

/// How frames travel. Head rebuilds positions from any of them.
enum class FrameFormat {
  kPositionsFloat32 = 1,      ///< 12 bytes a point.
  kPositionsQuantized16 = 2,  ///< 6 bytes a point; error at most 1/131070 of the strand's box.
  kGeneralized = 3,  ///< 12 or, of wound strands, 16 bytes an element; rebuilt here, exactly.
};

enum class Space {
  kWorld = 1,
  kHead = 2,  ///< Relative to `Frame::head_pose`.
};

/// How the guides of a head are animated. A change between the two makes no jump.
enum class AnimationModel {
  kSuperHelix = 1,  ///< Elastic rods that meet the groom's bodies.
  /// Polylines whose segments swing each on its own, a level of detail below, at a fraction of the
  /// cost. They keep the nodes of the rest shape and stay out of an ellipsoid that stands for the
  /// scalp; of other bodies and of wisps they know nothing. kGeneralized cannot show them.
  kBeam = 2,
};

/// Along which angles a segment of a beam turns.
enum class BeamEquations {
  kAcross = 1,  ///< About an axis across the segment, chosen anew every step.
  kPolar = 2,   ///< Zenith and azimuth about Y, as published.
};

/// What beams of a head are like. What is unset is the server's default.
struct BeamMotion {
  /// Of every guide, all of one length, 2 to 64; 0 means as many as arrays by segment have numbers,
  /// else one for each radian that guides turn by at rest, but 16 to 64.
  std::uint32_t segments = 0;
  /// Factor on what holds segments in their directions at rest, 0 to 1000; 1. 0 is as published.
  std::optional<double> hold = std::nullopt;
  BeamEquations equations = BeamEquations::kAcross;
  bool unbounded = false;  ///< Recurrences as published, stable only while forces are small.
  std::optional<bool> clamped = std::nullopt;  ///< The first segment keeps its direction; true.
  /// Nodes are turned out of the ellipsoid that stands for the scalp; true.
  std::optional<bool> avoid_head = std::nullopt;
  /// Forces that press hair on the head count less near it: where the cosine of their angle with
  /// the outward normal is below `alpha` (-1 to 1; -0.75) and the segment is nearer than `near_m`
  /// [m] (0 to 10; 0.02), they count `epsilon` times (0 to 1, by segment; empty for 1).
  std::optional<double> alpha = std::nullopt;
  std::optional<double> near_m = std::nullopt;
  std::vector<float> epsilon = {};
  std::vector<float> largest_turn_rad = {};  ///< At each joint, 0 to pi, by segment; empty for pi.
  double fluctuation_rad = 0;                ///< Turns drawn every ten time steps, 0 to 1.
  std::uint64_t seed = 0;                    ///< Of what is drawn.
  /// What accelerates the last segment, per acceleration of the field it is in [1/m], 1e-3 to 1e4.
  std::optional<double> tip_response = std::nullopt;
};

/// What surrounds the hair. Unset fields stay as they are.
struct Environment {
  /// Mean air velocity, world [m/s], each component within ±100.
  std::optional<Vector3> wind_velocity = std::nullopt;
  /// World [m/s^2], each within ±1000; first (0, -9.81, 0).
  std::optional<Vector3> gravity = std::nullopt;
  /// Factors on every guide's own number, 0 to 1000; first 1.
  std::optional<double> internal_friction_scale = std::nullopt;
  std::optional<double> air_drag_scale = std::nullopt;
  /// Gusts: rms of the relative change of the mean wind's speed, 0 to 2, first 0; their middle
  /// period [s], 0.1 to 100, first 2.
  std::optional<double> gust_strength = std::nullopt;
  std::optional<double> gust_period_s = std::nullopt;
  /// Eddies: rms speed [m/s], 0 to 50, first 0; their middle size [m], 0.01 to 100, first 0.3.
  std::optional<double> turbulence_speed = std::nullopt;
  std::optional<double> turbulence_size_m = std::nullopt;
  /// Decides gusts and eddies; first 0.
  std::optional<std::uint64_t> wind_seed = std::nullopt;
  /// How far tips may be off [m], 0 to 10, where hair that hardly bends is computed with fewer
  /// elements, without a jump; first 0, for all elements. For heads far away.
  std::optional<double> detail_tolerance_m = std::nullopt;
};

/// How to animate a head. Zeros let the server choose.
struct HeadOptions {
  std::string groom = {};  ///< `grooms/{groom}`
  Pacing pacing = Pacing::kRealtime;
  FrameFormat format = FrameFormat::kPositionsFloat32;
  Space space = Space::kWorld;
  std::uint32_t points_per_guide = 0;  ///< Points at equal arc length, 2 to 256; 0 means 16.
  double rate_hz = 0;                  ///< kRealtime frames per second, 1 to 240; 0 means 60.
  std::uint32_t substeps = 0;          ///< Time steps per frame, 1 to 64; 0 means 1.
  /// kRealtime: how far behind the newest pose the head is shown [s], 0 to 0.25. One pose interval
  /// makes every frame an interpolation; 0 extrapolates.
  double pose_delay_s = 0;
  std::uint32_t max_unacked_frames = 0;  ///< kRealtime: frames on their way, 1 to 16; 0 means 3.
  Pose initial_pose = {};                ///< Where the head is before the first pose.
  Environment environment = {};
  /// Every frame carries them, but those of beams; costs some sixteen time steps a frame.
  bool diagnostics = false;
  AnimationModel model = AnimationModel::kSuperHelix;  ///< At first.
  BeamMotion beam = {};  ///< What beams are like, then or once the head is changed to them.
  /// kRealtime: whether the server may animate the head as kBeam while its frames come late.
  bool may_shed = false;

  /// kRealtime: how long a broken stream is retried before the head closes. Pauses between tries
  /// grow from 50 ms to 2 s.
  std::chrono::milliseconds reconnect_timeout{60'000};
  /// kLockstep: how long Step() waits for its frame.
  std::chrono::milliseconds step_timeout{10'000};
};

/// What the hair of a head holds at one moment, sums over its guides.
struct Diagnostics {
  double kinetic_energy_j = 0;
  double elastic_energy_j = 0;   ///< 0 in the natural shape.
  double gravity_energy_j = 0;   ///< Of weight; 0 where every point lies as high as its root.
  double largest_angle_rad = 0;  ///< Of an element: twist and bends together.
  /// Of the guide furthest from static equilibrium: the largest moment of weight and elasticity
  /// that is left about any axis of any element, over the largest of: what its weight can exert,
  /// rho S |g| L^2 / 2; what its natural shape takes, (EI)_i |kappa^n_i|; the smallest (EI)_i / L.
  /// At rest as small as the rounding of float32 angles.
  double imbalance = 0;
};

/// One frame of hair. Immutable once published; keep it as long as you like.
struct Frame {
  std::uint64_t index = 0;  ///< 1, 2, 3 ...; gaps were skipped. Starts anew if the head had to.
  double time_s = 0;        ///< Your clock: the moment of the head pose that this frame shows.
  Pose head_pose;           ///< Where the roots are clamped.
  std::uint32_t guide_count = 0;
  std::uint32_t points_per_guide = 0;
  std::vector<float> positions;  ///< [m] in the chosen space, (guide, point, 3), root first.
  /// kGeneralized only: the strands' coordinates [rad], guide by guide, root first. Of a guide of
  /// StrandModel::kSuperHelix (element, 3): twist, bend 1, bend 2. Of a kWound one (element, 4):
  /// what the coil is twisted by, how its axis bends about two axes across, what the hair's strain
  /// gains towards its tangent, which stretches the coil; each over the element's length.
  std::vector<float> angles;
  std::uint32_t skipped = 0;           ///< Frames that newer ones replaced since the last one sent.
  double newest_pose_time_s = 0;       ///< Your clock: the newest pose known when it was computed.
  double step_ms = 0;                  ///< Time the server spent on computing it.
  std::uint32_t repaired_guides = 0;   ///< Guides put back to rest; above 0 is a server fault.
  std::uint32_t stepped_elements = 0;  ///< Computed with, of all guides (detail_tolerance_m).
  AnimationModel model = AnimationModel::kSuperHelix;  ///< With which it was computed.
  std::optional<Diagnostics> diagnostics = {};  ///< Where HeadOptions::diagnostics asked for them.
};

enum class HeadState {
  kConnecting,    ///< Not open yet.
  kStreaming,     ///< Poses go out, frames come in.
  kReconnecting,  ///< The stream broke; it is being resumed. Poses are kept, newest wins.
  kClosed,        ///< For good: by Close(), or with HeadStatus::error.
};

struct HeadStatus {
  HeadState state = HeadState::kConnecting;
  std::optional<Error> error;    ///< Why it closed, or why it is reconnecting.
  std::uint32_t resumes = 0;     ///< Times that a broken stream went on without a jump.
  std::uint32_t reopenings = 0;  ///< Times that the server had lost the head: hair starts at rest.
  std::uint64_t missed_deadlines = 0;  ///< Of the server, by its own count.
  bool server_draining = false;        ///< The server announced that it is about to stop.
};

class HeadStream;

/// One animated head, for a game loop.
///
/// Every method may be called from any thread. None but Step(), StepTeleport(),
/// WaitUntilStreaming(), Close() and the destructor ever waits for the network. Frames that were
/// taken are acknowledged to the server by themselves, with the next message or shortly after. In
/// kRealtime a broken stream (UNAVAILABLE, CANCELLED, UNKNOWN) is resumed by itself; when the
/// server no longer knows the head, it is opened anew at the newest pose. A reset or teleport that
/// was on its way when the stream broke may be lost. In kLockstep any error closes the head.
class Head {
 public:
  Head(Head&&) noexcept;
  Head& operator=(Head&&) noexcept;
  ~Head();  ///< Close().

  /// Waits until the head is streaming. Its error when it closed instead, kDeadlineExceeded when
  /// `timeout` passed (it keeps trying).
  Result<void> WaitUntilStreaming(std::chrono::milliseconds timeout);

  /// kRealtime: moves the head. Replaces a pose that is not sent yet.
  /// @param time_s  your clock [s], any origin; must increase from pose to pose.
  /// @param bodies  where moving bodies of the groom are then. One that is left out stays where it
  ///                last was in the world; one that never was given moves along with the head.
  /// @return kInvalidArgument (`time_s`) for a time that does not increase, kFailedPrecondition in
  ///         kLockstep, the closing error when closed. Other faults of the pose are found by the
  ///         server and close the head.
  Result<void> PushPose(double time_s, const Pose& pose, const std::vector<BodyPose>& bodies = {});

  /// kRealtime: moves head and hair together without dynamics, as a cut in a film does;
  /// bodies are where it says at once. Errors as PushPose().
  Result<void> Teleport(double time_s, const Pose& pose, const std::vector<BodyPose>& bodies = {});

  /// Puts the hair to its rest shape with no velocity, from the next frame on.
  Result<void> Reset();

  /// Changes what surrounds the hair from the next step on.
  Result<void> SetEnvironment(const Environment& environment);

  /// Changes how the hair is animated from the next step on; `beam` unset leaves beams as they are.
  /// Where the server has no room the head keeps its model, as Frame::model tells.
  Result<void> SetModel(AnimationModel model, const std::optional<BeamMotion>& beam = {});

  /// kRealtime: the newest frame; null before the first, and the same one until the next arrives.
  std::shared_ptr<const Frame> NewestFrame();

  /// kLockstep: sends one pose and waits for its frame, at most HeadOptions::step_timeout, which
  /// closes the head, for its state would be unknown. Errors otherwise as PushPose().
  Result<std::shared_ptr<const Frame>> Step(double time_s, const Pose& pose,
                                            const std::vector<BodyPose>& bodies = {});

  /// kLockstep: Teleport() and its frame.
  Result<std::shared_ptr<const Frame>> StepTeleport(double time_s, const Pose& pose,
                                                    const std::vector<BodyPose>& bodies = {});

  HeadStatus Status() const;

  /// Ends the stream; the server frees the head. Returns within a fraction of a second even when
  /// the server is gone. Later calls of other methods return kFailedPrecondition.
  void Close();

 private:
  friend class Client;
  explicit Head(std::shared_ptr<HeadStream> stream);

  std::shared_ptr<HeadStream> stream_;
};

}  // namespace mane::inline client
