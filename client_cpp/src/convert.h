#pragma once

#include <cstring>
#include <string>
#include <vector>

#include "mane/bodies.h"
#include "mane/geometry.h"
#include "mane/groom.h"
#include "mane/head.h"
#include "mane/v1/animation.pb.h"
#include "mane/v1/groom.pb.h"
#include "mane/v1/types.pb.h"

namespace mane::inline client {

/// Public structs to and from messages, field by field.
v1::Vector3 ToProto(const Vector3& v);
v1::Quaternion ToProto(const Quaternion& q);
v1::Pose ToProto(const Pose& pose);
v1::Guide ToProto(const Guide& guide);
v1::EllipsoidScalp ToProto(const EllipsoidScalp& scalp);
v1::GuideGeneration ToProto(const GuideGeneration& generation);
v1::ImportedStrand ToProto(const ImportedStrand& strand);
v1::ImportOptions ToProto(const ImportOptions& options);
v1::Body ToProto(const Body& body);  ///< Without the lists of a mesh.
v1::ScalpContact ToProto(const ScalpContact& contact);
v1::BodyPose ToProto(const BodyPose& body);
v1::Environment ToProto(const Environment& environment);
v1::BeamMotion ToProto(const BeamMotion& beam);
v1::OpenHead ToProto(const HeadOptions& options);

Pose FromProto(const v1::Pose& pose);  ///< Unset parts are the origin and the identity.
GroomInfo FromProto(const v1::Groom& groom);
BodySummary FromProto(const v1::BodySummary& summary);
ScalpContact FromProto(const v1::ScalpContact& contact);
ImportSummary FromProto(const v1::ImportSummary& summary);
ImportReport FromProto(const v1::ImportReport& report);

/// Little-endian numbers of a `bytes` field; this client runs on little-endian machines only.
template <typename Number>
std::vector<Number> Numbers(const std::string& bytes) {
  std::vector<Number> numbers(bytes.size() / sizeof(Number));
  if (!numbers.empty()) std::memcpy(numbers.data(), bytes.data(), numbers.size() * sizeof(Number));
  return numbers;
}

/// The same, at the end of `numbers`.
template <typename Number>
void AppendNumbers(const std::string& bytes, std::vector<Number>& numbers) {
  const std::vector<Number> more = Numbers<Number>(bytes);
  numbers.insert(numbers.end(), more.begin(), more.end());
}

/// Puts the fields that `change` sets over those of `environment`.
void Merge(const Environment& change, Environment& environment);
/// Puts the poses that `change` names over those of `bodies`.
void Merge(const std::vector<BodyPose>& change, std::vector<BodyPose>& bodies);

}  // namespace mane::inline client
