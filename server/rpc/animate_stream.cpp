#include "rpc/animate_stream.h"

#include <utility>

#include "rpc/convert_animation.h"
#include "rpc/convert_model.h"
#include "rpc/raw.h"
#include "rpc/status.h"

namespace mane::rpc {
namespace {

// Notices waiting for a slow client; more are dropped.
constexpr size_t kMaxMessages = 16;

}  // namespace

AnimateStream* AnimateStream::Start(GroomLibrary& grooms, session::Registry& registry,
                                    exec::WorkerPool& requests, double resume_grace) {
  auto* stream = new AnimateStream(grooms, registry, requests, resume_grace);
  stream->self_.reset(stream);
  std::lock_guard lock(stream->mutex_);
  stream->ReadOnLocked();
  return stream;
}

void AnimateStream::OnReadDone(bool ok) {
  v1::AnimateRequest request;
  {
    std::lock_guard lock(mutex_);
    if (finished_ || status_) return;
    if (!ok) {
      half_closed_ = true;
      WriteOnLocked();
      return;
    }
  }
  // `reading_` stays set meanwhile: no other thread may start the next read into `incoming_`, nor
  // hand over the next message before this one.
  Result<void> handled = Parse(&incoming_, &request);
  if (handled) handled = Handle(request);
  std::lock_guard lock(mutex_);
  reading_ = false;
  if (!handled) return CloseLocked(ToStatus(handled.error()));
  ReadOnLocked();
}

Result<void> AnimateStream::Handle(const v1::AnimateRequest& request) {
  if (request.kind_case() == v1::AnimateRequest::kOpen) {
    if (std::exchange(open_asked_, true)) {
      return InvalidArgument("open", "open was sent twice; a stream animates one head");
    }
    StartOpening(request.open());
    return {};
  }
  if (!open_asked_) {
    return InvalidArgument("open", "the first message must be open");
  }
  if (const auto ok = head_->Acknowledge(request.acked_frame()); !ok) return ok.error();
  switch (request.kind_case()) {
    case v1::AnimateRequest::kPose:
    case v1::AnimateRequest::kTeleport: {
      const bool teleport = request.kind_case() == v1::AnimateRequest::kTeleport;
      auto pose = teleport ? ToPoseCommand(request.teleport(), "teleport", head_->groom())
                           : ToPoseCommand(request.pose(), "pose", head_->groom());
      if (!pose) return pose.error();
      pose->teleport = teleport;
      if (const auto ok = head_->Submit(*pose); !ok) return ok.error();
      break;
    }
    case v1::AnimateRequest::kReset:
      if (const auto ok = head_->Submit(session::ResetCommand{}); !ok) return ok.error();
      break;
    case v1::AnimateRequest::kEnvironment: {
      const auto change = ToEnvironmentCommand(request.environment(), "environment");
      if (!change) return change.error();
      if (const auto ok = head_->Submit(*change); !ok) return ok.error();
      break;
    }
    case v1::AnimateRequest::kModel:
      if (const auto ok = ChangeModel(request.model()); !ok) return ok.error();
      break;
    case v1::AnimateRequest::kAcknowledge:
    case v1::AnimateRequest::kOpen:
      break;
    case v1::AnimateRequest::KIND_NOT_SET:
      return InvalidArgument("kind", "the message holds neither a pose nor any other kind");
  }
  OnProgress();  // The acknowledgement may have made room for a frame.
  return {};
}

Result<void> AnimateStream::ChangeModel(const v1::SetModel& message) {
  const auto wanted =
      ToModelOptions(message, head_->options().view.format, head_->model().beam, "model.");
  if (!wanted) return wanted.error();
  if (const auto room = registry_.AdmitModel(head_, *wanted); !room) {
    OnNotice({session::Notice::Code::kModel, 0, head_->shown_model(),
              "the head keeps its model: " + room.error().message});
    return {};
  }
  return head_->Submit(session::ModelCommand{*wanted});
}

void AnimateStream::StartOpening(const v1::OpenHead& open) {
  {
    std::lock_guard lock(mutex_);
    opening_ = true;
  }
  const auto finish = [self = self_, open] { self->FinishOpening(self->Open(open)); };
  requests_.Post([self = self_, name = open.groom(), finish] {
    // Fields of meshes that nobody has used lately take seconds, which others need not wait for.
    if (exec::WorkerPool* const makers = self->MakersOf(name)) {
      makers->Post(finish);
    } else {
      finish();
    }
  });
}

exec::WorkerPool* AnimateStream::MakersOf(const std::string& groom) try {
  return grooms_.MakersOf(groom);
} catch (const std::exception&) {
  return nullptr;  // Open meets the same fault, and tells it.
}

Result<session::OpenedHead> AnimateStream::Open(const v1::OpenHead& open) try {
  if (!open.resume().empty()) return registry_.Resume(open.resume(), this);
  const auto options = ToHeadOptions(open);
  if (!options) return options.error();
  auto groom = grooms_.Load(open.groom(), "open.groom");
  if (!groom) return groom.error();
  // Before fields are made and hair settles for one who is not let in.
  if (const auto ok = registry_.Admit(**groom, *options, open.request_id()); !ok) return ok.error();
  const auto asset =
      grooms_.MakeAsset(*std::move(groom), "open.groom", [this] { return Ending(); });
  if (!asset) return asset.error();
  return registry_.Open(*asset, *options, open.request_id(), this);
} catch (const std::exception& fault) {
  return Error{ErrorCode::kInternal, fault.what(), ""};
}

bool AnimateStream::Ending() {
  std::lock_guard lock(mutex_);
  return status_.has_value();
}

void AnimateStream::FinishOpening(const Result<session::OpenedHead>& opened) {
  std::lock_guard lock(mutex_);
  opening_ = false;
  if (!opened) {
    CloseLocked(ToStatus(opened.error()));
    WriteOnLocked();
    return;
  }
  head_ = opened->head;
  messages_.push_back(DescribeOpened(*opened));
  WriteOnLocked();
  ReadOnLocked();
}

v1::AnimateResponse AnimateStream::DescribeOpened(const session::OpenedHead& opened) const {
  const session::HeadSession& head = *opened.head;
  const session::HeadOptions& options = head.options();
  const bool realtime = options.pacing == session::Pacing::kRealtime;
  v1::AnimateResponse response;
  v1::Opened* message = response.mutable_opened();
  message->set_head(head.name());
  if (realtime) {
    message->set_resume_token(opened.resume_token);
    message->set_resume_grace_s(resume_grace_);
    message->set_rate_hz(options.rate_hz);
  }
  message->set_guide_count(static_cast<uint32_t>(head.groom().guide_count()));
  message->set_element_count(static_cast<uint32_t>(head.groom().element_count()));
  message->set_points_per_guide(static_cast<uint32_t>(options.view.points_per_guide));
  message->set_format(FromFormat(options.view.format));
  message->set_space(FromSpace(options.view.space));
  message->set_next_frame(head.next_frame());
  message->set_model(FromModel(head.model().model));
  return response;
}

// --- writing and ending ---

void AnimateStream::OnWriteDone(bool ok) {
  std::lock_guard lock(mutex_);
  writing_ = false;
  if (!ok) {
    broken_ = true;
    CloseLocked(grpc::Status::CANCELLED);
  }
  WriteOnLocked();
  ReadOnLocked();
}

void AnimateStream::OnCancel() {
  std::lock_guard lock(mutex_);
  broken_ = true;
  CloseLocked(grpc::Status::CANCELLED);
}

void AnimateStream::OnDone() {
  // No task opens the head any more, so `head_` stands. Detaching waits for a sink call under way.
  if (head_ != nullptr) {
    if (broken_ && head_->options().pacing == session::Pacing::kRealtime) {
      registry_.Leave(head_, this);
    } else {
      registry_.Close(head_, this);
    }
  }
  self_.reset();
}

void AnimateStream::OnProgress() {
  std::lock_guard lock(mutex_);
  WriteOnLocked();
  ReadOnLocked();
}

void AnimateStream::OnNotice(const session::Notice& notice) {
  std::lock_guard lock(mutex_);
  if (messages_.size() >= kMaxMessages) return;
  FromNotice(notice, messages_.emplace_back().mutable_notice());
  WriteOnLocked();
}

void AnimateStream::OnEnd(const Error& error) {
  std::lock_guard lock(mutex_);
  CloseLocked(ToStatus(error));
}

void AnimateStream::ReadOnLocked() {
  if (reading_ || opening_ || half_closed_ || status_) return;
  if (head_ != nullptr && head_->Full()) return;
  reading_ = true;
  StartRead(&incoming_);
}

void AnimateStream::WriteOnLocked() {
  if (writing_ || finished_ || opening_) return;
  if (status_) {
    finished_ = true;
    Finish(*status_);
    return;
  }
  v1::AnimateResponse response;
  if (!messages_.empty()) {
    response = std::move(messages_.front());
    messages_.pop_front();
  } else if (head_ != nullptr) {
    const session::OutgoingFrame next = head_->TakeFrame();
    if (next.frame != nullptr) FromFrame(*next.frame, next.skipped, response.mutable_frame());
  }
  if (response.kind_case() != v1::AnimateResponse::KIND_NOT_SET) {
    outgoing_ = Serialize(response);
    writing_ = true;
    StartWrite(&outgoing_);
  } else if (half_closed_ && DrainedLocked()) {
    CloseLocked(grpc::Status::OK);
  }
}

bool AnimateStream::DrainedLocked() const {
  return head_ == nullptr || head_->options().pacing == session::Pacing::kRealtime ||
         head_->Backlog() == 0;
}

void AnimateStream::CloseLocked(const grpc::Status& status) {
  if (status_) return;
  status_ = status;
  WriteOnLocked();
}

}  // namespace mane::rpc
