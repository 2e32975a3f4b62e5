#pragma once

#include <string>

#include "base/result.h"
#include "mane/v1/groom.pb.h"
#include "rpc/groom_library.h"

namespace mane::rpc {

/// The messages of one CreateGroom call, gathered and checked as they come.
class GroomUpload {
 public:
  explicit GroomUpload(GroomLibrary& library) : library_(library) {}

  /// Takes the next message; true when it was `commit`, the last. kInvalidArgument or
  /// kResourceExhausted names the field.
  Result<bool> Add(const v1::CreateGroomRequest& request);
  /// All messages are in: generates guides if asked to, and creates the groom.
  Result<storage::GroomRecord> Finish();

 private:
  Result<void> AddHeader(const v1::CreateGroomHeader& header);
  Result<void> AddGuides(const v1::GuideBatch& batch);
  Result<void> AddMesh(const v1::TriangleMesh& piece);

  GroomLibrary& library_;
  bool has_header_ = false;
  long element_count_ = 0;
  v1::CreateGroomHeader header_;
  groom::TriangleMesh mesh_;
  std::vector<groom::Guide> guides_;
};

}  // namespace mane::rpc
