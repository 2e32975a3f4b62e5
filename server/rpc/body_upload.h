#pragma once

#include <memory>
#include <vector>

#include "base/result.h"
#include "groom/body.h"
#include "groom/limits.h"
#include "mane/v1/groom.pb.h"

namespace mane::rpc {

/// The bodies of one CreateGroom call, gathered and checked as they come.
class BodyUpload {
 public:
  explicit BodyUpload(const groom::Limits& limits) : limits_(limits) {}

  /// The next body, or a piece that goes on with the mesh of the last one. kInvalidArgument or
  /// kResourceExhausted names the field.
  Result<void> Add(const v1::Body& message);

  /// All of them, once nothing is added any more.
  [[nodiscard]] std::vector<groom::Body> Take() { return std::move(bodies_); }

 private:
  Result<void> AddBody(const v1::Body& message);
  Result<void> AddPiece(const v1::Body& message);
  // Takes a mesh's lists, within the limits on all meshes together.
  Result<void> Append(const v1::TriangleMesh& piece);

  const groom::Limits limits_;
  std::vector<groom::Body> bodies_;
  std::shared_ptr<groom::Body::Mesh> mesh_;  // Of the last body, which shares it; or null.
  long vertices_ = 0, triangles_ = 0;        // Of all meshes.
};

}  // namespace mane::rpc
