// Streams that break, come back, are taken over or stay away, and what becomes of their heads.

#include <gtest/gtest.h>

#include "session/test_heads.h"

namespace mane::session {
namespace {

class ResumeTest : public RegistryTest {};

TEST_F(ResumeTest, ABrokenStreamComesBackToItsHead) {
  Registry registry({.max_heads = 10, .resume_grace = 60}, pool_, pool_);
  TestStream first, second;
  const auto head = Open(registry, first, Pacing::kRealtime);
  ASSERT_TRUE(first.WaitForFrames(3));
  registry.Leave(head, &first);
  const uint64_t next = head->next_frame();
  second.Follow(head);
  const auto resumed = registry.Resume(token_, &second);
  ASSERT_TRUE(resumed);
  EXPECT_EQ(resumed->head, head);
  ASSERT_TRUE(second.WaitForFrames(1));
  // One that was being computed when the stream broke may have waited in the mailbox.
  EXPECT_GE(second.frames().front()->index + 2, next);
  EXPECT_FALSE(registry.Resume("no such token", &second));
  registry.Close(head, &second);
  const auto gone = registry.Resume(token_, &second);
  ASSERT_FALSE(gone);
  EXPECT_EQ(gone.error().code, ErrorCode::kNotFound);
}

TEST_F(ResumeTest, ResumingTakesTheHeadFromAStreamThatStillHoldsIt) {
  Registry registry({}, pool_, pool_);
  TestStream first, second;
  const auto head = Open(registry, first, Pacing::kRealtime);
  second.Follow(head);
  ASSERT_TRUE(registry.Resume(token_, &second));
  ASSERT_TRUE(first.WaitFor([](const TestStream& s) { return s.end_.has_value(); }));
  EXPECT_EQ(first.end_->code, ErrorCode::kCancelled);
  registry.Leave(head, &first);  // Too late to matter.
  ASSERT_TRUE(second.WaitForFrames(2));
  registry.Close(head, &second);
}

TEST_F(ResumeTest, AStreamThatComesToAnEndedHeadIsTold) {
  LevelLibrary levels(pool_);
  BeamLibrary beams(pool_);
  const auto head =
      std::make_shared<HeadSession>("heads/1", Asset{groom_}, HeadOptions(), pool_, levels, beams);
  head->End({ErrorCode::kUnavailable, "the server is stopping", ""});
  head->End({ErrorCode::kInternal, "too late", ""});
  TestStream stream;
  head->Attach(&stream);
  ASSERT_TRUE(stream.end_);
  EXPECT_EQ(stream.end_->code, ErrorCode::kUnavailable);
}

TEST_F(ResumeTest, HeadsWithoutAStreamExpire) {
  Registry registry({.max_heads = 10, .resume_grace = 0.01}, pool_, pool_);
  TestStream stream;
  const auto head = Open(registry, stream, Pacing::kRealtime);
  registry.Leave(head, &stream);
  EXPECT_TRUE(WaitUntil([&] { return registry.head_count() == 0; }));
  EXPECT_FALSE(registry.Resume(token_, &stream));
  EXPECT_FALSE(head->Submit(Pose(1)));
}

TEST_F(ResumeTest, ALockstepHeadExpiresUnlessItsStreamComesBack) {
  Registry registry({.max_heads = 10, .resume_grace = 0.05}, pool_, pool_);
  TestStream first;
  const auto back = Open(registry, first, Pacing::kLockstep);
  const std::string token = token_;
  for (int round = 0; round < 3; ++round) {  // After the first, the clock has nothing else to do.
    TestStream second;
    const auto gone = Open(registry, second, Pacing::kLockstep);
    registry.Leave(back, &first);
    registry.Leave(gone, &second);
    ASSERT_TRUE(registry.Resume(token, &first));
    ASSERT_TRUE(WaitUntil([&] { return registry.head_count() == 1; }));
    EXPECT_FALSE(gone->Submit(Pose(1)));
    EXPECT_TRUE(back->Submit(Pose(round + 1)));
  }
  registry.Close(back, &first);
}

TEST_F(ResumeTest, OpeningAgainWithARequestIdReplacesTheLostTry) {
  Registry registry({}, pool_, pool_);
  TestStream lost, again;
  Open(registry, lost, Pacing::kRealtime, "try-1");
  const auto head = Open(registry, again, Pacing::kRealtime, "try-1");
  ASSERT_TRUE(lost.WaitFor([](const TestStream& s) { return s.end_.has_value(); }));
  EXPECT_EQ(registry.head_count(), 1);
  ASSERT_TRUE(again.WaitForFrames(2));
  registry.Close(head, &again);
}

TEST_F(ResumeTest, ManyStreamsComeAndGoAtOnce) {
  Registry registry({.max_heads = 64, .resume_grace = 0.02}, pool_, pool_);
  std::vector<std::jthread> clients;
  for (int c = 0; c < 6; ++c) {
    clients.emplace_back([&, c] {
      for (int round = 0; round < 15; ++round) {
        TestStream stream;
        HeadOptions options;
        options.pacing = (c + round) % 2 == 0 ? Pacing::kRealtime : Pacing::kLockstep;
        options.rate_hz = 240;
        const auto opened = registry.Open({groom_}, options, "", &stream);
        ASSERT_TRUE(opened);
        stream.Follow(opened->head);
        for (int i = 0; i < 4; ++i) ASSERT_TRUE(opened->head->Submit(Pose(i)));
        ASSERT_TRUE(stream.WaitForFrames(2));
        if (round % 3 == 0) {
          registry.Leave(opened->head, &stream);  // The expiry races with what comes.
        } else {
          registry.Close(opened->head, &stream);
        }
      }
    });
  }
  clients.clear();
  EXPECT_TRUE(WaitUntil([&] { return registry.head_count() == 0; }));
}

}  // namespace
}  // namespace mane::session
