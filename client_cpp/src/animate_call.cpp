#include "animate_call.h"

#include <utility>

namespace mane::inline client {

AnimateCall* AnimateCall::Start(const Transport& transport, std::shared_ptr<Events> events,
                                v1::AnimateRequest first) {
  auto* call = new AnimateCall(std::move(events));
  transport.Authorize(call->context_);
  transport.animation().async()->Animate(&call->context_, call);
  call->AddHold();  // Removed when the reads end.
  call->StartRead(&call->response_);
  call->Write(std::move(first));
  call->StartCall();
  return call;
}

void AnimateCall::Write(v1::AnimateRequest request) {
  request_ = std::move(request);
  StartWrite(&request_);
}

void AnimateCall::OnReadDone(bool ok) {
  if (ok) {
    events_->OnResponse(response_);
    StartRead(&response_);
  } else {
    events_->OnReadsEnded();
    RemoveHold();
  }
}

void AnimateCall::OnWriteDone(bool ok) {
  if (ok) events_->OnWritten();  // Otherwise the stream is over, which the read will tell.
}

void AnimateCall::OnDone(const grpc::Status& status) {
  const auto events = std::move(events_);
  events->OnCallDone(std::unique_ptr<AnimateCall>(this), status);
}

}  // namespace mane::inline client
