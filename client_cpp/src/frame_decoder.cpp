#include "frame_decoder.h"

#include <fmt/format.h>

#include <Eigen/Core>
#include <cstddef>
#include <span>

#include "convert.h"
#include "wire/frame_codec.h"
#include "wire/reconstruct.h"

namespace mane::inline client {
namespace {

math::Pose ToRigid(const Pose& pose) {
  const Vector3& p = pose.position;
  const Quaternion& q = pose.orientation;
  return {{p.x, p.y, p.z}, Eigen::Quaterniond(q.w, q.x, q.y, q.z).normalized()};
}

// Copies points to where the guide's begin in a flat array.
float* Append(std::span<const Eigen::Vector3f> points, float* out) {
  for (const Eigen::Vector3f& x : points) {
    for (int axis = 0; axis < 3; ++axis) *out++ = x[axis];
  }
  return out;
}

}  // namespace

GuideGeometry GuideGeometry::From(const v1::Guide& guide) {
  v1::Pose root;
  *root.mutable_position() = guide.root_position();
  if (guide.has_root_frame()) *root.mutable_orientation() = guide.root_frame();
  GuideGeometry out;
  out.root = ToRigid(FromProto(root));
  out.element_lengths.assign(guide.element_lengths_m().begin(), guide.element_lengths_m().end());
  if (out.element_lengths.empty()) {
    out.element_lengths.assign(guide.element_count(), guide.length_m() / guide.element_count());
  }
  return out;
}

Result<std::shared_ptr<const FrameDecoder>> FrameDecoder::Create(
    const v1::Opened& opened, std::shared_ptr<const std::vector<GuideGeometry>> guides) {
  auto decoder = std::shared_ptr<FrameDecoder>(new FrameDecoder);
  if (opened.format() != v1::FRAME_FORMAT_UNSPECIFIED) decoder->format_ = opened.format();
  if (opened.space() != v1::SPACE_UNSPECIFIED) decoder->space_ = opened.space();
  decoder->guide_count_ = opened.guide_count();
  decoder->element_count_ = opened.element_count();
  decoder->points_ = opened.points_per_guide();
  if (decoder->points_ < 2) {
    return Error{ErrorCode::kInternal, "the server opened a head without points", ""};
  }
  if (decoder->format_ == v1::FRAME_FORMAT_GENERALIZED) {
    size_t elements = 0;
    bool usable = true;
    for (const GuideGeometry& guide : *guides) {
      elements += guide.element_lengths.size();
      usable = usable && !guide.element_lengths.empty();
    }
    if (!usable || guides->size() != opened.guide_count() || elements != opened.element_count()) {
      return Error{
          ErrorCode::kInternal,
          fmt::format("the head has {} guides with {} elements, its groom {} with {}",
                      opened.guide_count(), opened.element_count(), guides->size(), elements),
          ""};
    }
    decoder->guides_ = std::move(guides);
  }
  return std::shared_ptr<const FrameDecoder>(std::move(decoder));
}

size_t FrameDecoder::DataSize() const {
  switch (format_) {
    case v1::FRAME_FORMAT_GENERALIZED:
      return wire::AnglesSize(element_count_);
    case v1::FRAME_FORMAT_POSITIONS_QUANTIZED16:
      return guide_count_ * wire::QuantizedSize(points_);
    default:
      return guide_count_ * wire::PositionsSize(points_);
  }
}

Result<std::shared_ptr<const Frame>> FrameDecoder::Decode(const v1::HairFrame& frame) const {
  if (frame.data().size() != DataSize()) {
    return Error{ErrorCode::kInternal,
                 fmt::format("frame {} carries {} bytes; its format gives it {}", frame.index(),
                             frame.data().size(), DataSize()),
                 ""};
  }
  auto out = std::make_shared<Frame>();
  out->index = frame.index();
  out->time_s = frame.time_s();
  out->head_pose = FromProto(frame.head_pose());
  out->guide_count = guide_count_;
  out->points_per_guide = points_;
  out->skipped = frame.skipped();
  out->newest_pose_time_s = frame.newest_pose_time_s();
  out->step_ms = frame.step_ms();
  out->repaired_guides = frame.repaired_guides();
  out->stepped_elements = frame.stepped_elements();
  if (frame.has_diagnostics()) {
    const v1::Diagnostics& d = frame.diagnostics();
    out->diagnostics = Diagnostics{d.kinetic_energy_j(), d.elastic_energy_j(), d.gravity_energy_j(),
                                   d.largest_angle_rad(), d.imbalance()};
  }
  out->positions.resize(size_t{3} * guide_count_ * points_);
  if (format_ == v1::FRAME_FORMAT_GENERALIZED) {
    Reconstruct(frame, *out);
  } else {
    DecodeStrands(frame, *out);
  }
  return std::shared_ptr<const Frame>(std::move(out));
}

void FrameDecoder::DecodeStrands(const v1::HairFrame& frame, Frame& out) const {
  const bool quantized = format_ == v1::FRAME_FORMAT_POSITIONS_QUANTIZED16;
  const size_t strand = quantized ? wire::QuantizedSize(points_) : wire::PositionsSize(points_);
  auto data = std::as_bytes(std::span(frame.data()));
  std::vector<Eigen::Vector3f> points(points_);
  float* to = out.positions.data();
  for (; !data.empty(); data = data.subspan(strand)) {
    if (quantized) {
      wire::DecodeQuantized(data.first(strand), points);
    } else {
      wire::DecodePositions(data.first(strand), points);
    }
    to = Append(points, to);
  }
}

void FrameDecoder::Reconstruct(const v1::HairFrame& frame, Frame& out) const {
  const math::Pose head = space_ == v1::SPACE_HEAD ? math::Pose{} : ToRigid(out.head_pose);
  auto data = std::as_bytes(std::span(frame.data()));
  out.angles.resize(size_t{3} * element_count_);
  std::vector<Eigen::Vector3f> points(points_);
  std::vector<Eigen::Vector3d> theta;
  float* position = out.positions.data();
  float* angle = out.angles.data();
  for (const GuideGeometry& guide : *guides_) {
    theta.resize(guide.element_lengths.size());
    const size_t size = wire::AnglesSize(theta.size());
    wire::DecodeAngles(data.first(size), theta);
    data = data.subspan(size);
    for (const Eigen::Vector3d& element : theta) {
      for (int axis = 0; axis < 3; ++axis) *angle++ = static_cast<float>(element[axis]);
    }
    wire::SamplePoints(head * guide.root, guide.element_lengths, theta, std::span(points));
    position = Append(points, position);
  }
}

}  // namespace mane::inline client
