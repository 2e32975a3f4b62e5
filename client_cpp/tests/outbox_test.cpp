// Properties of the outbox: it holds the newest of each kind, in an order that keeps the meaning.

#include "outbox.h"

#include <gtest/gtest.h>

namespace mane {
namespace {

Pose At(double x) {
  Pose pose;
  pose.position.x = x;
  return pose;
}

TEST(Outbox, KeepsOnlyTheNewestPose) {
  Outbox outbox;
  EXPECT_TRUE(outbox.empty());
  for (int i = 1; i <= 1000; ++i) outbox.PutPose(i, At(i));
  const auto message = outbox.Take();
  EXPECT_EQ(message.pose().time_s(), 1000);
  EXPECT_EQ(message.pose().pose().position().x(), 1000);
  EXPECT_EQ(message.pose().pose().orientation().w(), 1);
  EXPECT_TRUE(outbox.empty());
}

TEST(Outbox, PosesCarryBodies) {
  Outbox outbox;
  outbox.PutTeleport(1, At(1), {{"hand", At(5)}});
  outbox.PutPose(2, At(2), {{"hand", At(6)}, {"hat", At(7)}});
  EXPECT_EQ(outbox.Take().teleport().bodies(0).pose().position().x(), 5);
  const auto message = outbox.Take();
  ASSERT_EQ(message.pose().bodies_size(), 2);
  EXPECT_EQ(message.pose().bodies(1).name(), "hat");
  EXPECT_EQ(message.pose().bodies(1).pose().position().x(), 7);
}

TEST(Outbox, SendsChangesBeforeThePoseTheyWereMadeFor) {
  Outbox outbox;
  outbox.PutPose(1, At(1));
  outbox.PutReset();
  outbox.PutEnvironment({.wind_velocity = Vector3{1, 2, 3}});
  EXPECT_EQ(outbox.Take().kind_case(), v1::AnimateRequest::kEnvironment);
  EXPECT_EQ(outbox.Take().kind_case(), v1::AnimateRequest::kReset);
  EXPECT_EQ(outbox.Take().kind_case(), v1::AnimateRequest::kPose);
  EXPECT_TRUE(outbox.empty());
}

TEST(Outbox, ATeleportReplacesOlderPosesAndComesBeforeNewerOnes) {
  Outbox outbox;
  outbox.PutPose(1, At(1));
  outbox.PutTeleport(2, At(2));
  outbox.PutPose(3, At(3));
  EXPECT_EQ(outbox.Take().teleport().time_s(), 2);
  EXPECT_EQ(outbox.Take().pose().time_s(), 3);
  EXPECT_TRUE(outbox.empty());

  outbox.PutPose(4, At(4));
  outbox.PutTeleport(5, At(5));
  EXPECT_EQ(outbox.Take().teleport().time_s(), 5);
  EXPECT_TRUE(outbox.empty());
}

TEST(Outbox, KeepsTheNewestModelAndTheNewestBeams) {
  Outbox outbox;
  outbox.PutPose(1, At(1));
  outbox.PutModel(AnimationModel::kBeam, BeamMotion{.segments = 12, .epsilon = {0.5F}});
  outbox.PutModel(AnimationModel::kSuperHelix, {});
  const auto message = outbox.Take();
  EXPECT_EQ(message.model().model(), v1::ANIMATION_MODEL_SUPER_HELIX);
  EXPECT_EQ(message.model().beam().segments(), 12U);
  EXPECT_EQ(message.model().beam().epsilon(0), 0.5F);
  EXPECT_FALSE(message.model().beam().has_hold());
  EXPECT_TRUE(outbox.Take().has_pose());
  EXPECT_TRUE(outbox.empty());
}

TEST(Outbox, MergesEnvironmentsFieldByField) {
  Outbox outbox;
  outbox.PutEnvironment({.wind_velocity = Vector3{1, 0, 0}, .air_drag_scale = 2});
  outbox.PutEnvironment({.wind_velocity = Vector3{0, 0, 5}, .gravity = Vector3{0, -1, 0}});
  const auto message = outbox.Take();
  EXPECT_EQ(message.environment().wind_velocity().x(), 0);
  EXPECT_EQ(message.environment().wind_velocity().z(), 5);
  EXPECT_EQ(message.environment().gravity().y(), -1);
  EXPECT_EQ(message.environment().air_drag_scale(), 2);
  EXPECT_FALSE(message.environment().has_internal_friction_scale());
  EXPECT_TRUE(outbox.empty());
}

}  // namespace
}  // namespace mane
