#include "rpc/bake_job.h"

#include <cmath>
#include <cstring>

#include "head/head.h"
#include "head/model_switch.h"
#include "rpc/convert_animation.h"
#include "rpc/convert_body_poses.h"
#include "rpc/convert_model.h"
#include "rpc/convert_values.h"
#include "rpc/limits.h"
#include "session/admission.h"
#include "stored.pb.h"

namespace mane::rpc {
namespace {

constexpr size_t kMaxPoses = 16'000;
constexpr size_t kChunkBytes = 512 * 1024;
constexpr size_t kMaxResultBytes = size_t{4} << 30;

// float64 numbers of a packed field that must hold `count` x `width` of them.
Result<std::vector<double>> Unpack(const std::string& bytes, size_t count, size_t width,
                                   const std::string& field) {
  if (bytes.size() != count * width * sizeof(double)) {
    return InvalidArgument(field, fmt::format("{} has {} bytes; {} poses need {}", field,
                                              bytes.size(), count, count * width * sizeof(double)));
  }
  std::vector<double> numbers(count * width);
  std::memcpy(numbers.data(), bytes.data(), bytes.size());
  return numbers;
}

// The poses of a PoseTrack or BodyTrack, whose path is `path`.
template <typename Track>
Result<std::vector<math::Pose>> ToPoses(const Track& track, size_t count, const std::string& path) {
  const auto positions = Unpack(track.positions(), count, 3, path + "positions");
  if (!positions) return positions.error();
  const auto orientations = Unpack(track.orientations(), count, 4, path + "orientations");
  if (!orientations) return orientations.error();
  std::vector<math::Pose> poses;
  for (size_t i = 0; i < count; ++i) {
    v1::Vector3 p;
    v1::Quaternion q;
    FromVector(Eigen::Map<const Eigen::Vector3d>(&(*positions)[3 * i]), &p);
    FromQuaternion(Eigen::Quaterniond(&(*orientations)[4 * i]), &q);
    const auto position = ToVector(p, fmt::format("{}positions[{}]", path, i), kMaxCoordinate);
    if (!position) return position.error();
    const auto orientation = ToQuaternion(q, fmt::format("{}orientations[{}]", path, i));
    if (!orientation) return orientation.error();
    poses.push_back({*position, *orientation});
  }
  return poses;
}

Result<std::vector<session::PoseCommand>> ToMotion(const v1::PoseTrack& track) {
  const size_t count = track.times_s().size() / sizeof(double);
  if (count < 1 || count > kMaxPoses) {
    return InvalidArgument(
        "motion.times_s",
        fmt::format("motion.times_s holds {} poses; 1 to {} are allowed", count, kMaxPoses));
  }
  const auto times = Unpack(track.times_s(), count, 1, "motion.times_s");
  if (!times) return times.error();
  const auto poses = ToPoses(track, count, "motion.");
  if (!poses) return poses.error();
  std::vector<session::PoseCommand> motion;
  for (size_t i = 0; i < count; ++i) {
    const double time = (*times)[i];
    const auto time_field = fmt::format("motion.times_s[{}]", i);
    if (const auto ok = CheckRange(time_field, time, -kMaxTime, kMaxTime); !ok) return ok.error();
    if (i > 0) {
      const auto ok =
          CheckRange(fmt::format("{} - motion.times_s[{}]", time_field, i - 1),
                     time - motion.back().time, session::kLeastPoseGap, session::kLongestPoseGap);
      if (!ok) return InvalidArgument(time_field, ok.error().message);
    }
    motion.push_back({time, (*poses)[i]});
  }
  return motion;
}

}  // namespace

Result<Bake> ToBake(const v1::BakeAnimationRequest& request) {
  Bake bake;
  auto motion = ToMotion(request.motion());
  if (!motion) return motion.error();
  bake.motion = *std::move(motion);
  for (int i = 0; i < request.motion().bodies_size(); ++i) {
    const v1::BodyTrack& track = request.motion().bodies(i);
    auto poses = ToPoses(track, bake.motion.size(), fmt::format("motion.bodies[{}].", i));
    if (!poses) return poses.error();
    bake.bodies.emplace_back(track.name(), *std::move(poses));
  }
  const auto view = ToView(request.format(), request.space(), request.points_per_guide(), "");
  if (!view) return view.error();
  bake.view = *view;
  const auto model = ToModelOptions(request, bake.view.format, {}, "");
  if (!model) return model.error();
  bake.model = *model;
  const auto environment = ToEnvironment(request.environment(), "environment");
  if (!environment) return environment.error();
  bake.environment = *environment;
  if (request.substeps() != 0) {
    if (const auto ok = CheckRange("substeps", request.substeps(), 1, 64); !ok) return ok.error();
    bake.substeps = static_cast<int>(request.substeps());
  }
  return bake;
}

Result<void> BindBodies(const groom::Groom& groom, Bake* bake) {
  for (size_t i = 0; i < bake->bodies.size(); ++i) {
    const auto& [name, poses] = bake->bodies[i];
    const std::string field = fmt::format("motion.bodies[{}].name", i);
    const auto body = FindMovingBody(groom, name, field);
    if (!body) return body.error();
    for (size_t k = 0; k < poses.size(); ++k) {
      session::BodyPoses& named = bake->motion[k].bodies;
      named.resize(MovingCount(groom));
      if (named[*body]) {
        return InvalidArgument(
            field, fmt::format("{} is \"{}\", as that of an earlier track", field, name));
      }
      named[*body] = poses[k];
    }
  }
  return {};
}

Result<void> AdmitBake(const groom::Groom& groom, const Bake& bake) {
  if (const auto ok = session::AdmitView(groom, bake.view, ""); !ok) return ok;
  if (const auto ok = session::AdmitState(groom, "groom"); !ok) return ok;
  const size_t bytes = head::FrameSize(groom, bake.view) * bake.motion.size();
  if (bytes > kMaxResultBytes) {
    return Error{ErrorCode::kResourceExhausted,
                 fmt::format("the frames of points_per_guide {} have {} bytes together; at most {} "
                             "are allowed: ask for fewer points or poses, or a smaller format",
                             bake.view.points_per_guide, bytes, kMaxResultBytes),
                 "points_per_guide"};
  }
  for (size_t i = 1; i < bake.motion.size(); ++i) {
    const head::Movement movement{{}, bake.motion[i].time - bake.motion[i - 1].time, bake.substeps};
    if (auto ok = session::AdmitBakedFrame(groom, movement, static_cast<int>(i), bake.model); !ok)
      return ok;
  }
  return {};
}

Result<void> RunBake(GroomLibrary& grooms, exec::WorkerPool& pool, jobs::JobContext& context) {
  v1::BakeAnimationRequest request;
  if (!request.ParseFromString(context.spec())) {
    return Error{ErrorCode::kInternal, "the stored bake does not parse", ""};
  }
  auto bake = ToBake(request);
  if (!bake) return bake.error();
  const auto found = grooms.Load(request.groom(), "groom");
  if (!found) return found.error();
  const groom::Groom& groom = **found;
  // Again: it may have been made anew, and larger, since the bake was submitted.
  if (const auto ok = BindBodies(groom, &*bake); !ok) return ok;
  if (const auto ok = AdmitBake(groom, *bake); !ok) return ok;
  const auto asset = grooms.MakeAsset(*found, "groom", [&] { return context.Cancelled(); });
  if (context.Cancelled()) return jobs::JobContext::StoppedError();
  if (!asset) return asset.error();

  head::HeadState state = head::AtRest(groom, bake->motion.front().pose);
  head::StartContact(groom, asset->bodies, &state);
  const bool beam = bake->model.model == head::Model::kBeam;
  if (beam) {
    head::StartBeams(head::MakeBeams(groom, asset->bodies.get(), bake->model.beam, pool), &state);
  } else if (bake->environment.detail_tolerance > 0) {
    head::StartDetail(groom, std::make_shared<const head::Levels>(groom, pool), &state.detail);
  }
  BakeChunk chunk;
  for (size_t i = 0; i < bake->motion.size(); ++i) {
    if (context.Cancelled()) return jobs::JobContext::StoppedError();
    const session::PoseCommand& pose = bake->motion[i];
    std::vector<math::Pose> bodies =
        session::PlaceBodies(asset->bodies.get(), pose.pose, pose.bodies);
    head::StepReport report;
    if (i > 0) {
      const head::Movement movement{pose.pose, pose.time - bake->motion[i - 1].time, bake->substeps,
                                    bodies};
      report = head::Advance(groom, movement, bake->environment, &state, pool);
    } else {
      state.contact.moving = std::move(bodies);
    }
    session::Frame frame;
    frame.index = i + 1;
    frame.time = frame.newest_pose_time = pose.time;
    frame.pose = state.pose;
    frame.data = head::EncodeFrame(groom, state, bake->view, pool);
    frame.repaired_guides = report.repaired_guides;
    frame.stepped_elements = head::SteppedElements(groom, state);
    frame.model = bake->model.model;
    FromFrame(frame, 0, chunk.add_frames());
    if (chunk.ByteSizeLong() >= kChunkBytes || i + 1 == bake->motion.size()) {
      if (const auto ok = context.AppendResult(chunk.SerializeAsString()); !ok) return ok;
      chunk.Clear();
    }
    context.Progress(static_cast<double>(i + 1) / static_cast<double>(bake->motion.size()));
  }
  return {};
}

}  // namespace mane::rpc
