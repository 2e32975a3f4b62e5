// Laws of heads whose calm hair is stepped with fewer elements:
//   off        without a tolerance or levels nothing changes, by a bit; turned off, hair goes on
//              from where it is
//   rest       hair at rest comes to the coarsest level and stays where it was
//   switch     what is shown, and how it moves, is the same before and after any switch
//   motion     no frame after a switch moves hair otherwise than full detail would
//   tolerance  tips are within it of full detail, in a shake and after it, with fewer elements
//   calm       levels change a few times a second at most, and back to full detail when hair bends
//   pure       any number of workers gives the same bits; a copy of the state replays them
//   frames     reset, teleport and diagnostics are those of what is shown

#include "head/detail.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>

#include "head/diagnostics.h"
#include "head/head.h"
#include "head/sample_groom.h"
#include "rod/chain.h"

namespace mane::head {
namespace {

using Eigen::Vector3d;

using groom::HairType;

// Curly hair short enough that every block has two coarser levels.
std::shared_ptr<const groom::Groom> Curly(int guides, int N) {
  return GeneratedGroom(HairType::kCaucasianCurly, guides, 0.1, N);
}

// A shake that ends after two seconds.
math::Pose Shaken(double t, double size) {
  const double rise = std::min(1.0, t / 0.2), fall = t < 2 ? 1 : std::max(0.0, 1 - (t - 2) / 0.3);
  const double e = size * rise * fall;
  return {e * Vector3d(0.03 * std::sin(8.2 * t), 0.01 * std::sin(12 * t), 0.02 * std::sin(5.7 * t)),
          math::FromRotationVector(
              e * Vector3d(0.1 * std::sin(5 * t), 0.5 * std::sin(7 * t), 0.1 * std::sin(8.8 * t)))};
}

Environment Tolerant(double tolerance) {
  Environment environment;
  environment.detail_tolerance = tolerance;
  return environment;
}

// At rest, with the levels that a tolerance takes.
HeadState Tolerating(const groom::Groom& groom, const math::Pose& pose) {
  exec::WorkerPool pool(1);
  HeadState state = AtRest(groom, pose);
  StartDetail(groom, std::make_shared<const Levels>(groom, pool), &state.detail);
  return state;
}

void Play(const groom::Groom& groom, int begin, int end, double size, double tolerance,
          HeadState* state, exec::WorkerPool& pool) {
  for (int i = begin + 1; i <= end; ++i) {
    Advance(groom, {Shaken(i / 60.0, size), 1 / 60.0, 1}, Tolerant(tolerance), state, pool);
  }
}

// Element angles of a groom of plain guides.
std::vector<Vector3d> Angles(const groom::Groom& groom, const HeadState& state) {
  const std::vector<double> coordinates = Coordinates(groom, state);
  std::vector<Vector3d> theta(coordinates.size() / 3);
  for (size_t Q = 0; Q < theta.size(); ++Q) {
    theta[Q] = Eigen::Map<const Vector3d>(&coordinates[3 * Q]);
  }
  return theta;
}

std::vector<Vector3d> Tips(const groom::Groom& groom, const HeadState& state) {
  const std::vector<Vector3d> theta = Angles(groom, state);
  std::vector<Vector3d> tips;
  for (int i = 0; i < groom.guide_count(); ++i) {
    const size_t first = groom.first_element[i], N = groom.first_element[i + 1] - first;
    tips.push_back(rod::ElementFrames(groom.guides[i].strand, state.pose * groom.guides[i].root,
                                      std::span(theta).subspan(first, N))
                       .back()
                       .r);
  }
  return tips;
}

double Farthest(const std::vector<Vector3d>& a, const std::vector<Vector3d>& b) {
  double worst = 0;
  for (size_t i = 0; i < a.size(); ++i) worst = std::max(worst, (a[i] - b[i]).norm());
  return worst;
}

std::vector<int> LevelsOf(const HeadState& state) {
  std::vector<int> levels;
  for (const Detail::Block& block : state.detail.blocks) levels.push_back(block.level);
  return levels;
}

bool SameRows(const std::vector<rod::Row<float>>& a, const std::vector<rod::Row<float>>& b) {
  return a.size() == b.size() &&
         (a.empty() || std::memcmp(a.data(), b.data(), a.size() * sizeof(a[0])) == 0);
}

TEST(DetailTest, HairAtRestComesToTheCoarsestLevelAndStaysWhereItWas) {
  exec::WorkerPool pool(1);
  for (const int N : {5, 10}) {
    const auto groom = Curly(40, N);
    const HeadState rest = Tolerating(*groom, {});
    HeadState state = rest;
    const Levels levels(*groom, pool);
    for (int i = 0; i < 180; ++i) Advance(*groom, {{}, 1 / 60.0, 1}, Tolerant(1e-3), &state, pool);
    int coarsest = 0;
    for (int b = 0; b < std::ssize(groom->batch.blocks()); ++b) {
      const auto& block = groom->batch.blocks()[b];
      EXPECT_EQ(state.detail.blocks[b].level, levels.Count(b));
      const int own = levels.Count(b) == 0 ? N : levels.At(b, levels.Count(b)).elements;
      coarsest += block.count * own;
    }
    EXPECT_EQ(SteppedElements(*groom, state), coarsest);
    EXPECT_LT(coarsest, 0.7 * groom->element_count());
    EXPECT_LT(Farthest(Angles(*groom, state), Angles(*groom, rest)), 3e-5);
  }
}

TEST(DetailTest, NothingShownChangesWithTheLevel) {
  exec::WorkerPool pool(1);
  const auto groom = Curly(40, 10);
  HeadState state = Tolerating(*groom, Shaken(0, 1));
  Play(*groom, 0, 40, 1, 1e-9, &state, pool);
  for (int b = 0; b < std::ssize(groom->batch.blocks()); ++b) {
    const auto& block = groom->batch.blocks()[b];
    const int most = state.detail.levels->Count(b);
    for (const int level : {std::min(1, most), most, 0, most, std::min(1, most), 0}) {
      const HeadState before = state;
      SwitchBlock(*groom, b, level, state.pose, state.guides, &state.detail);
      // Evaluated anew as the next frame would, after no time.
      if (level > 0) ShowBlock(*groom, b, 0, state.guides, &state.detail);
      EXPECT_LT(Farthest(Angles(*groom, state), Angles(*groom, before)), 2e-6);
      for (int Q = 0; Q < block.elements; ++Q) {
        for (int i = 0; i < 3; ++i) {
          const size_t row =
              block.state + Q * rod::layout::kStatePerElement + rod::layout::kRates + i;
          for (int lane = 0; lane < rod::layout::kLanes; ++lane) {
            EXPECT_NEAR(state.guides[row].lane[lane], before.guides[row].lane[lane], 2e-5);
          }
        }
      }
    }
  }
}

TEST(DetailTest, HairMovesOnWithoutAJumpAfterASwitch) {
  exec::WorkerPool pool(1);
  constexpr double kTolerance = 3e-3;
  const auto groom = Curly(64, 10);
  HeadState state = Tolerating(*groom, Shaken(0, 0.3));
  int switches = 0;
  for (int i = 1; i <= 300; ++i) {
    const std::vector<int> before = LevelsOf(state);
    const math::Pose now = Shaken(i / 60.0, 0.3), next = Shaken((i + 1) / 60.0, 0.3);
    Advance(*groom, {now, 1 / 60.0, 1}, Tolerant(kTolerance), &state, pool);
    if (before.empty() || before == LevelsOf(state)) continue;
    ++switches;
    // The next frame, and what full detail would make of the same moment.
    HeadState one = state, full = FullDetail(*groom, state);
    EXPECT_LT(Farthest(Angles(*groom, one), Angles(*groom, full)), 2e-6);
    Advance(*groom, {next, 1 / 60.0, 1}, Tolerant(kTolerance), &one, pool);
    Advance(*groom, {next, 1 / 60.0, 1}, {}, &full, pool);
    EXPECT_LT(Farthest(Tips(*groom, one), Tips(*groom, full)), 0.2 * kTolerance) << i;
  }
  EXPECT_GE(switches, 3);
}

TEST(DetailTest, TipsStayWithinTheToleranceOfFullDetail) {
  exec::WorkerPool pool(1);
  for (const HairType type :
       {HairType::kAsianSmooth, HairType::kCaucasianWavy, HairType::kCaucasianCurly}) {
    for (const int N : {6, 10}) {
      const auto groom = GeneratedGroom(type, 48, 0.1, N);
      for (const double size : {0.3, 1.0}) {
        for (const double tolerance : {1e-3, 3e-3, 1e-2}) {
          SCOPED_TRACE(testing::Message()
                       << int(type) << " N=" << N << " size=" << size << " " << tolerance);
          HeadState full = Tolerating(*groom, Shaken(0, size)), coarse = full;
          double worst = 0, stepped = 0;
          for (int i = 0; i < 300; ++i) {
            Play(*groom, i, i + 1, size, 0, &full, pool);
            Play(*groom, i, i + 1, size, tolerance, &coarse, pool);
            worst = std::max(worst, Farthest(Tips(*groom, full), Tips(*groom, coarse)));
            stepped += SteppedElements(*groom, coarse) / 300.0;
          }
          EXPECT_LE(worst, tolerance);
          // Smooth hair swings on for long.
          if (type == HairType::kAsianSmooth) continue;
          EXPECT_LT(stepped, 0.85 * groom->element_count());
        }
      }
    }
  }
}

TEST(DetailTest, LevelsChangeRarelyAndBendingBringsFullDetailBack) {
  exec::WorkerPool pool(1);
  const auto groom = Curly(64, 10);
  HeadState state = Tolerating(*groom, {});
  for (int i = 0; i < 120; ++i) Advance(*groom, {{}, 1 / 60.0, 1}, Tolerant(1e-3), &state, pool);
  const int calm = SteppedElements(*groom, state);
  int changes = 0;
  for (int i = 0; i < 120; ++i) {  // Two seconds of an unceasing shake.
    const std::vector<int> before = LevelsOf(state);
    Play(*groom, i, i + 1, 1, 1e-3, &state, pool);
    const std::vector<int> after = LevelsOf(state);
    for (size_t b = 0; b < after.size(); ++b) changes += after[b] != before[b];
  }
  EXPECT_LT(calm, 0.7 * groom->element_count());
  EXPECT_EQ(SteppedElements(*groom, state), groom->element_count());
  EXPECT_LE(changes, 4 * std::ssize(groom->batch.blocks()));
}

TEST(DetailTest, WithoutAToleranceNothingChangesAndTurnedOffHairGoesOn) {
  exec::WorkerPool pool(2);
  const auto groom = Curly(40, 5);
  HeadState plain = AtRest(*groom, Shaken(0, 1)), early = plain;
  HeadState never = Tolerating(*groom, Shaken(0, 1));
  Play(*groom, 0, 30, 1, 0, &plain, pool);
  // Full detail throughout, as no bend is below a tolerance of next to nothing.
  Play(*groom, 0, 30, 1, 1e-30, &never, pool);
  EXPECT_TRUE(SameRows(plain.guides, never.guides));
  // Nor does a tolerance matter before the levels are there.
  Play(*groom, 0, 30, 1, 1, &early, pool);
  EXPECT_TRUE(SameRows(plain.guides, early.guides));
  EXPECT_FALSE(early.detail.levels);

  HeadState state = Tolerating(*groom, {});
  for (int i = 0; i < 120; ++i) Advance(*groom, {{}, 1 / 60.0, 1}, Tolerant(1e-3), &state, pool);
  EXPECT_LT(SteppedElements(*groom, state), groom->element_count());
  HeadState off = state;
  Advance(*groom, {{}, 1 / 60.0, 1}, {}, &off, pool);
  EXPECT_EQ(SteppedElements(*groom, off), groom->element_count());
  EXPECT_LT(Farthest(Tips(*groom, off), Tips(*groom, state)), 1e-5);
}

TEST(DetailTest, AnyNumberOfWorkersAndACopyGiveTheSameBits) {
  const auto groom = Curly(100, 10);
  exec::WorkerPool one(1), three(3);
  HeadState a = Tolerating(*groom, Shaken(0, 0.3)), b = a;
  Play(*groom, 0, 120, 0.3, 3e-3, &a, one);
  Play(*groom, 0, 60, 0.3, 3e-3, &b, three);
  HeadState copy = b;
  Play(*groom, 60, 120, 0.3, 3e-3, &b, three);
  Play(*groom, 60, 120, 0.3, 3e-3, &copy, one);
  EXPECT_EQ(LevelsOf(a), LevelsOf(b));
  EXPECT_TRUE(SameRows(a.guides, b.guides));
  EXPECT_TRUE(SameRows(a.detail.rows, b.detail.rows));
  EXPECT_TRUE(SameRows(a.guides, copy.guides));
}

TEST(DetailTest, ResetTeleportAndDiagnosticsAreOfWhatIsShown) {
  exec::WorkerPool pool(1);
  const auto groom = Curly(40, 10);
  const HeadState rest = Tolerating(*groom, {});
  HeadState state = rest;
  Play(*groom, 0, 90, 0.1, 1e-2, &state, pool);
  ASSERT_LT(SteppedElements(*groom, state), groom->element_count());

  const Diagnostics coarse = Diagnose(*groom, state, {}, pool);
  const Diagnostics full = Diagnose(*groom, FullDetail(*groom, state), {}, pool);
  EXPECT_GT(coarse.kinetic_energy, 0);
  EXPECT_EQ(coarse.kinetic_energy, full.kinetic_energy);
  EXPECT_EQ(coarse.elastic_energy, full.elastic_energy);

  // A head that is elsewhere and faces elsewhere, and goes on as it did.
  const math::Pose gauge{{2, 1, -3}, math::FromRotationVector({0, 1.1, 0})};
  HeadState moved = state, stayed = state;
  Teleport(*groom, gauge * state.pose, &moved);
  for (int i = 91; i <= 100; ++i) {
    Advance(*groom, {Shaken(i / 60.0, 0.1), 1 / 60.0, 1}, Tolerant(1e-2), &stayed, pool);
    Advance(*groom, {gauge * Shaken(i / 60.0, 0.1), 1 / 60.0, 1}, Tolerant(1e-2), &moved, pool);
  }
  EXPECT_LT(Farthest(Angles(*groom, moved), Angles(*groom, stayed)), 1e-4);

  Reset(*groom, &state);
  EXPECT_TRUE(SameRows(state.guides, rest.guides));
  EXPECT_EQ(SteppedElements(*groom, state), groom->element_count());
}

TEST(DetailTest, WoundHairStaysAtFullDetailAndMovesAsWithout) {
  exec::WorkerPool pool(1);
  const auto groom = GeneratedGroom(HairType::kAfricanFuzzy, 20, 0.1, 10);
  for (const groom::Guide& guide : groom->guides) ASSERT_TRUE(guide.wound);
  HeadState full = Tolerating(*groom, {}), tolerant = full;
  Play(*groom, 0, 60, 1, 0, &full, pool);
  Play(*groom, 0, 60, 1, 0.01, &tolerant, pool);
  EXPECT_EQ(SteppedElements(*groom, tolerant), groom->element_count());
  EXPECT_EQ(Coordinates(*groom, tolerant), Coordinates(*groom, full));
}

}  // namespace
}  // namespace mane::head
