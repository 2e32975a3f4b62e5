// Laws of how heads of a session are animated:
//   open        a head opened as BEAM is animated so from its first frame, and says so
//   change      LOCKSTEP: from the next pose on, the same bits each time; real time: once ready
//   diagnostics frames of BEAM carry none
//   room        a change that there is no room for is refused, in time or in memory; a change back
//               never is
//   shared      heads of one groom and one kind share their beams, which go with the last
//   pace        real time: it changes again only once the change before is over
//   one         real time: beams are made one kind at a time, however often the client changes
//   shed        a head that may be shed becomes BEAM while its frames come late, and says so

#include <atomic>
#include <future>

#include "base/clock.h"
#include "head/memory.h"
#include "head/model_switch.h"
#include "session/admission.h"
#include "session/test_heads.h"

namespace mane::session {
namespace {

class ModelTest : public RegistryTest {
 protected:
  static head::ModelOptions Beam(int segments = 8) {
    head::ModelOptions model;
    model.model = head::Model::kBeam;
    model.beam.segments = segments;
    return model;
  }
  std::shared_ptr<HeadSession> OpenWith(Registry& registry, TestStream& stream,
                                        const HeadOptions& options) {
    const auto opened = registry.Open({groom_}, options, "", &stream);
    EXPECT_TRUE(opened) << (opened ? "" : opened.error().message);
    if (!opened) return nullptr;
    stream.Follow(opened->head);
    return opened->head;
  }
  // Frames of a lockstep head that is changed before these poses.
  std::vector<FramePtr> Play(const head::ModelOptions& first,
                             const std::vector<std::pair<int, head::ModelOptions>>& changes) {
    Registry registry({}, pool_, pool_);
    TestStream stream;
    HeadOptions options;
    options.pacing = Pacing::kLockstep;
    options.model = first;
    options.diagnostics = true;
    const auto head = OpenWith(registry, stream, options);
    for (int i = 0; i < 24; ++i) {
      for (const auto& [pose, model] : changes) {
        if (pose == i) {
          EXPECT_TRUE(head->Submit(ModelCommand{model}));
        }
      }
      EXPECT_TRUE(head->Submit(Pose(i)));
    }
    EXPECT_TRUE(stream.WaitForFrames(24));
    return stream.frames();
  }
};

TEST_F(ModelTest, AHeadOpenedAsBeamsIsOneFromItsFirstFrame) {
  for (const FramePtr& frame : Play(Beam(), {})) {
    EXPECT_EQ(frame->model, head::Model::kBeam);
    EXPECT_EQ(frame->stepped_elements, 12 * 8);
    EXPECT_FALSE(frame->diagnostics);
  }
}

TEST_F(ModelTest, LockstepChangesFromTheNextPoseOnTheSameWayEachTime) {
  const std::vector<std::pair<int, head::ModelOptions>> changes = {
      {6, Beam()}, {12, Beam(20)}, {18, head::ModelOptions{}}};
  const auto frames = Play({}, changes), again = Play({}, changes);
  for (int i = 0; i < 24; ++i) {
    const bool beam = i >= 6 && i < 18;
    EXPECT_EQ(frames[i]->model, beam ? head::Model::kBeam : head::Model::kSuperHelix) << i;
    EXPECT_EQ(frames[i]->diagnostics.has_value(), !beam) << i;
    EXPECT_EQ(frames[i]->data, again[i]->data) << i;
    if (beam) {
      EXPECT_EQ(frames[i]->stepped_elements, 12 * (i < 12 ? 8 : 20)) << i;
    }
  }
  EXPECT_NE(frames[23]->data, Play({}, {})[23]->data);
}

TEST_F(ModelTest, RealTimeChangesOnceBeamsAreReadyAndBack) {
  Registry registry({}, pool_, pool_);
  TestStream stream;
  const auto head = Open(registry, stream, Pacing::kRealtime);
  ASSERT_TRUE(head->Submit(Pose(0)));
  ASSERT_TRUE(head->Submit(ModelCommand{Beam()}));
  const auto shows = [&head](head::Model model) {
    return [&head, model](const TestStream& s) {
      if (s.frames_.empty()) return false;
      (void)head->Acknowledge(s.frames_.back()->index);
      return s.frames_.back()->model == model;
    };
  };
  EXPECT_TRUE(stream.WaitFor(shows(head::Model::kBeam)));
  ASSERT_TRUE(head->Submit(ModelCommand{}));
  EXPECT_TRUE(stream.WaitFor(shows(head::Model::kSuperHelix)));
  EXPECT_FALSE(stream.end_);
}

TEST_F(ModelTest, AChangeNeedsRoomAndAChangeBackDoesNot) {
  HeadOptions rods, beams;
  beams.model = Beam();
  const double rod_load = RealtimeLoad(*groom_, rods), beam_load = RealtimeLoad(*groom_, beams);
  ASSERT_LT(beam_load, rod_load);
  RegistryOptions limits;
  limits.realtime_capacity = 1.001 * (rod_load + beam_load);
  Registry registry(limits, pool_, pool_);
  TestStream first, second;
  const auto one = OpenWith(registry, first, beams), two = OpenWith(registry, second, beams);
  ASSERT_TRUE(registry.AdmitModel(one, {}));
  const auto refused = registry.AdmitModel(two, {});
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, ErrorCode::kResourceExhausted);
  EXPECT_EQ(refused.error().field, "model.model");
  // The first keeps what it was let in with, there and back.
  EXPECT_TRUE(registry.AdmitModel(one, Beam()));
  EXPECT_FALSE(registry.AdmitModel(two, {}));
  EXPECT_TRUE(registry.AdmitModel(one, {}));
  registry.Close(one, &first);
  EXPECT_TRUE(registry.AdmitModel(two, {}));
}

TEST_F(ModelTest, MemoryOfBeamsNeedsRoom) {
  const auto groom = head::SampleGroom(37, 5);
  for (const int segments : {11, 0}) {
    const head::BeamOptions options = Beam(segments).beam;
    const auto beams = head::MakeBeams(*groom, nullptr, options, pool_);
    head::HeadState state = head::AtRest(*groom, {});
    head::StartBeams(beams, &state);
    const size_t least = (state.beams.rows.size() + beams->rest.size()) * sizeof(rod::Row<float>) +
                         beams->directions.size() * sizeof(Eigen::Vector3d) +
                         beams->places.size() * sizeof(double);
    const size_t counted = head::BeamBytes(*groom, options);
    EXPECT_GT(counted, least) << segments;
    EXPECT_LT(counted, 1.5 * static_cast<double>(least)) << segments;
  }

  HeadOptions rods, shed, eight;
  rods.pacing = eight.pacing = Pacing::kLockstep;
  shed.may_shed = true;
  eight.model = Beam(8);
  shed.model.beam = eight.model.beam;
  const size_t small = head::StateBytes(*groom_),
               large = small + head::BeamBytes(*groom_, eight.model.beam);
  EXPECT_EQ(HeadBytes(*groom_, rods), small);
  EXPECT_EQ(HeadBytes(*groom_, eight), large);
  EXPECT_EQ(HeadBytes(*groom_, shed), large);

  Registry registry({.max_state_bytes = large + small}, pool_, pool_);
  TestStream first, second;
  const auto one = OpenWith(registry, first, rods), two = OpenWith(registry, second, rods);
  EXPECT_TRUE(registry.AdmitModel(one, Beam(8)));
  EXPECT_TRUE(registry.AdmitModel(one, {}));  // It keeps the room.
  const auto refused = registry.AdmitModel(two, Beam(2));
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, ErrorCode::kResourceExhausted);
  EXPECT_EQ(refused.error().field, "model.model");
  EXPECT_FALSE(registry.AdmitModel(one, Beam(9)));
  registry.Close(two, &second);
  EXPECT_TRUE(registry.AdmitModel(one, Beam(9)));
}

TEST_F(ModelTest, BeamsCostWhatTheirSegmentsDo) {
  EXPECT_DOUBLE_EQ(StepWork(*groom_, 3, Beam(10)), 3 * 12 * 10 * kBeamSteps);
  HeadOptions options;
  options.model = Beam(10);
  EXPECT_DOUBLE_EQ(RealtimeLoad(*groom_, options),
                   60 * (12 * 10 * kBeamSteps + kFrameSteps + 12 * 16 * kPointSteps));
  const auto much = AdmitFrame(*groom_, {{}, 1, 10'000'000}, Beam(10));
  ASSERT_FALSE(much);
  EXPECT_NE(much.error().message.find("12 guides of 10 segments"), std::string::npos)
      << much.error().message;
}

TEST_F(ModelTest, HeadsOfOneKindShareTheirBeams) {
  BeamLibrary library(pool_);
  auto first = library.FindOrMake({groom_}, Beam(8).beam);
  EXPECT_EQ(library.FindOrMake({groom_}, Beam(8).beam), first);
  EXPECT_NE(library.FindOrMake({groom_}, Beam(9).beam), first);
  EXPECT_NE(library.FindOrMake({head::SampleGroom(12, 4)}, Beam(8).beam), first);
  const std::weak_ptr<const head::Beams> gone = first;
  first.reset();
  EXPECT_TRUE(gone.expired());
}

// Counts what a head has done: its frames, and beams that were made for it.
class CountingSink final : public FrameSink {
 public:
  void OnProgress() override { ++progress; }
  void OnNotice(const Notice&) override {}
  void OnEnd(const Error&) override { ended = true; }
  std::atomic<int> progress = 0;
  std::atomic<bool> ended = false;
};

TEST_F(ModelTest, BeamsAreMadeOneKindAtATime) {
  exec::WorkerPool making(1);
  LevelLibrary levels(making);
  BeamLibrary library(making);
  std::promise<void> gate;
  making.Post([open = gate.get_future().share()] { open.wait(); });
  const auto head = std::make_shared<HeadSession>("heads/1", Asset{groom_}, HeadOptions{}, pool_,
                                                  levels, library);
  CountingSink sink;
  head->Attach(&sink);
  double due = base::SteadySeconds();
  const auto tick = [&] {
    head->Tick(due += 1 / 60.0, 0);
    pool_.WaitIdle();
  };
  constexpr int kKinds = 20;
  for (int i = 0; i < kKinds; ++i) {
    ASSERT_TRUE(head->Submit(ModelCommand{Beam(8 + i)}));
    tick();
  }
  EXPECT_EQ(sink.progress, kKinds);
  gate.set_value();
  making.WaitIdle();
  EXPECT_EQ(sink.progress, kKinds + 1);
  // The kind that is wanted comes next.
  tick();
  making.WaitIdle();
  tick();
  EXPECT_EQ(sink.progress, kKinds + 4);
  FramePtr newest;
  for (auto out = head->TakeFrame(); out.frame; out = head->TakeFrame()) {
    newest = out.frame;
    ASSERT_TRUE(head->Acknowledge(newest->index));
  }
  ASSERT_NE(newest, nullptr);
  EXPECT_EQ(newest->model, head::Model::kBeam);
  EXPECT_EQ(newest->stepped_elements, 12 * (8 + kKinds - 1));
  EXPECT_FALSE(sink.ended);
  head->Detach(&sink);
}

TEST_F(ModelTest, RealTimeChangesNoSoonerThanTheChangeBeforeIsOver) {
  LevelLibrary levels(pool_);
  BeamLibrary library(pool_);
  const auto head = std::make_shared<HeadSession>("heads/1", Asset{groom_}, HeadOptions{}, pool_,
                                                  levels, library);
  CountingSink sink;
  head->Attach(&sink);
  double due = base::SteadySeconds(), changed = due - 1;
  int changes = 0;
  head::Model before = head::Model::kSuperHelix, wanted = before;
  const auto tick = [&] {
    head->Tick(due += 1 / 60.0, 0);
    pool_.WaitIdle();
    const FramePtr frame = head->TakeFrame().frame;
    ASSERT_NE(frame, nullptr);
    ASSERT_TRUE(head->Acknowledge(frame->index));
    if (std::exchange(before, frame->model) == frame->model) return;
    EXPECT_GT(due - std::exchange(changed, due), head::kTransitionTime - 1e-6);
    ++changes;
  };
  for (int i = 0; i < 121; ++i) {
    wanted = i % 2 == 0 ? head::Model::kBeam : head::Model::kSuperHelix;
    ASSERT_TRUE(head->Submit(ModelCommand{{wanted, {}}}));
    if (i % 3 == 0) {
      ASSERT_TRUE(head->Submit(ResetCommand{}));
    }
    tick();
  }
  EXPECT_GT(changes, 4);
  for (int i = 0; i < 16; ++i) tick();
  EXPECT_EQ(before, wanted);
  head->Detach(&sink);
}

TEST_F(ModelTest, AHeadThatMayBeShedBecomesBeamsWhileFramesComeLate) {
  LevelLibrary levels(pool_);
  BeamLibrary library(pool_);
  for (const bool may_shed : {false, true}) {
    HeadOptions options;
    options.may_shed = may_shed;
    const auto head =
        std::make_shared<HeadSession>("heads/1", Asset{groom_}, options, pool_, levels, library);
    TestStream stream;
    stream.Follow(head);
    head->Attach(&stream);
    ASSERT_TRUE(head->Submit(Pose(0)));
    double due = base::SteadySeconds();
    const auto tick = [&](int missed) {
      const size_t count = stream.frames().size();
      head->Tick(due += 1 / 60.0, missed);
      EXPECT_TRUE(stream.WaitForFrames(count + 1));
      pool_.WaitIdle();
      if (!stream.frames().empty()) (void)head->Acknowledge(stream.frames().back()->index);
    };
    tick(0);
    tick(Shedding::kMostLate - 1);
    EXPECT_EQ(stream.frames().back()->model, head::Model::kSuperHelix);
    tick(1);
    tick(0);
    EXPECT_EQ(stream.frames().back()->model,
              may_shed ? head::Model::kBeam : head::Model::kSuperHelix);
    EXPECT_EQ(head->shown_model(), may_shed ? head::Model::kBeam : head::Model::kSuperHelix);
    EXPECT_EQ(head->model().model, head::Model::kSuperHelix);  // What its client asked for.
    const auto told = [&](head::Model model) {
      return std::ranges::count_if(stream.notices_, [model](const Notice& notice) {
        return notice.code == Notice::Code::kModel && notice.model == model;
      });
    };
    EXPECT_EQ(told(head::Model::kBeam), may_shed ? 1 : 0);
    // That the client gets what it asks for is nothing to be told.
    ASSERT_TRUE(head->Submit(ModelCommand{{head::Model::kBeam, {}}}));
    tick(0);
    tick(0);
    EXPECT_EQ(stream.frames().back()->model, head::Model::kBeam);
    EXPECT_EQ(told(head::Model::kBeam), may_shed ? 1 : 0);
    EXPECT_EQ(told(head::Model::kSuperHelix), 0);
    head->Detach(&stream);
  }
}

}  // namespace
}  // namespace mane::session
