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
  double recovery_pull = 2000;  ///< pulled by so much at most [m/s^2] (K1).
};

/// How a group moves in a step of a head.
///
/// @param group  from its frame to the world. @param head  from the head's. Both move from `begin`
///   to `end` within head.dt.
[[nodiscard]] GroupMotion MotionOf(const BodyMotion& group, const rod::ClampMotion& head);

/// Points of each element of a block at which it meets bodies: as few as lie within 15 mm of each
/// other and leave no more than 2 mm of curl between them, 1 to 4.
[[nodiscard]] int PointsPerElement(const rod::Batch<float>& batch,
                                   const rod::Batch<float>::Block& block);

/// Rows that are remembered of a block from step to step; as Forget leaves them at first.
[[nodiscard]] size_t MemoryRows(const rod::Batch<float>::Block& block, int per_element,
                                size_t groups);

/// Nothing is remembered: neither what was seen nor what was pressed.
void Forget(std::span<rod::Row<float>> memory);

/// Memory of one worker; grows to the largest block it has seen and is reused.
struct BatchContactScratch {
  rod::BatchScratch step;
  std::vector<rod::Row<float>> points, meetings, loads, velocities, local, stale, next;
  std::vector<unsigned char> loaded, watched, any_stale;
  std::vector<float> x, y, z, distance, nx, ny, nz, vx, vy, vz;
  std::vector<int32_t> body;
  std::vector<uint32_t> place;
};

/// What a step among bodies is done with.
struct BatchContact {
  const rod::KernelTable<float>& step;
  const MeetingKernels& meetings;
  std::span<const BodyGroup* const> groups;  ///< At least one.
  std::span<const GroupMotion> motions;      ///< Of each group.
  BatchContactSettings settings;
};

/// Advances one block by one step, as rod::StepBlock does, among bodies (contact.md, K1 to K8).
///
/// @param memory  of this block, (MemoryRows).
/// @return as rod::StepBlock.
[[nodiscard]] uint32_t StepBlockAmong(
    const BatchContact& contact, const rod::Batch<float>& batch,
    const rod::Batch<float>::Block& block, int per_element,
    std::span<const rod::Row<float>, rod::layout::kDriveRows> drive,
    std::span<rod::Row<float>> memory, std::span<rod::Row<float>> state,
    BatchContactScratch& scratch);

}  // namespace mane::contact
