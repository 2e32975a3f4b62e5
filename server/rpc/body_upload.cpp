#include "rpc/body_upload.h"

#include <fmt/format.h>

#include <utility>

#include "groom/range.h"
#include "rpc/convert_body.h"

namespace mane::rpc {

Result<void> BodyUpload::Add(const v1::Body& message) {
  const bool goes_on = !bodies_.empty() && message.name() == bodies_.back().name;
  return goes_on ? AddPiece(message) : AddBody(message);
}

Result<void> BodyUpload::AddBody(const v1::Body& message) {
  if (std::ssize(bodies_) == limits_.max_bodies) {
    return groom::TooMany("bodies", "bodies", long{limits_.max_bodies} + 1, limits_.max_bodies);
  }
  auto body = ToBody(message, static_cast<int>(bodies_.size()));
  if (!body) return body.error();
  mesh_ = nullptr;
  if (message.has_mesh()) {
    mesh_ = std::make_shared<groom::Body::Mesh>();
    body->shape = std::shared_ptr<const groom::Body::Mesh>(mesh_);
  }
  bodies_.push_back(*std::move(body));
  return mesh_ == nullptr ? Result<void>() : Append(message.mesh());
}

Result<void> BodyUpload::AddPiece(const v1::Body& message) {
  const size_t index = bodies_.size() - 1;
  const bool rest = message.material() != v1::MATERIAL_UNSPECIFIED || message.has_friction() ||
                    message.has_friction_anisotropy() || message.moving() || message.has_pose();
  if (mesh_ != nullptr && message.has_mesh() && !rest) return Append(message.mesh());
  const std::string field = fmt::format("bodies[{}].name", index + 1);
  return InvalidArgument(
      field, fmt::format("{0} is \"{1}\", as that of the body before it; a message that goes on "
                         "with the mesh of that one holds nothing but name and mesh, and another "
                         "body needs another name",
                         field, message.name()));
}

Result<void> BodyUpload::Append(const v1::TriangleMesh& piece) {
  const int index = static_cast<int>(bodies_.size()) - 1;
  const long vertices = std::ssize(mesh_->vertices), triangles = std::ssize(mesh_->triangles);
  if (auto ok = AppendBodyMesh(piece, index, mesh_.get()); !ok) return ok;
  vertices_ += std::ssize(mesh_->vertices) - vertices;
  triangles_ += std::ssize(mesh_->triangles) - triangles;
  const std::string path = fmt::format("bodies[{}].mesh.", index);
  if (vertices_ > limits_.max_body_vertices) {
    return groom::TooMany(path + "vertices", "vertices", vertices_, limits_.max_body_vertices);
  }
  if (triangles_ > limits_.max_body_triangles) {
    return groom::TooMany(path + "triangles", "triangles", triangles_, limits_.max_body_triangles);
  }
  return {};
}

}  // namespace mane::rpc
