#pragma once

#include <grpcpp/grpcpp.h>

#include "mane/v1/groom.grpc.pb.h"
#include "rpc/groom_library.h"
#include "rpc/uploads.h"

namespace mane::rpc {

// CreateGroom is raw: a typed stream would take a damaged message for the end of the upload.
using GroomServiceBase = v1::GroomService::WithRawCallbackMethod_CreateGroom<
    v1::GroomService::WithCallbackMethod_GetGroom<v1::GroomService::WithCallbackMethod_ListGrooms<
        v1::GroomService::WithCallbackMethod_DeleteGroom<
            v1::GroomService::WithCallbackMethod_ExportGroom<
                v1::GroomService::WithCallbackMethod_GetImportReport<
                    v1::GroomService::WithCallbackMethod_ComputeRestShape<
                        v1::GroomService::Service>>>>>>>;

/// mane.v1.GroomService over a GroomLibrary. Quick work runs on `requests`; uploads and rest
/// shapes, which may take a minute, on `solving`, which is that of `uploads` too.
class GroomService final : public GroomServiceBase {
 public:
  GroomService(GroomLibrary& library, exec::WorkerPool& requests, exec::WorkerPool& solving,
               Uploads& uploads)
      : library_(library), requests_(requests), solving_(solving), uploads_(uploads) {}

  grpc::ServerReadReactor<grpc::ByteBuffer>* CreateGroom(grpc::CallbackServerContext* context,
                                                         grpc::ByteBuffer* response) override;
  grpc::ServerUnaryReactor* GetGroom(grpc::CallbackServerContext* context,
                                     const v1::GetGroomRequest* request,
                                     v1::Groom* response) override;
  grpc::ServerUnaryReactor* ListGrooms(grpc::CallbackServerContext* context,
                                       const v1::ListGroomsRequest* request,
                                       v1::ListGroomsResponse* response) override;
  grpc::ServerUnaryReactor* DeleteGroom(grpc::CallbackServerContext* context,
                                        const v1::DeleteGroomRequest* request,
                                        google::protobuf::Empty* response) override;
  grpc::ServerWriteReactor<v1::ExportGroomResponse>* ExportGroom(
      grpc::CallbackServerContext* context, const v1::ExportGroomRequest* request) override;
  grpc::ServerUnaryReactor* GetImportReport(grpc::CallbackServerContext* context,
                                            const v1::GetImportReportRequest* request,
                                            v1::ImportReport* response) override;
  grpc::ServerUnaryReactor* ComputeRestShape(grpc::CallbackServerContext* context,
                                             const v1::ComputeRestShapeRequest* request,
                                             v1::ComputeRestShapeResponse* response) override;

 private:
  GroomLibrary& library_;
  exec::WorkerPool& requests_;
  exec::WorkerPool& solving_;
  Uploads& uploads_;
};

}  // namespace mane::rpc
