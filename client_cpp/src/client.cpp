#include "mane/client.h"

#include <utility>

#include "convert.h"
#include "groom_upload.h"
#include "head_stream.h"
#include "status.h"
#include "transport.h"

namespace mane::inline client {
namespace {

constexpr int kPageSize = 1000;

}  // namespace

class Client::Impl {
 public:
  explicit Impl(std::shared_ptr<Transport> transport) : transport_(std::move(transport)) {}

  const std::shared_ptr<Transport>& transport() const { return transport_; }
  v1::GroomService::Stub& grooms() const { return transport_->grooms(); }

 private:
  std::shared_ptr<Transport> transport_;
};

Result<Client> Client::Connect(const ClientOptions& options) {
  auto transport = Transport::Connect(options);
  if (!transport) return transport.error();
  return Client(std::make_unique<Impl>(*transport));
}

Client::Client(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
Client::Client(Client&&) noexcept = default;
Client& Client::operator=(Client&&) noexcept = default;
Client::~Client() = default;

Result<GroomInfo> Client::CreateGroom(const GroomUpload& upload) {
  grpc::ClientContext context;
  impl_->transport()->PrepareCall(context);
  v1::Groom groom;
  auto writer = impl_->grooms().CreateGroom(&context, &groom);
  ForEachPart(upload, [&](const v1::CreateGroomRequest& part) { return writer->Write(part); });
  writer->WritesDone();
  const grpc::Status status = writer->Finish();
  if (!status.ok()) return ToError(status);
  return FromProto(groom);
}

Result<GroomInfo> Client::GetGroom(const std::string& name) {
  grpc::ClientContext context;
  impl_->transport()->PrepareCall(context);
  v1::GetGroomRequest request;
  request.set_name(name);
  v1::Groom groom;
  const grpc::Status status = impl_->grooms().GetGroom(&context, request, &groom);
  if (!status.ok()) return ToError(status);
  return FromProto(groom);
}

Result<std::vector<GroomInfo>> Client::ListGrooms() {
  std::vector<GroomInfo> grooms;
  v1::ListGroomsRequest request;
  request.set_page_size(kPageSize);
  do {
    grpc::ClientContext context;
    impl_->transport()->PrepareCall(context);
    v1::ListGroomsResponse page;
    const grpc::Status status = impl_->grooms().ListGrooms(&context, request, &page);
    if (!status.ok()) return ToError(status);
    for (const v1::Groom& groom : page.grooms()) grooms.push_back(FromProto(groom));
    request.set_page_token(page.next_page_token());
  } while (!request.page_token().empty());
  return grooms;
}

Result<void> Client::DeleteGroom(const std::string& name) {
  grpc::ClientContext context;
  impl_->transport()->PrepareCall(context);
  v1::DeleteGroomRequest request;
  request.set_name(name);
  google::protobuf::Empty empty;
  const grpc::Status status = impl_->grooms().DeleteGroom(&context, request, &empty);
  if (!status.ok()) return ToError(status);
  return {};
}

Result<GroomHairs> Client::GetHairs(const std::string& name) {
  grpc::ClientContext context;
  impl_->transport()->PrepareCall(context);
  v1::ExportGroomRequest request;
  request.set_name(name);
  const auto reader = impl_->grooms().ExportGroom(&context, request);
  GroomHairs out;
  v1::ExportGroomResponse part;
  while (reader->Read(&part)) {
    if (part.has_groom()) out.hairs.offset_unit_m = part.groom().hair_offset_unit_m();
    for (const v1::Guide& guide : part.guides().guides()) {
      const v1::Quaternion& q = guide.root_frame();
      out.root_frames.push_back(guide.has_root_frame() ? Quaternion{q.x(), q.y(), q.z(), q.w()}
                                                       : Quaternion());
    }
    AppendNumbers(part.hairs().guides(), out.hairs.guides);
    AppendNumbers(part.hairs().point_counts(), out.hairs.point_counts);
    AppendNumbers(part.hairs().places(), out.hairs.places);
    AppendNumbers(part.hairs().colours(), out.hairs.colours);
  }
  const grpc::Status status = reader->Finish();
  if (!status.ok()) return ToError(status);
  return out;
}

Result<ImportReport> Client::GetImportReport(const std::string& name) {
  grpc::ClientContext context;
  impl_->transport()->PrepareCall(context);
  v1::GetImportReportRequest request;
  request.set_name(name);
  v1::ImportReport report;
  const grpc::Status status = impl_->grooms().GetImportReport(&context, request, &report);
  if (!status.ok()) return ToError(status);
  return FromProto(report);
}

Result<RestShape> Client::ComputeRestShape(const std::string& name,
                                           const RestShapeOptions& options) {
  grpc::ClientContext context;
  impl_->transport()->PrepareCall(context);
  v1::ComputeRestShapeRequest request;
  request.set_name(name);
  *request.mutable_head_orientation() = ToProto(options.head_orientation);
  *request.mutable_gravity() = ToProto(options.gravity);
  request.set_points_per_guide(options.points_per_guide);
  v1::ComputeRestShapeResponse response;
  const grpc::Status status = impl_->grooms().ComputeRestShape(&context, request, &response);
  if (!status.ok()) return ToError(status);
  return RestShape{response.points_per_guide(), Numbers<double>(response.positions()),
                   Numbers<double>(response.curvatures()), Numbers<double>(response.residuals())};
}

Head Client::OpenHead(const HeadOptions& options) {
  auto stream = std::make_shared<HeadStream>(impl_->transport(), options);
  stream->Open();
  return Head(std::move(stream));
}

}  // namespace mane::inline client
