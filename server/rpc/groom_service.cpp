#include "rpc/groom_service.h"

#include <algorithm>
#include <memory>
#include <utility>

#include "rpc/chunk_stream.h"
#include "rpc/convert_animation.h"
#include "rpc/convert_body.h"
#include "rpc/convert_groom.h"
#include "rpc/convert_hairs.h"
#include "rpc/groom_upload.h"
#include "rpc/names.h"
#include "rpc/rest_shape.h"
#include "rpc/unary.h"

namespace mane::rpc {
namespace {

constexpr int kDefaultPageSize = 100;

// The parts of an export: the description, the scalp, bodies, guides, then hairs.
class ExportParts {
 public:
  ExportParts(GroomLibrary& library, const v1::ExportGroomRequest& request)
      : library_(library), name_(request.name()), omit_hairs_(request.omit_hairs()) {}

  Result<std::optional<v1::ExportGroomResponse>> Next() {
    v1::ExportGroomResponse part;
    switch (stage_) {
      case Stage::kDescription:
        return Describe();
      case Stage::kEllipsoid:
        stage_ = Stage::kBodies;
        FromEllipsoid(std::get<groom::Ellipsoid>(groom_->scalp), part.mutable_ellipsoid());
        return std::optional(part);
      case Stage::kMesh:
        return MeshPiece();
      case Stage::kBodies:
        if (body_ < groom_->bodies.size()) return BodyPiece();
        stage_ = Stage::kGuides;
        return Guides();
      case Stage::kGuides:
        if (next_ < groom_->guides.size()) return Guides();
        stage_ = Stage::kHairs;
        next_ = 0;
        return Hairs();
      case Stage::kHairs:
        return Hairs();
    }
    return std::optional<v1::ExportGroomResponse>();
  }

 private:
  enum class Stage { kDescription, kEllipsoid, kMesh, kBodies, kGuides, kHairs };
  static constexpr size_t kGuidesPerPart = 64;       // At most 256 elements each: under 500 kB.
  static constexpr size_t kEntriesPerPart = 20'000;  // Vertices and triangles, 12 bytes each.

  Result<std::optional<v1::ExportGroomResponse>> Describe() {
    auto groom = library_.Load(name_, "name");
    if (!groom) return groom.error();
    groom_ = *std::move(groom);
    const auto id = ParseName(name_, "grooms", "name");
    const auto record = library_.store().Get(*id);
    if (!record) return record.error();
    stage_ = std::holds_alternative<groom::Ellipsoid>(groom_->scalp)      ? Stage::kEllipsoid
             : std::holds_alternative<groom::TriangleMesh>(groom_->scalp) ? Stage::kMesh
                                                                          : Stage::kBodies;
    v1::ExportGroomResponse part;
    FromRecord(*record, part.mutable_groom());
    return std::optional(part);
  }

  Result<std::optional<v1::ExportGroomResponse>> MeshPiece() {
    const auto& mesh = std::get<groom::TriangleMesh>(groom_->scalp);
    v1::ExportGroomResponse part;
    FromMeshPiece(mesh, next_, kEntriesPerPart, part.mutable_scalp_mesh());
    next_ += kEntriesPerPart;
    if (next_ >=
        std::max({mesh.vertices.size(), mesh.triangles.size(), mesh.hair_triangles.size()})) {
      stage_ = Stage::kBodies;
      next_ = 0;
    }
    return std::optional(part);
  }

  // A body, of a mesh its first piece; then pieces that go on with it.
  Result<std::optional<v1::ExportGroomResponse>> BodyPiece() {
    const groom::Body& body = groom_->bodies[body_];
    const groom::Body::Mesh* mesh = MeshOf(body);
    v1::ExportGroomResponse part;
    part.mutable_body()->set_name(body.name);
    if (next_ == 0) FromBody(body, part.mutable_body());
    if (mesh != nullptr) {
      FromBodyMesh(*mesh, next_, kEntriesPerPart, part.mutable_body()->mutable_mesh());
    }
    next_ += kEntriesPerPart;
    if (mesh == nullptr || next_ >= std::max(mesh->vertices.size(), mesh->triangles.size())) {
      ++body_;
      next_ = 0;
    }
    return std::optional(part);
  }

  Result<std::optional<v1::ExportGroomResponse>> Guides() {
    v1::ExportGroomResponse part;
    const size_t end = std::min(groom_->guides.size(), next_ + kGuidesPerPart);
    for (; next_ < end; ++next_) {
      FromDescription(groom::Describe(groom_->guides[next_]), part.mutable_guides()->add_guides());
    }
    return std::optional(part);
  }

  // Nothing where there are none left.
  Result<std::optional<v1::ExportGroomResponse>> Hairs() {
    if (omit_hairs_ || groom_->hairs == nullptr || next_ == groom_->hairs->count()) {
      return std::optional<v1::ExportGroomResponse>();
    }
    v1::ExportGroomResponse part;
    const size_t end = EndOfBatch(*groom_->hairs, next_);
    FromHairs(*groom_->hairs, next_, end, part.mutable_hairs());
    next_ = end;
    return std::optional(part);
  }

  GroomLibrary& library_;
  const std::string name_;
  const bool omit_hairs_;
  std::shared_ptr<const groom::Groom> groom_;
  Stage stage_ = Stage::kDescription;
  size_t body_ = 0;
  size_t next_ = 0;  // Entry, guide or hair.
};

}  // namespace

grpc::ServerReadReactor<grpc::ByteBuffer>* GroomService::CreateGroom(
    grpc::CallbackServerContext* /*context*/, grpc::ByteBuffer* response) {
  return uploads_.Start(std::make_unique<UploadOf<v1::CreateGroomRequest, GroomUpload>>(library_),
                        response);
}

grpc::ServerUnaryReactor* GroomService::GetGroom(grpc::CallbackServerContext* context,
                                                 const v1::GetGroomRequest* request,
                                                 v1::Groom* response) {
  return Answer(context, requests_, [this, request, response]() -> Result<void> {
    const auto id = ParseName(request->name(), "grooms", "name");
    if (!id) return id.error();
    const auto record = library_.store().Get(*id);
    if (!record) return record.error();
    FromRecord(*record, response);
    return {};
  });
}

grpc::ServerUnaryReactor* GroomService::ListGrooms(grpc::CallbackServerContext* context,
                                                   const v1::ListGroomsRequest* request,
                                                   v1::ListGroomsResponse* response) {
  return Answer(context, requests_, [this, request, response]() -> Result<void> {
    const int size = request->page_size() == 0 ? kDefaultPageSize : request->page_size();
    auto page = library_.store().List(size, request->page_token());
    if (!page) return page.error();
    for (const storage::GroomRecord& record : page->records) {
      FromRecord(record, response->add_grooms());
      response->mutable_grooms()->rbegin()->clear_bodies();  // A page of them could be too large.
    }
    response->set_next_page_token(page->next_page_token);
    return {};
  });
}

grpc::ServerUnaryReactor* GroomService::DeleteGroom(grpc::CallbackServerContext* context,
                                                    const v1::DeleteGroomRequest* request,
                                                    google::protobuf::Empty* /*response*/) {
  return Answer(context, requests_, [this, request]() -> Result<void> {
    const auto id = ParseName(request->name(), "grooms", "name");
    if (!id) return id.error();
    return library_.store().Delete(*id);
  });
}

grpc::ServerWriteReactor<v1::ExportGroomResponse>* GroomService::ExportGroom(
    grpc::CallbackServerContext* /*context*/, const v1::ExportGroomRequest* request) {
  auto parts = std::make_shared<ExportParts>(library_, *request);
  return ChunkStream<v1::ExportGroomResponse>::Start(requests_, [parts] { return parts->Next(); });
}

grpc::ServerUnaryReactor* GroomService::GetImportReport(grpc::CallbackServerContext* context,
                                                        const v1::GetImportReportRequest* request,
                                                        v1::ImportReport* response) {
  return Answer(context, requests_, [this, request, response]() -> Result<void> {
    auto report = library_.LoadImportReport(request->name(), "name");
    if (!report) return report.error();
    *response = *std::move(report);
    return {};
  });
}

grpc::ServerUnaryReactor* GroomService::ComputeRestShape(grpc::CallbackServerContext* context,
                                                         const v1::ComputeRestShapeRequest* request,
                                                         v1::ComputeRestShapeResponse* response) {
  return Answer(context, solving_, [this, request, response]() -> Result<void> {
    const auto groom = library_.Load(request->name(), "name");
    if (!groom) return groom.error();
    return ComputeRest(**groom, *request, solving_, response);
  });
}

}  // namespace mane::rpc
