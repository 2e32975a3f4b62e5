#include "export_call.h"

#include <utility>

namespace mane::inline client {

ExportCall* ExportCall::Start(const Transport& transport, const std::string& groom, Done done) {
  auto* call = new ExportCall(std::move(done));
  transport.PrepareCall(call->context_);
  call->request_.set_name(groom);
  call->request_.set_omit_hairs(true);
  transport.grooms().async()->ExportGroom(&call->context_, &call->request_, call);
  call->StartRead(&call->response_);
  call->StartCall();
  return call;
}

void ExportCall::OnReadDone(bool ok) {
  if (!ok) return;
  for (const v1::Guide& guide : response_.guides().guides()) {
    guides_.push_back(GuideGeometry::From(guide));
  }
  StartRead(&response_);
}

void ExportCall::OnDone(const grpc::Status& status) {
  const Done done = std::move(done_);
  done(std::unique_ptr<ExportCall>(this), status);
}

}  // namespace mane::inline client
