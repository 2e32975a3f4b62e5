// Who is let in: heads by their number and by what they need, frames by their work and size; what
// is refused leaves the others alone.

#include "session/admission.h"

#include <gtest/gtest.h>

#include "head/memory.h"
#include "session/body_library.h"
#include "session/test_heads.h"

namespace mane::session {
namespace {

class AdmissionTest : public RegistryTest {};

TEST_F(AdmissionTest, TheLimitRefusesButDetachedHeadsMakeRoom) {
  Registry registry({.max_heads = 2, .resume_grace = 60}, pool_, pool_);
  TestStream a, b, c;
  const auto first = Open(registry, a, Pacing::kLockstep);
  const auto second = Open(registry, b, Pacing::kRealtime);
  const auto refused = registry.Open({groom_}, {}, "", &c);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, ErrorCode::kResourceExhausted);
  registry.Leave(second, &b);
  const auto third = Open(registry, c, Pacing::kLockstep);
  ASSERT_NE(third, nullptr);
  EXPECT_EQ(third->name(), "heads/3");  // What is refused is not built, and takes no name.
  EXPECT_EQ(registry.head_count(), 2);
  registry.Close(first, &a);
  registry.Close(third, &c);
  EXPECT_EQ(registry.head_count(), 0);
}

TEST_F(AdmissionTest, RealtimeHeadsAreAdmittedByWhatTheyNeed) {
  // 12 guides of 4 elements and 16 points at 120 Hz need 257,280 element-steps a second: 48 a step,
  // 2000 a frame, 96 for its points.
  Registry registry({.max_heads = 10, .resume_grace = 60, .realtime_capacity = 600'000}, pool_,
                    pool_);
  TestStream a, b, c;
  const auto first = Open(registry, a, Pacing::kRealtime);
  const auto second = Open(registry, b, Pacing::kRealtime);
  const std::string second_token = token_;
  HeadOptions third;
  third.rate_hz = 120;
  const auto refused = registry.Open({groom_}, third, "", &c);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, ErrorCode::kResourceExhausted);
  const auto lockstep = Open(registry, c, Pacing::kLockstep);  // Takes none of it.
  // A head that waits for its client keeps its share until it is gone.
  TestStream d;
  registry.Leave(second, &b);
  EXPECT_FALSE(registry.Open({groom_}, third, "", &d));
  EXPECT_TRUE(registry.Resume(second_token, &b));
  registry.Close(first, &a);
  const auto again = Open(registry, a, Pacing::kRealtime);
  ASSERT_NE(again, nullptr);
  for (const auto& [head, stream] : {std::pair{second, &b}, {lockstep, &c}, {again, &a}}) {
    registry.Close(head, stream);
  }
}

TEST_F(AdmissionTest, ALoadCountsStepsFramesAndPoints) {
  HeadOptions options;
  const auto load = [&] { return RealtimeLoad(*groom_, options); };
  EXPECT_DOUBLE_EQ(load(), 60 * (48 + 2000 + 12 * 16 / 2));
  options.view.points_per_guide = 256;
  EXPECT_DOUBLE_EQ(load(), 60 * (48 + 2000 + 12 * 256 / 2));
  options.view.format = head::FrameFormat::kGeneralized;
  EXPECT_DOUBLE_EQ(load(), 60 * (48 + 2000 + 48 / 2));
  options.substeps = 3;
  EXPECT_DOUBLE_EQ(load(), 60 * (48 * 3 + 2000 + 48 / 2));
  options.rate_hz = 2;  // Half a second takes thirty of the longest steps.
  EXPECT_DOUBLE_EQ(load(), 2 * (48 * 30 + 2000 + 48 / 2));
  options.diagnostics = true;
  EXPECT_DOUBLE_EQ(load(), 2 * (48 * (30 + kDiagnosticsSteps) + 2000 + 48 / 2));
  options.pacing = Pacing::kLockstep;
  EXPECT_EQ(load(), 0);
}

TEST_F(AdmissionTest, AWoundElementCountsTwice) {
  const auto wound = head::SampleGroom(12, 4, head::SampleHair::kWound);
  HeadOptions options;
  EXPECT_DOUBLE_EQ(RealtimeLoad(*wound, options), 60 * (2 * 48 + 2000 + 12 * 16 / 2));
}

TEST_F(AdmissionTest, WhatAnElementMeetsCountsByBodiesGroupsAndWisps) {
  const auto groom = SampleGroomWithBodies(12, 4);  // Plain and wound guides: 60 element-steps.
  const int elements = groom->stepped_elements();
  HeadOptions options;
  const double work = (kContactSteps + 2 * kGroupSteps) * elements;  // Two hands and a shoulder.
  EXPECT_DOUBLE_EQ(RealtimeLoad(*groom, options), 60 * (work + 2000 + 12 * 16 / 2));
  EXPECT_DOUBLE_EQ(StepWork(*groom, 3), 3 * work);
  EXPECT_DOUBLE_EQ(StepWork(*groom_, 3), 3 * 48);
  groom::Groom wisps = *groom;
  wisps.guides[3].wisp_radius = 0.005;
  EXPECT_DOUBLE_EQ(StepWork(wisps, 1), work + kWispSteps * 12 * elements);
  groom::Groom many = *head::SampleGroom(400, 4, head::SampleHair::kPlain);
  many.has_contact = true;
  many.guides[3].wisp_radius = 0.005;
  EXPECT_DOUBLE_EQ(StepWork(many, 1), (kContactSteps + kMostWispSteps) * 1600);
  groom::Groom fixed = *groom;
  for (groom::Body& body : fixed.bodies) body.moving = false;
  EXPECT_DOUBLE_EQ(StepWork(fixed, 1), (kContactSteps + 2 * kBodySteps) * elements);
  fixed.scalp_friction = groom::Friction{};
  EXPECT_DOUBLE_EQ(StepWork(fixed, 1), (kContactSteps + 3 * kBodySteps) * elements);
  fixed.bodies.clear();
  EXPECT_DOUBLE_EQ(StepWork(fixed, 1), kContactSteps * elements);
}

// As many bodies that move as a groom may have.
groom::Groom Crowd(const groom::Groom& groom) {
  groom::Groom crowd = groom;
  crowd.has_contact = true;
  for (int i = 0; i < 64; ++i) {
    crowd.bodies.push_back(
        {fmt::format("b{}", i), groom::Body::Ellipsoid{{1, 1, 1}}, {}, true, {}});
  }
  return crowd;
}

TEST_F(AdmissionTest, HeadsThatRememberTooMuchAreRefused) {
  groom::Parts parts;
  const auto some = head::SampleGroom(100, 2, head::SampleHair::kPlain);
  for (int i = 0; i < 200; ++i) {
    parts.guides.insert(parts.guides.end(), some->guides.begin(), some->guides.end());
  }
  const auto many = *groom::Assemble(std::move(parts), {}, &pool_);
  EXPECT_TRUE(AdmitState(*many, "groom"));
  EXPECT_TRUE(AdmitState(Crowd(*groom_), "groom"));
  const auto alone = AdmitState(Crowd(*many), "open.groom");
  ASSERT_FALSE(alone);
  EXPECT_EQ(alone.error().code, ErrorCode::kResourceExhausted);
  EXPECT_EQ(alone.error().field, "open.groom");

  // What a head is counted as is what it takes.
  const auto groom = SampleGroomWithBodies(40, 6);
  BodyLibrary library({});
  head::HeadState state = head::AtRest(*groom, {});
  head::StartContact(*groom, *library.FindOrMake(groom), &state);
  const size_t bytes = (state.guides.size() + state.contact.memory.size()) * sizeof state.guides[0];
  EXPECT_EQ(head::StateBytes(*groom), bytes);

  Registry registry({.max_state_bytes = 2 * bytes}, pool_, pool_);
  TestStream a, b, c;
  HeadOptions options;
  options.pacing = Pacing::kLockstep;
  const Asset asset{groom, *library.FindOrMake(groom)};
  const auto first = registry.Open(asset, options, "", &a);
  ASSERT_TRUE(first);
  ASSERT_TRUE(registry.Open(asset, options, "twice", &b));
  const auto refused = registry.Open(asset, options, "", &c);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, ErrorCode::kResourceExhausted);
  EXPECT_EQ(refused.error().field, "open.groom");
  EXPECT_FALSE(registry.Admit(*groom, options, ""));
  EXPECT_TRUE(registry.Admit(*groom, options, "twice"));  // In the place of the second.
  EXPECT_EQ(registry.head_count(), 2);
  registry.Close(first->head, &a);
  EXPECT_TRUE(registry.Admit(*groom, options, ""));
}

TEST_F(AdmissionTest, WhatIsTooMuchWorkIsToldWithWhatHelps) {
  groom::Groom crowd = Crowd(*head::SampleGroom(2000, 60, head::SampleHair::kPlain));
  crowd.guides[0].wisp_radius = 0.01;
  ASSERT_GT(StepWork(crowd, 1), kMaxFrameWork);
  const auto tells = [](const Result<void>& refused, const std::string& field,
                        const std::string& text) {
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().code, ErrorCode::kResourceExhausted);
    EXPECT_EQ(refused.error().field, field);
    EXPECT_NE(refused.error().message.find(text), std::string::npos) << refused.error().message;
    EXPECT_EQ(refused.error().message.find("e+"), std::string::npos) << refused.error().message;
  };
  HeadOptions options;
  options.pacing = Pacing::kLockstep;
  tells(AdmitHead(crowd, options), "open.groom", "64 bodies");
  tells(AdmitHead(crowd, options), "open.groom", "fewer bodies");
  options.substeps = 1'000'000;
  tells(AdmitHead(*groom_, options), "open.substeps", "use fewer substeps");
  tells(AdmitHead(*groom_, options), "open.substeps", "48000000 element-steps");
  EXPECT_TRUE(AdmitBakedFrame(*groom_, {{}, 1 / 60.0, 64}, 7));
  tells(AdmitBakedFrame(crowd, {{}, 1 / 60.0, 1}, 7), "groom", "fewer bodies");
  tells(AdmitBakedFrame(*groom_, {{}, 1 / 60.0, 1'000'000}, 7), "substeps", "use fewer substeps");
  tells(AdmitBakedFrame(*groom_, {{}, 5000, 1}, 7), "motion.times_s[7]", "poses closer together");
  tells(AdmitFrame(*groom_, {{}, 5000, 1}), "pose.time_s", "closer together");
}

TEST_F(AdmissionTest, EightHeadsOfAHundredGuidesFitWithAmpleRoom) {
  EXPECT_LT(8 * RealtimeLoad(*head::SampleGroom(100, 5), {}),
            RegistryOptions().realtime_capacity / 5);
}

TEST_F(AdmissionTest, FramesThatAreTooMuchWorkOrTooLargeAreRefused) {
  Registry registry({}, pool_, pool_);  // The groom has 48 elements.
  TestStream stream;
  const auto refused_field = [&](int substeps, int points) {
    HeadOptions options;
    options.pacing = Pacing::kLockstep;
    options.substeps = substeps;
    options.view.points_per_guide = points;
    const auto opened = registry.Open({groom_}, options, "", &stream);
    EXPECT_FALSE(opened);
    return opened ? "" : opened.error().field;
  };
  EXPECT_EQ(refused_field(1'000'000, 16), "open.substeps");
  EXPECT_EQ(refused_field(1, 200'000), "open.points_per_guide");

  EXPECT_TRUE(AdmitFrame(*groom_, {{}, 1, 1}));
  const auto result = AdmitFrame(*groom_, {{}, 5000, 1});  // 300,000 of the longest steps.
  ASSERT_FALSE(result);
  EXPECT_EQ(result.error().code, ErrorCode::kResourceExhausted);
  EXPECT_EQ(result.error().field, "pose.time_s");
}

TEST_F(AdmissionTest, AHeadOfLargeFramesHoldsFewerOfThem) {
  head::View view;
  EXPECT_EQ(FrameWindow(*groom_, view, 8), 8);
  view.points_per_guide = 50'000;  // 7.2 MB a frame: four of them in 32 MiB.
  EXPECT_EQ(FrameWindow(*groom_, view, 8), 4);
  EXPECT_EQ(FrameWindow(*groom_, view, 3), 3);
  view.points_per_guide = 1'000'000;  // More than are admitted.
  EXPECT_EQ(FrameWindow(*groom_, view, 8), 1);

  Registry registry({}, pool_, pool_);
  TestStream lockstep, realtime;
  HeadOptions options;
  options.view.points_per_guide = 100'000;  // 14.4 MB: two.
  options.max_unacked = 16;
  options.rate_hz = 10;
  const auto newest = registry.Open({groom_}, options, "", &realtime);
  ASSERT_TRUE(newest);
  realtime.Follow(newest->head);
  options.pacing = Pacing::kLockstep;
  const auto ordered = registry.Open({groom_}, options, "", &lockstep);
  ASSERT_TRUE(ordered);
  for (int i = 0; i < 2; ++i) {
    EXPECT_FALSE(ordered->head->Full());
    ASSERT_TRUE(ordered->head->Submit(Pose(i)));
  }
  EXPECT_TRUE(ordered->head->Full());
  lockstep.Follow(ordered->head);
  lockstep.OnProgress();
  ASSERT_TRUE(lockstep.WaitForFrames(2));
  EXPECT_TRUE(WaitUntil([&] { return newest->head->next_frame() >= 5; }));
  EXPECT_EQ(realtime.frames().size(), 2u);
  registry.Close(newest->head, &realtime);
  registry.Close(ordered->head, &lockstep);
}

TEST_F(AdmissionTest, AReplacementThatIsRefusedLeavesTheOldHeadAlone) {
  HeadOptions options;
  options.rate_hz = 120;
  const double load = RealtimeLoad(*groom_, options);
  Registry registry({.max_heads = 1, .resume_grace = 60, .realtime_capacity = 1.5 * load}, pool_,
                    pool_);
  TestStream first, second, third;
  const auto head = Open(registry, first, Pacing::kRealtime, "try-1");
  options.rate_hz = 240;
  const auto refused = registry.Open({groom_}, options, "try-1", &second);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, ErrorCode::kResourceExhausted);
  EXPECT_EQ(registry.head_count(), 1);
  EXPECT_FALSE(first.end_);
  const uint64_t last = head->next_frame() + 3;
  ASSERT_TRUE(first.WaitFor([&](const TestStream& s) {  // It goes on,
    return !s.frames_.empty() && head->Acknowledge(s.frames_.back()->index) &&
           s.frames_.back()->index >= last;
  }));
  // and an equal one takes its place, as what leaves needs nothing more.
  const auto replacement = Open(registry, third, Pacing::kRealtime, "try-1");
  ASSERT_NE(replacement, nullptr);
  ASSERT_TRUE(first.WaitFor([](const TestStream& s) { return s.end_.has_value(); }));
  registry.Close(replacement, &third);
}

TEST_F(AdmissionTest, AStoppingServerAdmitsNobody) {
  Registry registry({}, pool_, pool_);
  TestStream first, second;
  const auto head = Open(registry, first, Pacing::kRealtime);
  EXPECT_EQ(registry.attached_count(), 1);
  registry.Leave(head, &first);
  EXPECT_EQ(registry.attached_count(), 0);
  registry.StopAdmitting();
  EXPECT_EQ(registry.Open({groom_}, {}, "", &second).error().code, ErrorCode::kUnavailable);
  EXPECT_EQ(registry.Resume(token_, &second).error().code, ErrorCode::kUnavailable);
}

}  // namespace
}  // namespace mane::session
