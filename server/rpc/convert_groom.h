#pragma once

#include <string>

#include "base/result.h"
#include "groom/generate.h"
#include "groom/groom.h"
#include "groom/validate.h"
#include "mane/v1/groom.pb.h"
#include "storage/groom_store.h"

namespace mane::rpc {

/// Messages of groom.proto to the domain and back. Ranges are checked by the groom folder; what
/// only the encoding can get wrong, here.

[[nodiscard]] groom::GuideDescription ToDescription(const v1::Guide& message);
void FromDescription(const groom::GuideDescription& guide, v1::Guide* message);

/// Appends a piece to `mesh`. kInvalidArgument for bytes that are no whole number of entries.
Result<void> AppendMesh(const v1::TriangleMesh& message, groom::TriangleMesh* mesh);
/// The same of a scalp that is being uploaded; kResourceExhausted above `limits`.
Result<void> AppendScalpMesh(const v1::TriangleMesh& message, const groom::Limits& limits,
                             groom::TriangleMesh* mesh);
void FromMesh(const groom::TriangleMesh& mesh, v1::TriangleMesh* message);
/// Of every list the entries from `begin` on, `count` of them at most.
void FromMeshPiece(const groom::TriangleMesh& mesh, size_t begin, size_t count,
                   v1::TriangleMesh* message);

[[nodiscard]] groom::Ellipsoid ToEllipsoid(const v1::EllipsoidScalp& message);
void FromEllipsoid(const groom::Ellipsoid& ellipsoid, v1::EllipsoidScalp* message);

/// A preset; kInvalidArgument for any other number.
Result<groom::HairType> ToHairType(v1::HairType message, const std::string& field);
Result<groom::Generation> ToGeneration(const v1::GuideGeneration& message);

/// The description of a stored groom.
void FromRecord(const storage::GroomRecord& record, v1::Groom* message);

/// Nanoseconds since the epoch; 0 leaves the message unset.
template <typename Timestamp>
void FromNanoseconds(int64_t ns, Timestamp* message) {
  message->set_seconds(ns / 1'000'000'000);
  message->set_nanos(static_cast<int32_t>(ns % 1'000'000'000));
}

}  // namespace mane::rpc
