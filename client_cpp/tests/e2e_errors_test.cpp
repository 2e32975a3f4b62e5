// Bad input comes back as an error that names its field, and nobody else notices.

#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <functional>
#include <limits>
#include <string>
#include <vector>

#include "daemon.h"
#include "test_hair.h"

namespace mane::client_test {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr std::chrono::seconds kLong{20};

class E2eErrors : public ::testing::Test {
 protected:
  // That `result` failed for the fault of `field`, in a sentence that says so.
  template <typename T>
  static void ExpectRefused(const Result<T>& result, const std::string& field) {
    ASSERT_FALSE(result);
    EXPECT_EQ(result.error().code, ErrorCode::kInvalidArgument);
    EXPECT_EQ(result.error().field, field);
    EXPECT_NE(result.error().message.find(field), std::string::npos) << result.error().message;
  }

  Daemon daemon_;
  Client client_ = daemon_.Connect();
};

TEST_F(E2eErrors, EveryBadGuideParameterIsNamed) {
  const struct {
    std::string field;
    std::function<void(Guide&)> spoil;
  } cases[] = {
      {"root_position.x", [](Guide& g) { g.root_position.x = kNaN; }},
      {"root_frame",
       [](Guide& g) {
         g.root_frame = {0, 0, 0, 2};
       }},
      {"root_frame",
       [](Guide& g) {
         g.root_frame = {0, 0, 0, 0};
       }},
      {"length_m", [](Guide& g) { g.length_m = 0; }},
      {"length_m", [](Guide& g) { g.length_m = -0.1; }},
      {"length_m", [](Guide& g) { g.length_m = kInfinity; }},
      {"element_count", [](Guide& g) { g.element_count = 0; }},
      {"element_count", [](Guide& g) { g.element_count = 4'000'000'000; }},
      {"radius_1_m", [](Guide& g) { g.radius_1_m = 0; }},
      {"radius_2_m", [](Guide& g) { g.radius_2_m = -1e-5; }},
      {"young_modulus_pa", [](Guide& g) { g.young_modulus_pa = kNaN; }},
      {"poisson_ratio", [](Guide& g) { g.poisson_ratio = 0.6; }},
      {"density_kg_m3", [](Guide& g) { g.density_kg_m3 = 0; }},
      {"internal_friction", [](Guide& g) { g.internal_friction = -1; }},
      {"air_drag", [](Guide& g) { g.air_drag = kInfinity; }},
      {"natural_twist",
       [](Guide& g) {
         g.natural_twist = {1, 2};
       }},
      {"natural_curvature_1[3]",
       [](Guide& g) {
         g.natural_curvature_1 = {0, 0, 0, kNaN, 0};
       }},
      {"natural_curvature_2[0]", [](Guide& g) { g.natural_curvature_2 = {1e9}; }},
  };
  for (const auto& [field, spoil] : cases) {
    SCOPED_TRACE(field);
    GroomUpload upload = WavyGroom(3);
    auto& guides = std::get<std::vector<Guide>>(upload.guides);
    guides[2] = WavyGuide();
    spoil(guides[2]);
    ExpectRefused(client_.CreateGroom(upload), "guides[2]." + field);
  }
  EXPECT_TRUE(client_.ListGrooms()->empty()) << "nothing of a refused groom is kept";
}

TEST_F(E2eErrors, GroomsThatCannotBeAreRefused) {
  GroomUpload empty;
  EXPECT_EQ(client_.CreateGroom(empty).error().code, ErrorCode::kInvalidArgument);

  GroomUpload bald;
  bald.guides =
      GuideGeneration{.hair_type = HairType::kCaucasianWavy, .guide_count = 5, .length_m = 0.1};
  EXPECT_EQ(client_.CreateGroom(bald).error().code, ErrorCode::kInvalidArgument);

  GroomUpload broken = bald;
  broken.scalp = TriangleMesh{{0, 0, 0, 1, 0, 0, 0, 1, 0}, {0, 1, 3}, {}};
  ExpectRefused(client_.CreateGroom(broken), "scalp_mesh.triangles[0]");

  GroomUpload named = WavyGroom(1);
  named.groom_id = "Not A Name";
  ExpectRefused(client_.CreateGroom(named), "header.groom_id");

  named.groom_id = "taken";
  ASSERT_TRUE(client_.CreateGroom(named));
  EXPECT_EQ(client_.CreateGroom(named).error().code, ErrorCode::kAlreadyExists);
}

TEST_F(E2eErrors, BadHeadOptionsCloseTheHeadWithTheirField) {
  HeadOptions good;
  good.groom = Create(client_, WavyGroom(2));
  const struct {
    std::string field;
    std::function<void(HeadOptions&)> spoil;
  } cases[] = {
      {"open.pacing", [](HeadOptions& o) { o.pacing = static_cast<Pacing>(0); }},
      {"open.format", [](HeadOptions& o) { o.format = static_cast<FrameFormat>(9); }},
      {"open.space", [](HeadOptions& o) { o.space = static_cast<Space>(9); }},
      {"open.points_per_guide", [](HeadOptions& o) { o.points_per_guide = 1; }},
      {"open.points_per_guide", [](HeadOptions& o) { o.points_per_guide = 257; }},
      {"open.rate_hz", [](HeadOptions& o) { o.rate_hz = -60; }},
      {"open.rate_hz", [](HeadOptions& o) { o.rate_hz = kNaN; }},
      {"open.substeps", [](HeadOptions& o) { o.substeps = 65; }},
      {"open.pose_delay_s", [](HeadOptions& o) { o.pose_delay_s = 1; }},
      {"open.max_unacked_frames", [](HeadOptions& o) { o.max_unacked_frames = 17; }},
      {"open.initial_pose.orientation", [](HeadOptions& o) { o.initial_pose.orientation.w = 3; }},
      {"open.initial_pose.position.y", [](HeadOptions& o) { o.initial_pose.position.y = 1e9; }},
      {"open.environment.gravity.z",
       [](HeadOptions& o) {
         o.environment.gravity = Vector3{0, 0, kNaN};
       }},
      {"open.environment.detail_tolerance_m",
       [](HeadOptions& o) { o.environment.detail_tolerance_m = -1; }},
      {"open.environment.air_drag_scale",
       [](HeadOptions& o) { o.environment.air_drag_scale = -1; }},
  };
  for (const auto& [field, spoil] : cases) {
    SCOPED_TRACE(field);
    HeadOptions options = good;
    spoil(options);
    Head head = client_.OpenHead(options);
    ExpectRefused(head.WaitUntilStreaming(kLong), field);
    EXPECT_EQ(head.Status().state, HeadState::kClosed);
  }
}

TEST_F(E2eErrors, AnUnknownGroomIsNotFoundInEveryFormat) {
  for (const FrameFormat format : {FrameFormat::kPositionsFloat32, FrameFormat::kGeneralized}) {
    HeadOptions options;
    options.groom = "grooms/never-made";
    options.format = format;
    Head head = client_.OpenHead(options);
    const auto open = head.WaitUntilStreaming(kLong);
    ASSERT_FALSE(open);
    EXPECT_EQ(open.error().code, ErrorCode::kNotFound);
    EXPECT_EQ(open.error().field, "open.groom");
    EXPECT_FALSE(head.Status().resumes);
  }
}

TEST_F(E2eErrors, ABadPoseEndsItsHeadAndNoOther) {
  HeadOptions options;
  options.groom = Create(client_, WavyGroom(2));
  options.pacing = Pacing::kLockstep;
  Head good = client_.OpenHead(options);
  ASSERT_TRUE(good.Step(0, MotionAt(0)));

  const struct {
    std::string field;
    std::function<void(Pose&)> spoil;
  } cases[] = {
      {"pose.pose.position.x", [](Pose& p) { p.position.x = kNaN; }},
      {"pose.pose.position.z", [](Pose& p) { p.position.z = 2e6; }},
      {"pose.pose.orientation",
       [](Pose& p) {
         p.orientation = {0, 0, 0, 1.02};
       }},
      {"pose.pose.orientation", [](Pose& p) { p.orientation.x = kInfinity; }},
  };
  for (const auto& [field, spoil] : cases) {
    SCOPED_TRACE(field);
    Head head = client_.OpenHead(options);
    ASSERT_TRUE(head.Step(0, {}));
    Pose pose;
    spoil(pose);
    ExpectRefused(head.Step(0.01, pose), field);
    ExpectRefused(head.Step(0.02, {}), field);
  }
  Head head = client_.OpenHead(options);
  ASSERT_TRUE(head.SetEnvironment({.wind_velocity = Vector3{1000, 0, 0}}));
  ExpectRefused(head.Step(0, {}), "environment.wind_velocity.x");

  EXPECT_TRUE(good.Step(0.01, MotionAt(0.01)));
}

TEST_F(E2eErrors, ANearlyUnitQuaternionIsNormalised) {
  HeadOptions options;
  options.groom = Create(client_, WavyGroom(2));
  options.pacing = Pacing::kLockstep;
  Head head = client_.OpenHead(options);
  Pose pose;
  pose.orientation.w = 1.005;
  const auto frame = head.Step(0, pose);
  ASSERT_TRUE(frame) << frame.error().message;
  EXPECT_NEAR((*frame)->head_pose.orientation.w, 1, 1e-12);
}

}  // namespace
}  // namespace mane::client_test
