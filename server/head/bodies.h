#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "base/cancelled.h"
#include "base/result.h"
#include "contact/batch_contact.h"
#include "contact/field_cache.h"
#include "contact/friction.h"
#include "contact/shape.h"
#include "exec/worker_pool.h"
#include "groom/groom.h"
#include "math/rigid.h"

namespace mane::head {

/// The wisps that guides stand for, with the points at which they meet (contact/wisp_points.h):
/// those of BlockStep, guide after guide. Guides come in the order of the batch's blocks, in which
/// neighbours on the scalp are near each other in memory.
struct Wisps {
  std::vector<int32_t> place;            ///< Which of these each of the groom's guides is (guides).
  std::vector<int32_t> first;            ///< (guides + 1)
  std::vector<float> radius, curliness;  ///< (guides)
  std::vector<float> mass;               ///< (points)
  std::vector<float> x, y, z;            ///< Where points are at rest, head's frame (points) [m].
  std::vector<float> density;            ///< Of hair around them at rest (points) [kg/m^3].
};

/// What the hair of a groom meets, ready for contact. Immutable; shared by all heads of the groom.
struct Bodies {
  struct Body {
    contact::BodyShape shape;
    contact::Friction friction;
    math::Pose pose;  ///< groom::Body::pose.
    int moving = -1;  ///< Index among the groom's moving bodies; -1 where it is fixed to the head.
  };
  /// Bodies that move as one, as steps take them: those fixed to the head, in its frame, then each
  /// moving one, in its own.
  struct Group {
    contact::BodyGroup bodies;
    int moving = -1;  ///< As of Body.
  };
  std::vector<Body> bodies;
  int moving_count = 0;
  std::vector<Group> groups;
  /// The groom's rest shape among the bodies, on an upright head, as HeadState::guides.
  std::vector<rod::Row<float>> settled;
  /// What hair meets there and how it presses on it, as Contact::memory: it goes on holding.
  std::vector<rod::Row<float>> settled_memory;
  std::optional<Wisps> wisps;  ///< Where any guide has one.
};

/// Distance fields of one groom's bodies together [bytes].
inline constexpr size_t kMaxFieldBytes = size_t{1} << 30;

/// Bodies of `groom`, its scalp among them where it has a friction, in the groom's order. Fields of
/// meshes come from `fields`, which takes seconds where they are not there. Of `groom` only bodies,
/// scalp and friction need to be there; hair has not settled yet.
///
/// @return null where hair meets nothing. INVALID_ARGUMENT naming `bodies[i].mesh.triangles` and
///   the like, or `scalp_mesh.`, for shapes that cannot be used (contact::Validate,
///   MeshField::Build); RESOURCE_EXHAUSTED likewise, and above kMaxFieldBytes; kCancelled soon
///   after `cancelled` says so.
[[nodiscard]] Result<std::shared_ptr<Bodies>> MakeShapes(const groom::Groom& groom,
                                                         contact::FieldCache* fields,
                                                         const base::Cancelled& cancelled = {});

/// The same for heads: hair is let settle, which takes a tenth of a second for 100 guides, and
/// stops between its steps once it is cancelled.
[[nodiscard]] Result<std::shared_ptr<const Bodies>> MakeBodies(
    const groom::Groom& groom, contact::FieldCache* fields, exec::WorkerPool& pool,
    const base::Cancelled& cancelled = {});

/// The distance field of a body that is a mesh; else null.
[[nodiscard]] const contact::MeshField* FieldOf(const Bodies::Body& body);

/// Memory of the fields of `bodies`, one that several share once [bytes].
[[nodiscard]] size_t FieldBytes(std::span<const Bodies::Body> bodies);

/// Where the moving bodies of `groom` are on a head at `head` that has not heard of others: world
/// poses in the groom's order, (moving_count).
[[nodiscard]] std::vector<math::Pose> BodiesAtRest(const Bodies& bodies, const math::Pose& head);

}  // namespace mane::head
