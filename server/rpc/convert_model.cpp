#include "rpc/convert_model.h"

#include <fmt/format.h>

#include <numbers>

#include "mane/v1/bake.pb.h"
#include "rpc/limits.h"

namespace mane::rpc {
namespace {

constexpr int kFewestSegments = 2, kMostSegments = 64;
constexpr double kMostHold = 1000;
constexpr double kMostNear = 10;           // [m]
constexpr double kMostFluctuation = 1;     // [rad]
constexpr double kLeastResponse = 1e-3;    // [1/m]
constexpr double kGreatestResponse = 1e4;  // [1/m]

// Numbers by segment, or none.
template <typename Numbers>
Result<std::vector<float>> BySegment(const Numbers& numbers, int segments, double high,
                                     const std::string& field) {
  if (!numbers.empty() && numbers.size() != segments) {
    return InvalidArgument(field, fmt::format("{} has {} numbers; it must have one for each of {} "
                                              "segments, or none",
                                              field, numbers.size(), segments));
  }
  for (int i = 0; i < numbers.size(); ++i) {
    const auto ok = CheckRange(fmt::format("{}[{}]", field, i), numbers[i], 0, high);
    if (!ok) return ok.error();
  }
  return std::vector<float>(numbers.begin(), numbers.end());
}

Result<head::Model> ToModel(v1::AnimationModel model, head::FrameFormat format,
                            const std::string& field) {
  switch (model) {
    case v1::ANIMATION_MODEL_UNSPECIFIED:
    case v1::ANIMATION_MODEL_SUPER_HELIX:
      return head::Model::kSuperHelix;
    case v1::ANIMATION_MODEL_BEAM:
      if (format != head::FrameFormat::kGeneralized) return head::Model::kBeam;
      return InvalidArgument(field,
                             fmt::format("{} is ANIMATION_MODEL_BEAM, which frames of format "
                                         "FRAME_FORMAT_GENERALIZED cannot show; ask for "
                                         "positions",
                                         field));
    default:
      return InvalidArgument(field, fmt::format("{} is {}; it must be an AnimationModel, 1 or 2",
                                                field, static_cast<int>(model)));
  }
}

}  // namespace

Result<head::BeamOptions> ToBeamOptions(const v1::BeamMotion& message, const std::string& field) {
  head::BeamOptions beam;
  // Unset, there are as many as numbers by segment, if any, else as the groom takes.
  int64_t segments = message.segments();
  if (segments != 0) {
    const auto ok = CheckRange(field + ".segments", segments, kFewestSegments, kMostSegments);
    if (!ok) return ok.error();
  } else if (message.epsilon_size() + message.largest_turn_rad_size() > 0) {
    const bool first = message.epsilon_size() > 0;
    segments = first ? message.epsilon_size() : message.largest_turn_rad_size();
    if (segments < kFewestSegments || segments > kMostSegments) {
      const std::string array = field + (first ? ".epsilon" : ".largest_turn_rad");
      return InvalidArgument(array, fmt::format("{} has {} numbers; it must have one for each of "
                                                "{} to {} segments, or none",
                                                array, segments, kFewestSegments, kMostSegments));
    }
  }
  beam.segments = static_cast<int>(segments);
  switch (message.equations()) {
    case v1::BEAM_EQUATIONS_UNSPECIFIED:
    case v1::BEAM_EQUATIONS_ACROSS:
      beam.equations = beam::Equations::kAcross;
      break;
    case v1::BEAM_EQUATIONS_POLAR:
      beam.equations = beam::Equations::kPolar;
      break;
    default:
      return InvalidArgument(field + ".equations",
                             fmt::format("{}.equations is {}; it must be BEAM_EQUATIONS_ACROSS or "
                                         "BEAM_EQUATIONS_POLAR",
                                         field, static_cast<int>(message.equations())));
  }
  if (message.has_hold()) beam.hold = message.hold();
  beam.bounded = !message.unbounded();
  if (message.has_clamped()) beam.clamped = message.clamped();
  if (message.has_avoid_head()) beam.avoid_head = message.avoid_head();
  if (message.has_alpha()) beam.alpha = message.alpha();
  if (message.has_near_m()) beam.near = message.near_m();
  if (message.has_tip_response()) beam.tip_response = message.tip_response();
  beam.fluctuation = message.fluctuation_rad();
  beam.seed = message.seed();
  const double response = beam.tip_response.value_or(1);
  for (const auto& ok :
       {CheckRange(field + ".hold", beam.hold, 0, kMostHold),
        CheckRange(field + ".alpha", beam.alpha, -1, 1),
        CheckRange(field + ".near_m", beam.near, 0, kMostNear),
        CheckRange(field + ".fluctuation_rad", beam.fluctuation, 0, kMostFluctuation),
        CheckRange(field + ".tip_response", response, kLeastResponse, kGreatestResponse)}) {
    if (!ok) return ok.error();
  }
  auto epsilon = BySegment(message.epsilon(), beam.segments, 1, field + ".epsilon");
  if (!epsilon) return epsilon.error();
  beam.epsilon = *std::move(epsilon);
  // Half a turn as float32 has it is a little more than pi.
  auto turns = BySegment(message.largest_turn_rad(), beam.segments, std::numbers::pi_v<float>,
                         field + ".largest_turn_rad");
  if (!turns) return turns.error();
  beam.largest_turn = *std::move(turns);
  return beam;
}

template <typename Message>
Result<head::ModelOptions> ToModelOptions(const Message& message, head::FrameFormat format,
                                          const head::BeamOptions& beam, const std::string& field) {
  head::ModelOptions options;
  const auto model = ToModel(message.model(), format, field + "model");
  if (!model) return model.error();
  options.model = *model;
  options.beam = beam;
  if (message.has_beam()) {
    auto own = ToBeamOptions(message.beam(), field + "beam");
    if (!own) return own.error();
    options.beam = *std::move(own);
  }
  return options;
}

template Result<head::ModelOptions> ToModelOptions(const v1::OpenHead&, head::FrameFormat,
                                                   const head::BeamOptions&, const std::string&);
template Result<head::ModelOptions> ToModelOptions(const v1::SetModel&, head::FrameFormat,
                                                   const head::BeamOptions&, const std::string&);
template Result<head::ModelOptions> ToModelOptions(const v1::BakeAnimationRequest&,
                                                   head::FrameFormat, const head::BeamOptions&,
                                                   const std::string&);

v1::AnimationModel FromModel(head::Model model) {
  return model == head::Model::kBeam ? v1::ANIMATION_MODEL_BEAM : v1::ANIMATION_MODEL_SUPER_HELIX;
}

}  // namespace mane::rpc
