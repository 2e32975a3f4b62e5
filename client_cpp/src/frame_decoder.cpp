#include "frame_decoder.h"

#include <fmt/format.h>

#include <Eigen/Core>
#include <algorithm>
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

// One of the lists of natural curvatures at element `q`: a number each, one for all, or none.
double NaturalAt(const google::protobuf::RepeatedField<double>& list, int q) {
  if (list.empty()) return 0;
  return list.Get(list.size() == 1 ? 0 : q);
}

// Numbers element by element as vectors.
template <typename Vector>
void ToElements(std::span<const double> numbers, std::vector<Vector>& out) {
  out.clear();
  for (size_t i = 0; i < numbers.size(); i += Vector::SizeAtCompileTime) {
    out.push_back(Eigen::Map<const Vector>(&numbers[i]));
  }
}

}  // namespace

bool GuideGeometry::usable() const {
  const auto bent = [](const Eigen::Vector3d& strain) {
    return strain.allFinite() && strain.tail<2>().norm() > 0;
  };
  return !element_lengths.empty() && natural.size() == (wound ? element_lengths.size() : 0) &&
         std::all_of(natural.begin(), natural.end(), bent);
}

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
  out.wound = guide.model() == v1::STRAND_MODEL_WOUND;
  const int N = static_cast<int>(out.element_lengths.size());
  const auto fits = [N](const auto& list) { return list.size() <= 1 || list.size() == N; };
  if (out.wound && fits(guide.natural_twist()) && fits(guide.natural_curvature_1()) &&
      fits(guide.natural_curvature_2())) {
    for (int q = 0; q < N; ++q) {
      out.natural.emplace_back(NaturalAt(guide.natural_twist(), q),
                               NaturalAt(guide.natural_curvature_1(), q),
                               NaturalAt(guide.natural_curvature_2(), q));
    }
  }
  return out;
}

Result<std::shared_ptr<const FrameDecoder>> FrameDecoder::Create(
    const v1::Opened& opened, std::shared_ptr<const std::vector<GuideGeometry>> guides) {
  auto decoder = std::shared_ptr<FrameDecoder>(new FrameDecoder);
  if (opened.format() != v1::FRAME_FORMAT_UNSPECIFIED) decoder->format_ = opened.format();
  if (opened.space() != v1::SPACE_UNSPECIFIED) decoder->space_ = opened.space();
  decoder->guide_count_ = opened.guide_count();
  decoder->points_ = opened.points_per_guide();
  if (decoder->points_ < 2) {
    return Error{ErrorCode::kInternal, "the server opened a head without points", ""};
  }
  if (decoder->format_ == v1::FRAME_FORMAT_GENERALIZED) {
    size_t elements = 0;
    for (size_t i = 0; i < guides->size(); ++i) {
      const GuideGeometry& guide = (*guides)[i];
      if (!guide.usable()) {
        return Error{ErrorCode::kInternal,
                     fmt::format("guide {} of the head's groom has no elements, or is wound and "
                                 "lacks natural curvature",
                                 i),
                     ""};
      }
      elements += guide.element_lengths.size();
      decoder->coordinates_ += guide.coordinates();
    }
    if (guides->size() != opened.guide_count() || elements != opened.element_count()) {
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
      return wire::CoordinatesSize(coordinates_);
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
  if (frame.model() == v1::ANIMATION_MODEL_BEAM) out->model = AnimationModel::kBeam;
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
  out.angles.resize(coordinates_);
  std::vector<Eigen::Vector3f> points(points_);
  std::vector<double> coordinates;
  std::vector<Eigen::Vector3d> theta;
  std::vector<Eigen::Vector4d> x;
  float* position = out.positions.data();
  float* angle = out.angles.data();
  for (const GuideGeometry& guide : *guides_) {
    coordinates.resize(guide.coordinates());
    const size_t size = wire::CoordinatesSize(coordinates.size());
    wire::DecodeCoordinates(data.first(size), coordinates);
    data = data.subspan(size);
    for (const double coordinate : coordinates) *angle++ = static_cast<float>(coordinate);
    const math::Pose root = head * guide.root;
    if (guide.wound) {
      ToElements(coordinates, x);
      wire::SampleWoundPoints(root, guide.element_lengths, guide.natural, x, std::span(points));
    } else {
      ToElements(coordinates, theta);
      wire::SamplePoints(root, guide.element_lengths, theta, std::span(points));
    }
    position = Append(points, position);
  }
}

}  // namespace mane::inline client
