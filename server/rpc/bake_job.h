#pragma once

#include <string>
#include <utility>
#include <vector>

#include "base/result.h"
#include "head/frame.h"
#include "head/model.h"
#include "jobs/job_context.h"
#include "mane/v1/bake.pb.h"
#include "rpc/groom_library.h"
#include "session/command.h"

namespace mane::rpc {

/// A bake, decoded and checked.
struct Bake {
  std::vector<session::PoseCommand> motion;
  head::View view;
  head::Environment environment;
  int substeps = 1;
  head::ModelOptions model;
  /// Moving bodies by name, each with a world pose for every pose of the motion.
  std::vector<std::pair<std::string, std::vector<math::Pose>>> bodies;
};

/// kInvalidArgument names the field. The groom is not looked up.
Result<Bake> ToBake(const v1::BakeAnimationRequest& request);

/// Gives the poses of the bake's bodies to its motion. kInvalidArgument names
/// `motion.bodies[i].name` when it is none of the moving bodies of `groom`, or named twice.
Result<void> BindBodies(const groom::Groom& groom, Bake* bake);

/// kResourceExhausted when a frame of the bake is too much work (session::kMaxFrameWork: it is
/// cancelled between frames) or too many bytes, all frames together are, or what hair remembers.
Result<void> AdmitBake(const groom::Groom& groom, const Bake& bake);

/// Runs the bake in `context`'s spec, a serialised BakeAnimationRequest: the same frames as a
/// LOCKSTEP stream of the same poses. Each result chunk is a serialised BakeChunk.
Result<void> RunBake(GroomLibrary& grooms, exec::WorkerPool& pool, jobs::JobContext& context);

}  // namespace mane::rpc
