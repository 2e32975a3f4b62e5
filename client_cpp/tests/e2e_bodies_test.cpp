// Bodies that hair meets, through the client and the real daemon: what was uploaded is told, what
// is bad is refused by name, and poses place those that move.

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "daemon.h"
#include "test_hair.h"

namespace mane::client_test {
namespace {

// A tetrahedron with sides of 10 cm; `open` lacks its largest one.
TriangleMesh Tetrahedron(bool open = false) {
  TriangleMesh mesh{{0, 0, 0, .1f, 0, 0, 0, .1f, 0, 0, 0, .1f}, {0, 2, 1, 0, 1, 3, 0, 3, 2}, {}};
  if (!open) mesh.triangles.insert(mesh.triangles.end(), {1, 2, 3});
  return mesh;
}

GroomUpload GroomWithBodies() {
  GroomUpload upload = WavyGroom(6);
  upload.bodies = {{.name = "prop", .shape = Tetrahedron(), .material = Material::kPolished},
                   {.name = "hand", .shape = CapsuleBody{{}, {}, 0.05}, .moving = true}};
  return upload;
}

// Positions of ten frames that a hand passes, named in every other one.
std::vector<std::vector<float>> Play(Client& client, const std::string& groom) {
  HeadOptions options;
  options.groom = groom;
  options.pacing = Pacing::kLockstep;
  Head head = client.OpenHead(options);
  std::vector<std::vector<float>> frames;
  for (int i = 0; i < 10; ++i) {
    std::vector<BodyPose> bodies;
    if (i % 2 == 0) bodies = {{"hand", Pose{{0.3 - 0.03 * i, 0.1, 0}, {}}}};
    const double t = i / 60.0;
    const auto frame =
        i == 5 ? head.StepTeleport(t, MotionAt(t + 5), bodies) : head.Step(t, MotionAt(t), bodies);
    EXPECT_TRUE(frame) << frame.error().message;
    if (frame) frames.push_back((*frame)->positions);
  }
  return frames;
}

TEST(E2eBodies, TheServerTellsWhatHairMeets) {
  Daemon daemon;
  Client client = daemon.Connect();
  GroomUpload upload = GroomWithBodies();
  upload.scalp = EllipsoidScalp{.radii_m = {0.08, 0.1, 0.09}};
  upload.scalp_contact = ScalpContact{.material = Material::kSkin};
  const auto made = client.CreateGroom(upload);
  ASSERT_TRUE(made) << made.error().message;
  const auto told = client.GetGroom(made->name);
  ASSERT_TRUE(told);
  EXPECT_EQ(told->body_count, 2u);
  ASSERT_EQ(told->bodies.size(), 2u);
  EXPECT_EQ(told->bodies[0].name, "prop");
  EXPECT_EQ(told->bodies[0].shape, BodySummary::Shape::kMesh);
  ASSERT_TRUE(told->bodies[0].mesh);
  EXPECT_EQ(told->bodies[0].mesh->triangles, 4u);
  EXPECT_GT(told->bodies[0].mesh->bytes, 0u);
  EXPECT_TRUE(told->bodies[1].moving);
  EXPECT_FALSE(told->bodies[1].mesh);
  ASSERT_TRUE(told->scalp_contact);
  EXPECT_EQ(told->scalp_contact->friction, 0.4);
}

TEST(E2eBodies, AMeshThatBoundsNoSolidIsRefusedByName) {
  Daemon daemon;
  Client client = daemon.Connect();
  GroomUpload upload = GroomWithBodies();
  upload.bodies[0].shape = Tetrahedron(true);
  const auto refused = client.CreateGroom(upload);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, ErrorCode::kInvalidArgument);
  EXPECT_EQ(refused.error().field, "bodies[0].mesh.triangles");
  EXPECT_NE(refused.error().message.find("\"prop\""), std::string::npos);
}

TEST(E2eBodies, LockstepWithAMovingBodyReplaysBitForBit) {
  Daemon daemon;
  Client client = daemon.Connect();
  const std::string groom = Create(client, GroomWithBodies());
  const auto frames = Play(client, groom);
  EXPECT_EQ(frames.size(), 10u);
  EXPECT_EQ(frames, Play(client, groom));
}

TEST(E2eBodies, AnUnknownBodyEndsTheHeadByName) {
  Daemon daemon;
  Client client = daemon.Connect();
  HeadOptions options;
  options.groom = Create(client, GroomWithBodies());
  options.pacing = Pacing::kLockstep;
  Head head = client.OpenHead(options);
  const auto frame = head.Step(0, {}, {{"hand", {}}, {"prop", {}}});
  ASSERT_FALSE(frame);
  EXPECT_EQ(frame.error().field, "pose.bodies[1].name");
}

TEST(E2eBodies, ARealtimeHeadTakesBodies) {
  Daemon daemon;
  Client client = daemon.Connect();
  HeadOptions options;
  options.groom = Create(client, GroomWithBodies());
  Head head = client.OpenHead(options);
  ASSERT_TRUE(head.WaitUntilStreaming(std::chrono::seconds(20)));
  for (int i = 0; i < 20; ++i) {
    ASSERT_TRUE(head.PushPose(i / 60.0, MotionAt(i / 60.0), {{"hand", Pose{{0.3, 0, 0}, {}}}}));
  }
  ASSERT_TRUE(head.Teleport(10, {}, {{"hand", Pose{{0.2, 0, 0}, {}}}}));
  const auto deadline = std::chrono::steady_clock::now() + std::chrono::seconds(20);
  while (head.NewestFrame() == nullptr || head.NewestFrame()->time_s < 10) {
    ASSERT_LT(std::chrono::steady_clock::now(), deadline);
    ASSERT_EQ(head.Status().state, HeadState::kStreaming);
  }
}

}  // namespace
}  // namespace mane::client_test
