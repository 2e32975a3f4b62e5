// The client's clock is found from the arrivals, whatever the delay's jitter; poses follow it.

#include "session/motion_buffer.h"

#include <gtest/gtest.h>

#include "math/random.h"

namespace mane::session {
namespace {

math::Pose At(double x) { return {{x, 0, 0}, math::FromRotationVector({0, x, 0})}; }

TEST(MotionBufferTest, ClientTimeIsServerTimeLessTheShortestDelay) {
  // The client's clock is 1000 s behind; delays are 2 ms and up to 20 ms of jitter.
  math::RandomStream random(7, 0);
  MotionBuffer buffer;
  double now = 0;
  for (int i = 0; i < 500; ++i) {
    const double time = i / 60.0;
    now = time + 1000 + 0.002 + 0.02 * random.Uniform();
    buffer.Add(time, At(time), now);
  }
  // 128 draws miss the lowest twentieth of the jitter with probability 0.95^128 < 0.002.
  EXPECT_NEAR(buffer.ClientTime(2000), 2000 - 1000 - 0.002, 0.001);
  EXPECT_LE(buffer.ClientTime(2000), 2000 - 1000 - 0.002);
}

TEST(MotionBufferTest, AClockThatStoppedForAWhileIsFollowed) {
  MotionBuffer buffer;
  for (int i = 0; i < 200; ++i) buffer.Add(i / 60.0, At(0), 50 + i / 60.0);
  for (int i = 200; i < 200 + MotionBuffer::kMemory; ++i) {
    buffer.Add(i / 60.0, At(0), 50 + 5 + i / 60.0);  // Five seconds lost.
  }
  EXPECT_NEAR(buffer.ClientTime(100), 45, 1e-9);
}

TEST(MotionBufferTest, PosesAreInterpolatedByTime) {
  MotionBuffer buffer;
  for (double t : {0.0, 0.5, 2.0}) buffer.Add(t, At(t), t);
  for (double t : {0.0, 0.1, 0.5, 1.3, 2.0}) {
    EXPECT_NEAR(buffer.At(t).p.x(), t, 1e-15) << t;
    EXPECT_NEAR(math::RotationVector(buffer.At(t).q).y(), t, 1e-12) << t;
  }
  EXPECT_EQ(buffer.At(-1).p.x(), 0);
}

TEST(MotionBufferTest, MotionGoesOnForATenthOfASecondAndNoLonger) {
  MotionBuffer buffer;
  buffer.Add(1, At(1), 1);
  EXPECT_EQ(buffer.At(5).p.x(), 1);  // One pose tells no speed.
  buffer.Add(1.1, At(1.1), 1.1);
  EXPECT_NEAR(buffer.At(1.15).p.x(), 1.15, 1e-12);
  EXPECT_NEAR(buffer.At(1.2).p.x(), 1.2, 1e-12);
  EXPECT_NEAR(buffer.At(60).p.x(), 1.2, 1e-12);
}

TEST(MotionBufferTest, NoiseInPosesAtNearlyOneTimeIsNoSpeed) {
  for (const double gap : {1e-6, 1e-4, 5e-3}) {
    MotionBuffer buffer;
    buffer.Add(1, At(0), 1);
    buffer.Add(1 + gap, At(0.01), 1);
    EXPECT_EQ(buffer.At(2).p.x(), 0.01) << gap;  // Too short a baseline: held.
    buffer.Add(1.02, At(0.02), 1.02);
    buffer.Add(1.02 + gap, At(0.021), 1.02);
    // At most 2 cm in the 15 ms or more to the pose before: a tenth of a second carries 0.14 m.
    EXPECT_LT(buffer.At(2).p.x(), 0.021 + 0.1 * 0.021 / 0.015) << gap;
  }
}

TEST(MotionBufferTest, ClearForgetsTheMotion) {
  MotionBuffer buffer;
  buffer.Add(1, At(1), 1);
  buffer.Add(2, At(2), 2);
  buffer.Clear();
  EXPECT_TRUE(buffer.empty());
  buffer.Add(3, At(9), 3);
  EXPECT_EQ(buffer.At(3.05).p.x(), 9);
}

}  // namespace
}  // namespace mane::session
