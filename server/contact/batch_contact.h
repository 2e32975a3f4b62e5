#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "contact/body.h"
#include "contact/friction.h"
#include "contact/meeting_kernels.h"
#include "rod/batch.h"

namespace mane::contact {

/// Bodies that move as one, at rest in their common frame.
struct BodyGroup {
  std::vector<Body> bodies;
  std::vector<Friction> frictions;  ///< Of each body.
};

/// How strands meet bodies in batched steps; as ContactSettings.
struct BatchContactSettings {
  double thickness = 5e-4;      ///< [m]
  double root_length = 5e-3;    ///< [m]
  double recovery_speed = 0.2;  ///< What lies deep inside comes out so fast at most [m/s],
  double recovery_pull = 2000;  ///< pulled by so much at most [m/s^2] (K9).
};

/// How a group moves in a step of a head.
///
/// @param group  from its frame to the world. @param head  from the head's. Both move from `begin`
///   to `end` within head.dt.
[[nodiscard]] GroupMotion MotionOf(const BodyMotion& group, const rod::ClampMotion& head);

/// First of the points of each element of a block at which it meets bodies, and how many there are
/// in all, (N + 1): of an element as few as lie within 15 mm of each other and leave no more than 2
/// mm of curl between them on every strand, 1 to 10.
[[nodiscard]] std::vector<int> FirstPoints(const rod::Batch<float>& batch,
                                           const rod::Batch<float>::Block& block);

/// Rows that are remembered of a block from step to step; as Forget leaves them at first.
[[nodiscard]] constexpr size_t MemoryRows(int points, size_t groups) {
  return static_cast<size_t>(points) * (kTouchRows + groups * kSeenRows);
}

/// Nothing is remembered: neither what was seen nor what was touched.
void Forget(std::span<rod::Row<float>> memory);

/// Memory of one worker; grows to the largest block it has seen and is reused.
struct BatchContactScratch {
  rod::BatchScratch step;
  std::vector<rod::Row<float>> points, meetings, loads, velocities, local, places, stale, next;
  std::vector<unsigned char> loaded, watched, any_stale;
  std::vector<float> x, y, z, distance, nx, ny, nz, vx, vy, vz;
  std::vector<int32_t> body;
  std::vector<uint32_t> place;
};

/// What a step among bodies is done with.
struct BatchContact {
  const rod::KernelTable<float>& step;
  const MeetingKernels& meetings;
  std::span<const BodyGroup* const> groups;
  std::span<const GroupMotion> motions;  ///< Of each group.
  BatchContactSettings settings;
  double surprise = 0;  ///< How far strands may move besides what they did in the last step [m].
};

/// One step of one block among bodies, in stages (contact.md, K1 to K15): Begin; Solve; Revise;
/// Solve; Finish, and Solve again while it asks for that; Commit. Between them the velocities of
/// all points may be read, and impulses set that others give.
class BlockStep {
 public:
  /// All references must outlive it.
  ///
  /// @param first_point  of each element, and their number (FirstPoints).
  /// @param memory  of this block, (MemoryRows). @param watch_all  whether the velocities of points
  ///   far from bodies are wanted, too.
  BlockStep(const BatchContact& contact, const rod::Batch<float>& batch,
            const rod::Batch<float>::Block& block, std::span<const int> first_point,
            std::span<const rod::Row<float>, rod::layout::kDriveRows> drive,
            std::span<rod::Row<float>> memory, std::span<rod::Row<float>> state,
            BatchContactScratch& scratch, bool watch_all = false);

  /// Where the strands are, what they meet, and the loads of the first solution.
  void Begin();
  void Solve();
  /// Asks for what Solve reads, which comes while the processor works on another block.
  void ExpectSolve() const;
  /// Loads of the second. @return whether any differ.
  [[nodiscard]] bool Revise();
  /// @return whether to solve again; at most kCorrections times.
  [[nodiscard]] bool Finish();
  /// Takes over the new state. @return as rod::StepBlock.
  [[nodiscard]] uint32_t Commit();

  /// How far strands that meet bodies, or all that are watched, leave the straight lines that the
  /// step took them along, at most [m] (rod.md, S16).
  [[nodiscard]] float Bend() const;

  [[nodiscard]] int points() const { return points_; }
  /// A vector of every strand.
  using Vectors = std::span<const rod::Row<float>, 3>;
  /// Of a point, where Begin found it [m], from the head's place at kTheta of the way; what led
  /// there, and what it does in the last solution [m/s], world.
  [[nodiscard]] Vectors Position(int point) const {
    return Three(scratch_.points, point * rod::layout::kPointRows + rod::layout::kPosition);
  }
  [[nodiscard]] Vectors LastVelocity(int point) const {
    return Three(scratch_.points, point * rod::layout::kPointRows + rod::layout::kLastVelocity);
  }
  [[nodiscard]] Vectors Velocity(int point) const { return Three(scratch_.velocities, 3 * point); }
  /// To the nearest body [m]; large where none is within reach.
  [[nodiscard]] float Distance(int point, int lane) const {
    return scratch_.meetings[point * kMeetingRows + kDistance].lane[lane];
  }
  /// Mass that it stands for [kg].
  [[nodiscard]] float Mass(int point, int lane) const;
  /// Sets what others push it with in the next solution [kg m/s].
  void SetImpulse(int point, Vectors impulse);

  /// Solutions after the second, at most (K8).
  static constexpr int kCorrections = 3;

 private:
  [[nodiscard]] static Vectors Three(const std::vector<rod::Row<float>>& rows, int row) {
    return Vectors(&rows[static_cast<size_t>(row)], 3);
  }
  [[nodiscard]] MeetingBlock Meetings();
  // Looks at a group between points where it turns sharply (K14); `seen` is of its points.
  void LookBetween(size_t group, const rod::Row<float>* seen);

  const BatchContact& contact_;
  const rod::KindKernels<float>& kernels_;
  const rod::Batch<float>::Block& block_;
  const std::span<const int> first_point_;
  const int points_;
  std::span<const rod::Row<float>, rod::layout::kDriveRows> drive_;
  const std::span<rod::Row<float>> memory_, state_;
  BatchContactScratch& scratch_;
  const bool watch_all_;
  const float* const constants_;
  void* const bytes_;
  MeetingNumbers numbers_;
  rod::Row<float> size_, turning_;
  int corrections_ = 0;
};

/// All stages of BlockStep, without impulses of others.
///
/// @param bend  BlockStep::Bend(), if that is more; null where nobody asks.
/// @return as rod::StepBlock.
[[nodiscard]] uint32_t StepBlockAmong(
    const BatchContact& contact, const rod::Batch<float>& batch,
    const rod::Batch<float>::Block& block, std::span<const int> first_point,
    std::span<const rod::Row<float>, rod::layout::kDriveRows> drive,
    std::span<rod::Row<float>> memory, std::span<rod::Row<float>> state,
    BatchContactScratch& scratch, float* bend = nullptr);

}  // namespace mane::contact
