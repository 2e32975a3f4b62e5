// Levels of detail of many heads:
//   shared    heads of one groom get the same ones, for as long as the groom is in use
//   lockstep  frames are the same bits whether or not they were there when a tolerance came
//   realtime  no frame waits for them: hair is at full detail until they have been made elsewhere

#include "session/level_library.h"

#include <gtest/gtest.h>

#include <latch>

#include "session/test_heads.h"

namespace mane::session {
namespace {

class LevelLibraryTest : public RegistryTest {
 protected:
  // Short curly hair, whose every block has two coarser levels.
  static LevelLibrary::GroomPtr Curly() {
    return head::GeneratedGroom(groom::HairType::kCaucasianCurly, 32, 0.1, 8);
  }
  static math::Pose At(double x) { return {{x, 0, 0}, Eigen::Quaterniond::Identity()}; }
  static EnvironmentCommand Tolerance(double tolerance) {
    EnvironmentCommand command;
    command.detail_tolerance = tolerance;
    return command;
  }
};

TEST_F(LevelLibraryTest, HeadsOfAGroomShareThemWhileItIsInUse) {
  LevelLibrary library(pool_);
  auto first = Curly();
  const auto second = Curly();
  EXPECT_EQ(library.Find(first), nullptr);
  const std::weak_ptr levels = library.FindOrMake(first);
  EXPECT_EQ(library.Find(first), levels.lock());
  EXPECT_EQ(library.FindOrMake(first), levels.lock());
  EXPECT_EQ(library.Find(second), nullptr);
  EXPECT_NE(library.FindOrMake(second), levels.lock());
  EXPECT_FALSE(levels.expired());
  first.reset();
  EXPECT_NE(library.FindOrMake(Curly()), nullptr);
  EXPECT_TRUE(levels.expired());
}

TEST_F(LevelLibraryTest, LockstepFramesDoNotDependOnWhetherTheyWereThere) {
  const auto groom = Curly();
  Registry registry({}, pool_, pool_);
  std::vector<std::vector<FramePtr>> runs;
  for (int run = 0; run < 3; ++run) {  // The first one makes them.
    TestStream stream;
    HeadOptions options;
    options.pacing = Pacing::kLockstep;
    const auto opened = registry.Open({groom}, options, "", &stream);
    ASSERT_TRUE(opened);
    stream.Follow(opened->head);
    for (int i = 0; i < 120; ++i) {
      if (i == 20) {
        ASSERT_TRUE(opened->head->Submit(Tolerance(0.01)));
      }
      ASSERT_TRUE(opened->head->Submit(PoseCommand{i / 60.0, At(2e-4 * i)}));
    }
    ASSERT_TRUE(stream.WaitForFrames(120));
    registry.Close(opened->head, &stream);
    runs.push_back(stream.frames());
  }
  EXPECT_LT(runs[0][119]->stepped_elements, groom->element_count());
  for (size_t i = 0; i < 120; ++i) {
    for (int run = 1; run < 3; ++run) {
      EXPECT_EQ(runs[run][i]->data, runs[0][i]->data) << i;
      EXPECT_EQ(runs[run][i]->stepped_elements, runs[0][i]->stepped_elements) << i;
    }
  }
}

TEST_F(LevelLibraryTest, NoRealtimeFrameWaitsForThem) {
  const auto groom = Curly();
  exec::WorkerPool one(1);
  std::latch free(1);
  one.Post([&free] { free.wait(); });  // As if another groom's took long.
  Registry registry({}, pool_, one);
  TestStream stream;
  HeadOptions options;
  options.rate_hz = 240;
  options.environment.detail_tolerance = 0.01;
  options.max_unacked = 16;
  const auto opened = registry.Open({groom}, options, "", &stream);
  ASSERT_TRUE(opened);
  stream.Follow(opened->head);
  const auto newest = [&](const auto& done) {
    return stream.WaitFor([&](const TestStream& s) {
      if (s.frames_.empty()) return false;
      (void)opened->head->Acknowledge(s.frames_.back()->index);
      return done(*s.frames_.back());
    });
  };
  // Half a second, in which calm hair would be coarsened twice.
  const auto full = groom->element_count();
  EXPECT_TRUE(newest([](const Frame& frame) { return frame.index >= 120; }));
  for (const FramePtr& frame : stream.frames()) EXPECT_EQ(frame->stepped_elements, full);
  free.count_down();
  EXPECT_TRUE(newest([&](const Frame& frame) { return frame.stepped_elements < full; }));
  registry.Close(opened->head, &stream);
}

}  // namespace
}  // namespace mane::session
