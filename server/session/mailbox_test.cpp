// Real time: newest wins, the window bounds what is under way, and skips are counted. Ordered: all
// frames in order.

#include "session/mailbox.h"

#include <gtest/gtest.h>

namespace mane::session {
namespace {

FramePtr MakeFrame(uint64_t index) {
  auto frame = std::make_shared<Frame>();
  frame->index = index;
  return frame;
}

TEST(MailboxTest, NewestWinsAndSkipsAreCounted) {
  Mailbox mailbox = Mailbox::Newest(3);
  EXPECT_EQ(mailbox.Take().frame, nullptr);
  for (uint64_t i = 1; i <= 5; ++i) mailbox.Put(MakeFrame(i));
  EXPECT_EQ(mailbox.size(), 1);
  const OutgoingFrame first = mailbox.Take();
  EXPECT_EQ(first.frame->index, 5u);
  EXPECT_EQ(first.skipped, 4u);
  mailbox.Put(MakeFrame(6));
  EXPECT_EQ(mailbox.Take().skipped, 0u);
}

TEST(MailboxTest, AtMostTheWindowIsUnderWay) {
  Mailbox mailbox = Mailbox::Newest(2);
  for (uint64_t i = 1; i <= 2; ++i) {
    mailbox.Put(MakeFrame(i));
    EXPECT_NE(mailbox.Take().frame, nullptr);
  }
  for (uint64_t i = 3; i <= 9; ++i) {
    mailbox.Put(MakeFrame(i));
    EXPECT_EQ(mailbox.Take().frame, nullptr);
  }
  ASSERT_TRUE(mailbox.Acknowledge(1));
  EXPECT_EQ(mailbox.Take().frame->index, 9u);
  mailbox.Put(MakeFrame(10));
  EXPECT_EQ(mailbox.Take().frame, nullptr);  // 2 and 9 are under way.
  ASSERT_TRUE(mailbox.Acknowledge(9));       // Acknowledges both.
  EXPECT_NE(mailbox.Take().frame, nullptr);
}

TEST(MailboxTest, AcknowledgementsMustFitWhatWasSent) {
  Mailbox mailbox = Mailbox::Newest(3);
  mailbox.Put(MakeFrame(1));
  const auto early = mailbox.Acknowledge(1);
  ASSERT_FALSE(early);
  EXPECT_EQ(early.error().field, "acked_frame");
  (void)mailbox.Take();
  ASSERT_TRUE(mailbox.Acknowledge(1));
  ASSERT_TRUE(mailbox.Acknowledge(1));
  EXPECT_FALSE(mailbox.Acknowledge(0));
}

TEST(MailboxTest, ANewStreamHasTheWholeWindow) {
  Mailbox mailbox = Mailbox::Newest(1);
  mailbox.Put(MakeFrame(1));
  (void)mailbox.Take();
  mailbox.Put(MakeFrame(2));
  EXPECT_EQ(mailbox.Take().frame, nullptr);
  mailbox.Reconnect();
  EXPECT_EQ(mailbox.Take().frame, nullptr);  // What waited is stale.
  mailbox.Put(MakeFrame(3));
  const OutgoingFrame out = mailbox.Take();
  EXPECT_EQ(out.frame->index, 3u);
  EXPECT_EQ(out.skipped, 1u);
}

TEST(MailboxTest, OrderedKeepsAll) {
  Mailbox mailbox = Mailbox::Ordered();
  for (uint64_t i = 1; i <= 20; ++i) mailbox.Put(MakeFrame(i));
  for (uint64_t i = 1; i <= 20; ++i) {
    const OutgoingFrame out = mailbox.Take();
    EXPECT_EQ(out.frame->index, i);
    EXPECT_EQ(out.skipped, 0u);
  }
  EXPECT_EQ(mailbox.Take().frame, nullptr);
}

}  // namespace
}  // namespace mane::session
