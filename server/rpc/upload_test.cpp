// Uploads are bounded: in guides, in how many are under way, in how long one may be silent.

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <memory>
#include <thread>
#include <vector>

#include "rpc/test_server.h"

namespace mane::rpc {
namespace {

// An upload that goes on as long as this lives.
class OpenUpload {
 public:
  explicit OpenUpload(TestServer& server) : stub_(v1::GroomService::NewStub(server.channel())) {
    context_.set_deadline(std::chrono::system_clock::now() + std::chrono::seconds(60));
    writer_ = stub_->CreateGroom(&context_, &groom_);
  }
  ~OpenUpload() {
    context_.TryCancel();
    if (!ended_) (void)End();
  }

  bool Send(const v1::CreateGroomRequest& message) { return writer_->Write(message); }
  grpc::Status Commit() {
    v1::CreateGroomRequest commit;
    commit.mutable_commit();
    writer_->Write(commit);
    writer_->WritesDone();
    return End();
  }
  // How the server ended it; waits until it does.
  grpc::Status End() {
    ended_ = true;
    return writer_->Finish();
  }

 private:
  grpc::ClientContext context_;
  v1::Groom groom_;
  std::unique_ptr<v1::GroomService::Stub> stub_;
  std::unique_ptr<grpc::ClientWriter<v1::CreateGroomRequest>> writer_;
  bool ended_ = false;
};

TEST(UploadLimitTest, NoMoreAtOnceThanAllowed) {
  TestServer server({.max_uploads = 2});
  const auto messages = UploadOf({GoodGuide()});
  std::vector<std::unique_ptr<OpenUpload>> uploads;
  for (int i = 0; i < 3; ++i) {
    uploads.push_back(std::make_unique<OpenUpload>(server));
    uploads.back()->Send(messages[0]);
  }
  // One of them, most likely the last, can send no more.
  const auto late = std::chrono::steady_clock::now() + std::chrono::seconds(20);
  auto refused = uploads.end();
  while (refused == uploads.end() && std::chrono::steady_clock::now() < late) {
    refused = std::ranges::find_if(uploads, [&](auto& u) { return !u->Send(messages[1]); });
  }
  ASSERT_NE(refused, uploads.end());
  grpc::Status status = (*refused)->End();
  EXPECT_EQ(status.error_code(), grpc::StatusCode::RESOURCE_EXHAUSTED);
  EXPECT_TRUE(status.error_message().starts_with("2 uploads are under way"))
      << status.error_message();
  uploads.erase(refused);
  // The others go on, and leave room when they have ended.
  EXPECT_TRUE(uploads[0]->Commit().ok());
  uploads.pop_back();  // Cancelled.
  int admitted = 0;
  while (admitted < 2 && std::chrono::steady_clock::now() < late) {
    v1::Groom groom;
    admitted += server.Upload(messages, &groom).ok();
  }
  EXPECT_EQ(admitted, 2);
}

TEST(UploadLimitTest, ASilentClientIsNotWaitedForForever) {
  TestServer server({.max_upload_idle_s = 0.2});
  for (const size_t sent : {0, 1, 2}) {
    SCOPED_TRACE(sent);
    OpenUpload upload(server);
    const auto messages = UploadOf({GoodGuide()});
    for (size_t i = 0; i < sent; ++i) ASSERT_TRUE(upload.Send(messages[i]));
    const grpc::Status status = upload.End();
    EXPECT_EQ(status.error_code(), grpc::StatusCode::DEADLINE_EXCEEDED);
    EXPECT_TRUE(status.error_message().starts_with("no message of the upload came for 0.2 s"))
        << status.error_message();
  }
}

TEST(UploadLimitTest, AnUploadMayLastLongerThanOnePause) {
  TestServer server({.max_upload_idle_s = 1});
  OpenUpload upload(server);
  const auto messages = UploadOf({GoodGuide()});
  ASSERT_TRUE(upload.Send(messages[0]));
  for (int i = 0; i < 15; ++i) {  // 1.5 s and more.
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
    ASSERT_TRUE(upload.Send(messages[1]));
  }
  const grpc::Status status = upload.Commit();
  EXPECT_TRUE(status.ok()) << status.error_message();
}

TEST(UploadLimitTest, HugeGroomsAreRefused) {
  TestServer server({.max_groom_guides = 5});
  v1::Groom groom;
  const grpc::Status status =
      server.Upload(UploadOf(std::vector<v1::Guide>(6, GoodGuide())), &groom);
  EXPECT_EQ(status.error_code(), grpc::StatusCode::RESOURCE_EXHAUSTED);
  EXPECT_EQ(NamedField(status), "guides");
}

}  // namespace
}  // namespace mane::rpc
