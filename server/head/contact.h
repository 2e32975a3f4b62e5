#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "contact/batch_contact.h"
#include "contact/wisp_pairs.h"
#include "head/bodies.h"
#include "math/rigid.h"
#include "rod/batch.h"
#include "rod/coarsen.h"
#include "rod/step.h"

namespace mane::head {

/// What a head's hair meets, and what is remembered of it from step to step.
struct Contact {
  /// Of a block of the groom's batch, whatever its level of detail.
  struct Block {
    std::vector<int> first_of_all;  ///< Points of each element (contact::FirstPoints),
    std::vector<int> first_point;   ///< and of each element at its level.
    size_t first;                   ///< In `memory`, and
    size_t rows;                    ///< how many.
    int fineness = 1;               ///< Steps that it makes of one, up to kFinest.
  };
  std::shared_ptr<const Bodies> bodies;  ///< Null before StartContact: hair meets nothing.
  std::vector<math::Pose> moving;        ///< World poses of its moving bodies, (moving_count).
  Eigen::Vector3d velocity = Eigen::Vector3d::Zero();  ///< Of the head in the last step [m/s].
  Eigen::Vector3d spin = Eigen::Vector3d::Zero();      ///< [rad/s]
  std::vector<Block> blocks;
  int fineness = 1;  ///< Of all blocks, where wisps meet.
  std::vector<rod::Row<float>> memory;
  contact::WispTracker wisps;  ///< Where the wisps of guides touch each other.
};

/// A block whose hair would leave the straight lines of a step by more than kLargestBend while it
/// meets bodies makes 2 or kFinest of it (contact.md, K11).
inline constexpr int kFinest = 4;
inline constexpr float kLargestBend = 1e-3F;  // [m]
/// How far bodies come on the head, or the head where its hair does not expect it, in a step [m].
inline constexpr double kLargestWay = 0.01;
/// As kLargestBend, of hair that meets hair; it is stepped finer from then on.
inline constexpr float kLargestWispBend = 4e-3F;
/// At most so many steps a head whose wisps meet makes of one in which it, or a body, comes where
/// its hair does not expect it.
inline constexpr int kFinestOfWisps = 8;

struct HeadState;

/// Lets the hair of `state`, which is at full detail, meet `bodies` from the next Advance on. It
/// lies still in the shape to which it settled among them; the moving ones are where they are at
/// rest. Allocates.
void StartContact(const groom::Groom& groom, std::shared_ptr<const Bodies> bodies,
                  HeadState* state);

/// Puts the hair, at full detail, to where it settled among its bodies, on which it lies still.
void ResetContact(HeadState* state);

/// What a block met is forgotten, as it changes its level of detail. A coarse element has the
/// points of the fine ones that it stands for.
///
/// @param parts  Level::parts; empty at full detail.
void ForgetContact(int block, const rod::Parts& parts, Contact* contact);

/// How every group of bodies moves while the head moves along `head` (rod/step.h): the part of the
/// way from `contact`'s poses to `targets` (empty: none) between the fractions `begin` and `end`.
void SetGroupMotions(const Contact& contact, std::span<const math::Pose> targets,
                     const rod::ClampMotion& head, double begin, double end,
                     std::vector<contact::GroupMotion>* motions);

/// How far hair may move in a step along `head` besides what it did in the last one, for what the
/// clamp does [m].
[[nodiscard]] double Surprise(const Contact& contact, const rod::ClampMotion& head);
/// Steps to make of each of `steps` along `head` for how far bodies come in it, 1 to kFinest, or to
/// kFinestOfWisps where wisps meet.
[[nodiscard]] int FinenessFor(const Contact& contact, std::span<const math::Pose> targets,
                              const rod::ClampMotion& head, int steps);
/// Remembers the last step.
void Remember(const rod::ClampMotion& head, Contact* contact);

/// One step of a block, of the groom's batch or of its level's; as rod::StepBlock.
///
/// @param index  of the block in the groom's batch.
/// @param bend   as of contact::StepBlockAmong.
[[nodiscard]] uint32_t StepAmongBodies(
    int index, const rod::Batch<float>& batch, const rod::Batch<float>::Block& block,
    std::span<const rod::Row<float>, rod::layout::kDriveRows> drive,
    std::span<const contact::GroupMotion> motions, double surprise,
    std::span<rod::Row<float>> state, Contact* contact, float* bend);

/// How the points of a block touched at the end of the last step, of what is remembered.
[[nodiscard]] std::span<rod::Row<float>> TouchedBy(int block, Contact* contact);

}  // namespace mane::head
