// Where moving bodies are: named ones as the poses say, by time as the head is; others at rest on
// the head; those that a pose leaves out stay in the world.

#include <gtest/gtest.h>

#include "session/body_library.h"
#include "session/motion_buffer.h"
#include "session/test_heads.h"

namespace mane::session {
namespace {

using Eigen::Vector3d;

math::Pose At(double x) { return {{x, 0, 0}, math::FromRotationVector({0, x, 0})}; }

class BodyMotionTest : public RegistryTest {
 protected:
  // The hands' places on a head.
  Vector3d Left(const math::Pose& head) { return head * Vector3d(-0.3, 0, 0); }
  Vector3d Right(const math::Pose& head) { return head * Vector3d(0.3, 0, 0); }

  BodyLibrary library_{{}};
  std::shared_ptr<const groom::Groom> with_bodies_ = SampleGroomWithBodies(4, 4);
  std::shared_ptr<const head::Bodies> bodies_ = *library_.FindOrMake(with_bodies_);
};

TEST_F(BodyMotionTest, WhatIsNotNamedIsAtRestOnTheHead) {
  ASSERT_EQ(bodies_->moving_count, 2);
  const auto poses = PlaceBodies(bodies_.get(), At(0.5), {});
  ASSERT_EQ(poses.size(), 2u);
  EXPECT_LT((poses[0].p - Left(At(0.5))).norm(), 1e-15);
  EXPECT_LT((poses[1].p - Right(At(0.5))).norm(), 1e-15);
  const auto named = PlaceBodies(bodies_.get(), At(0.5), {At(7), {}});
  EXPECT_EQ(named[0].p, At(7).p);
  EXPECT_LT((named[1].p - Right(At(0.5))).norm(), 1e-15);
  EXPECT_TRUE(PlaceBodies(nullptr, At(0), {}).empty());
}

TEST_F(BodyMotionTest, APoseChangesThoseItNamesOnly) {
  BodyPoses poses;
  Apply({}, &poses);
  EXPECT_TRUE(poses.empty());
  Apply({At(1), {}}, &poses);
  Apply({{}, At(2)}, &poses);
  Apply({{}, {}}, &poses);
  ASSERT_EQ(poses.size(), 2u);
  EXPECT_EQ(poses[0]->p, At(1).p);
  EXPECT_EQ(poses[1]->p, At(2).p);
}

TEST_F(BodyMotionTest, NamedBodiesAreInterpolatedByTimeAsTheHeadIs) {
  MotionBuffer buffer(bodies_);
  for (double t : {0.0, 0.5, 2.0}) buffer.Add(t, At(0), t, {At(t), {}});
  for (double t : {-1.0, 0.1, 0.5, 1.3, 2.05, 60.0}) {
    const double shown = std::clamp(t, 0.0, 2.1);  // Carried on for a tenth of a second.
    const auto poses = buffer.BodiesAt(t);
    EXPECT_NEAR(poses[0].p.x(), shown, 1e-12) << t;
    EXPECT_NEAR(math::RotationVector(poses[0].q).y(), shown, 1e-12) << t;
    EXPECT_LT((poses[1].p - Right(At(0))).norm(), 1e-15) << t;
  }
}

TEST_F(BodyMotionTest, UnnamedBodiesGoWithTheHeadRigidly) {
  MotionBuffer buffer(bodies_);
  for (double t : {0.0, 0.5}) buffer.Add(t, At(2 * t), t);
  for (double t : {0.0, 0.2, 0.55}) {
    EXPECT_LT((buffer.BodiesAt(t)[0].p - Left(buffer.At(t))).norm(), 1e-15) << t;
  }
}

TEST_F(BodyMotionTest, ABodyNamedForTheFirstTimeComesFromItsPlaceOnTheHead) {
  MotionBuffer buffer(bodies_);
  buffer.Add(0, At(0.2), 0);
  buffer.Add(1, At(0.4), 1, {At(5), {}});
  EXPECT_LT((buffer.BodiesAt(0)[0].p - Left(At(0.2))).norm(), 1e-12);
  EXPECT_LT((buffer.BodiesAt(0.5)[0].p - (Left(At(0.2)) + At(5).p) / 2).norm(), 1e-12);
  EXPECT_LT((buffer.BodiesAt(1)[0].p - At(5).p).norm(), 1e-12);
}

// Plays eight poses that name the right hand now and then, and a cut.
void Play(HeadSession& head, TestStream& stream, const PoseCommand (&poses)[8]) {
  for (int i = 0; i < 8; ++i) {
    PoseCommand pose = poses[i];
    if (i % 3 == 0) pose.bodies = {{}, At(0.01 * i)};
    pose.teleport = i == 5;
    ASSERT_TRUE(head.Submit(pose));
  }
  // Real time sends no more than three that are not acknowledged.
  ASSERT_TRUE(stream.WaitForFrames(head.options().pacing == Pacing::kLockstep ? 8 : 3));
}

TEST_F(BodyMotionTest, HeadsWithBodiesMoveAndLockstepIsTheSameBitsEveryTime) {
  const PoseCommand poses[8] = {Pose(1), Pose(2), Pose(3), Pose(4),
                                Pose(5), Pose(6), Pose(7), Pose(8)};
  std::vector<std::string> runs[3];
  for (int run = 0; run < 3; ++run) {
    Registry registry({}, pool_, pool_);
    TestStream stream;
    HeadOptions options;
    options.pacing = run < 2 ? Pacing::kLockstep : Pacing::kRealtime;
    const auto opened = registry.Open({with_bodies_, bodies_}, options, "", &stream);
    ASSERT_TRUE(opened);
    stream.Follow(opened->head);
    Play(*opened->head, stream, poses);
    for (const FramePtr& frame : stream.frames()) {
      EXPECT_EQ(frame->repaired_guides, 0);
      runs[run].push_back(frame->data);
    }
    registry.Close(opened->head, &stream);
  }
  EXPECT_EQ(runs[0], runs[1]);
}

}  // namespace
}  // namespace mane::session
