#pragma once

#include <atomic>
#include <optional>
#include <vector>

#include "base/result.h"
#include "groom/import.h"
#include "mane/v1/groom.pb.h"
#include "rpc/body_upload.h"
#include "rpc/groom_library.h"
#include "rpc/hair_upload.h"

namespace mane::rpc {

/// The messages of one CreateGroom call, gathered and checked as they come.
class GroomUpload {
 public:
  explicit GroomUpload(GroomLibrary& library)
      : library_(library), bodies_(library.limits()), hairs_(library.limits()) {}

  /// Takes the next message; true when it was `commit`, the last. kInvalidArgument or
  /// kResourceExhausted names the field.
  Result<bool> Add(const v1::CreateGroomRequest& request);
  /// All messages are in: generates or imports guides if asked to, and creates the groom.
  /// kCancelled soon after `cancelled` is set while distance fields are made or strands imported.
  Result<v1::Groom> Finish(const std::atomic<bool>& cancelled);

 private:
  Result<storage::GroomRecord> Create(const std::atomic<bool>& cancelled);
  Result<void> AddHeader(const v1::CreateGroomHeader& header);
  Result<void> AddGuides(const v1::GuideBatch& batch);
  Result<void> AddStrands(const v1::StrandBatch& batch);
  Result<void> AddMesh(const v1::TriangleMesh& piece);
  // Guides that the groom will have, before they are made.
  [[nodiscard]] size_t GuideCount() const;

  GroomLibrary& library_;
  bool has_header_ = false;
  long element_count_ = 0;
  v1::CreateGroomHeader header_;
  groom::TriangleMesh mesh_;
  BodyUpload bodies_;
  HairUpload hairs_;
  std::optional<groom::Friction> scalp_friction_;
  std::vector<groom::Guide> guides_;
  groom::ImportOptions import_options_;
  std::vector<groom::ImportedStrand> strands_;
  long point_count_ = 0;
  double import_cost_ = 0;  // [s]
};

}  // namespace mane::rpc
