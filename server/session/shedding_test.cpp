// When a head goes over to cheaper hair:
//   window      late frames count within a second, and only together
//   calm        it stays until no frame has been late for a while
//   trial       where that did not last, the next time takes twice as long, up to a limit

#include "session/shedding.h"

#include <gtest/gtest.h>

namespace mane::session {
namespace {

TEST(SheddingTest, TenLateFramesWithinASecondAreTooMany) {
  Shedding shedding;
  for (int i = 0; i < 9; ++i) shedding.Late(10 + 0.1 * i, 1);
  EXPECT_FALSE(shedding.Update(10.9));
  shedding.Late(10.95, 1);
  EXPECT_TRUE(shedding.Update(10.95));
}

TEST(SheddingTest, LateFramesAreForgottenAfterASecond) {
  Shedding shedding;
  for (int i = 0; i < 100; ++i) {
    shedding.Late(10 + 0.12 * i, 1);  // Eight or nine a second, for ever.
    EXPECT_FALSE(shedding.Update(10 + 0.12 * i)) << i;
  }
  EXPECT_FALSE(Shedding().Update(0));
}

TEST(SheddingTest, SeveralMissedAtOnceCountEach) {
  Shedding shedding;
  shedding.Late(1, 12);
  EXPECT_TRUE(shedding.Update(1));
}

TEST(SheddingTest, ItComesBackAfterFiveCalmSeconds) {
  Shedding shedding;
  shedding.Late(1, 10);
  ASSERT_TRUE(shedding.Update(1));
  shedding.Late(4, 1);  // One is enough to wait on.
  EXPECT_TRUE(shedding.Update(8.9));
  EXPECT_FALSE(shedding.Update(9));
  EXPECT_FALSE(shedding.Update(9.1));
}

TEST(SheddingTest, WhatDidNotLastTakesTwiceAsLongUpToAMinute) {
  Shedding shedding;
  double now = 100;
  for (const double calm : {5.0, 10.0, 20.0, 40.0, 60.0, 60.0}) {
    shedding.Late(now, 10);
    ASSERT_TRUE(shedding.Update(now));
    EXPECT_TRUE(shedding.Update(now + calm - 0.01)) << calm;
    EXPECT_FALSE(shedding.Update(now + calm)) << calm;
    now += calm + 1;
  }
  now += 100;  // This time it lasted.
  shedding.Late(now, 10);
  ASSERT_TRUE(shedding.Update(now));
  EXPECT_FALSE(shedding.Update(now + 5));
}

}  // namespace
}  // namespace mane::session
