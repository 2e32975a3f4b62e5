#include "rpc/bake_job.h"

#include <cmath>
#include <cstring>

#include "head/head.h"
#include "rpc/convert_animation.h"
#include "rpc/limits.h"
#include "session/admission.h"
#include "stored.pb.h"

namespace mane::rpc {
namespace {

constexpr size_t kMaxPoses = 16'000;
constexpr size_t kChunkBytes = 512 * 1024;
constexpr size_t kMaxResultBytes = size_t{4} << 30;
// Element-steps of one frame, half a second or so (session/admission.h).
constexpr double kMaxFrameWork = 4e5;

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

Result<std::vector<session::PoseCommand>> ToMotion(const v1::PoseTrack& track) {
  const size_t count = track.times_s().size() / sizeof(double);
  if (count < 1 || count > kMaxPoses) {
    return InvalidArgument(
        "motion.times_s",
        fmt::format("motion.times_s holds {} poses; 1 to {} are allowed", count, kMaxPoses));
  }
  const auto times = Unpack(track.times_s(), count, 1, "motion.times_s");
  if (!times) return times.error();
  const auto positions = Unpack(track.positions(), count, 3, "motion.positions");
  if (!positions) return positions.error();
  const auto orientations = Unpack(track.orientations(), count, 4, "motion.orientations");
  if (!orientations) return orientations.error();
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
    v1::Vector3 p;
    p.set_x((*positions)[3 * i]);
    p.set_y((*positions)[3 * i + 1]);
    p.set_z((*positions)[3 * i + 2]);
    v1::Quaternion q;
    q.set_x((*orientations)[4 * i]);
    q.set_y((*orientations)[4 * i + 1]);
    q.set_z((*orientations)[4 * i + 2]);
    q.set_w((*orientations)[4 * i + 3]);
    const auto position = ToVector(p, fmt::format("motion.positions[{}]", i), kMaxCoordinate);
    if (!position) return position.error();
    const auto orientation = ToQuaternion(q, fmt::format("motion.orientations[{}]", i));
    if (!orientation) return orientation.error();
    motion.push_back({time, {*position, *orientation}});
  }
  return motion;
}

}  // namespace

Result<Bake> ToBake(const v1::BakeAnimationRequest& request) {
  Bake bake;
  auto motion = ToMotion(request.motion());
  if (!motion) return motion.error();
  bake.motion = *std::move(motion);
  const auto view = ToView(request.format(), request.space(), request.points_per_guide(), "");
  if (!view) return view.error();
  bake.view = *view;
  const auto environment = ToEnvironment(request.environment(), "environment");
  if (!environment) return environment.error();
  bake.environment = *environment;
  if (request.substeps() != 0) {
    if (const auto ok = CheckRange("substeps", request.substeps(), 1, 64); !ok) return ok.error();
    bake.substeps = static_cast<int>(request.substeps());
  }
  return bake;
}

Result<void> AdmitBake(const groom::Groom& groom, const Bake& bake) {
  if (const auto ok = session::AdmitView(groom, bake.view, ""); !ok) return ok;
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
    const double work = static_cast<double>(groom.stepped_elements()) * head::StepCount(movement);
    if (work > kMaxFrameWork) {
      return Error{ErrorCode::kResourceExhausted,
                   fmt::format("frame {} takes {} element-steps with substeps {}; at most {} are "
                               "allowed: use fewer substeps, or poses closer together",
                               i, work, bake.substeps, kMaxFrameWork),
                   "substeps"};
    }
  }
  return {};
}

Result<void> RunBake(GroomLibrary& grooms, exec::WorkerPool& pool, jobs::JobContext& context) {
  v1::BakeAnimationRequest request;
  if (!request.ParseFromString(context.spec())) {
    return Error{ErrorCode::kInternal, "the stored bake does not parse", ""};
  }
  const auto bake = ToBake(request);
  if (!bake) return bake.error();
  const auto loaded = grooms.Load(request.groom(), "groom");
  if (!loaded) return loaded.error();
  const groom::Groom& groom = **loaded;
  // Again: it may have been made anew, and larger, since the bake was submitted.
  if (const auto ok = AdmitBake(groom, *bake); !ok) return ok;

  head::HeadState state = head::AtRest(groom, bake->motion.front().pose);
  if (bake->environment.detail_tolerance > 0) {
    head::StartDetail(groom, std::make_shared<const head::Levels>(groom, pool), &state.detail);
  }
  BakeChunk chunk;
  for (size_t i = 0; i < bake->motion.size(); ++i) {
    if (context.Cancelled()) return jobs::JobContext::StoppedError();
    const session::PoseCommand& pose = bake->motion[i];
    head::StepReport report;
    if (i > 0) {
      const head::Movement movement{pose.pose, pose.time - bake->motion[i - 1].time,
                                    bake->substeps};
      report = head::Advance(groom, movement, bake->environment, &state, pool);
    }
    session::Frame frame;
    frame.index = i + 1;
    frame.time = frame.newest_pose_time = pose.time;
    frame.pose = state.pose;
    frame.data = head::EncodeFrame(groom, state, bake->view, pool);
    frame.repaired_guides = report.repaired_guides;
    frame.stepped_elements = head::SteppedElements(groom, state);
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
