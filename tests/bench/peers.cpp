// Mane's own rows of the comparison with other rod codes: one strand, clamped horizontally, that
// settles under gravity, and the cost of its step. Prints one JSON object; peers.py merges it.

#include <fmt/format.h>

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <ctime>
#include <string>
#include <vector>

#include "rod/batch.h"
#include "rod/chain.h"
#include "rod/graded_lengths.h"
#include "rod/scheme.h"
#include "rod/strand.h"
#include "simd/isa.h"

namespace {

using Eigen::Vector3d;

constexpr double kLength = 0.2;        // [m]
constexpr double kRadius = 35e-6;      // [m]
constexpr double kSettling = 10;       // [s]
constexpr double kDt = 1.0 / 60;       // [s]
constexpr double kDragRate = 5;        // nu / (rho S) while the strand settles [1/s].
constexpr double kFriction = 1e-10;    // gamma [kg m^3/s]
constexpr double kRestSpeed = 1e-3;    // Of the last element, in radians a second.
constexpr double kMeasuredTime = 0.1;  // Processor time of one repetition [s].
constexpr int kRepetitions = 7;

// With the element lengths that generated hair has.
mane::rod::Strand MakeStrand(int elements) {
  const mane::rod::Section section{kRadius, kRadius};
  const mane::rod::Material material{4e9, 0.48, 1300};
  mane::rod::Strand strand;
  strand.natural.assign(elements, Vector3d::Zero());
  strand.stiffness = Stiffness(section, material);
  strand.linear_density = LinearDensity(section, material);
  strand.length = mane::rod::GradedLengths({.length = kLength,
                                            .stiffness = strand.stiffness[1],
                                            .linear_density = strand.linear_density},
                                           elements);
  strand.internal_friction = kFriction;
  strand.air_drag = kDragRate * strand.linear_density;
  return strand;
}

// A block of equal strands, one a lane, by the kernel of the fastest instruction set. They start
// from their natural shape at rest: the tangent is world x, gravity along -z.
class Engine {
 public:
  static constexpr int kStrands = mane::rod::layout::kLanes;

  explicit Engine(int elements)
      : strand_(MakeStrand(elements)),
        batch_(std::vector<mane::rod::RootedStrand>(kStrands, {&strand_, {}})),
        state_(batch_.state_rows()),
        theta_(elements, Vector3d::Zero()),
        rate_(theta_),
        velocity_(elements * mane::rod::kGaussPoints, Vector3d::Zero()) {
    for (int i = 0; i < kStrands; ++i) batch_.SetStrand(i, {theta_, rate_, velocity_}, state_);
    mane::rod::Surroundings air;
    air.gravity = {0, 0, -9.81};
    mane::rod::SetDrive<float>({{}, {}, kDt}, air, 0, kStrands, drive_);
  }

  static std::string Name() {
    return fmt::format("mane ({}, float32)", mane::simd::Name(mane::simd::Best()));
  }

  /// Advances every strand by one step. Whether the state is finite.
  bool Step() {
    return mane::rod::StepBlock<float>(kernels_, batch_, batch_.blocks()[0], drive_, state_,
                                       scratch_) == 0;
  }

  /// Of the first strand, as all are equal.
  Vector3d Tip() {
    batch_.GetStrand(0, state_, {theta_, rate_, velocity_});
    return ElementFrames(strand_, {}, theta_).back().r;
  }
  double Speed() {
    batch_.GetStrand(0, state_, {theta_, rate_, velocity_});
    return rate_.back().norm();
  }

 private:
  const mane::rod::Strand strand_;
  const mane::rod::Batch<float> batch_;
  const mane::rod::KernelTable<float>& kernels_ = mane::rod::KernelsFor<float>(mane::simd::Best());
  std::vector<mane::rod::Row<float>> state_;
  std::array<mane::rod::Row<float>, mane::rod::layout::kDriveRows> drive_;
  mane::rod::BatchScratch scratch_;
  std::vector<Vector3d> theta_, rate_, velocity_;  // Of one strand.
};

// Processor time of this thread [s].
double CpuTime() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

// Median processor time of one strand's step [us], from rest on: the cost does not depend on the
// state.
double MicrosecondsPerStep(Engine& engine) {
  std::vector<double> times;
  for (int i = 0; i < kRepetitions; ++i) {
    const double start = CpuTime();
    double end = start;
    int steps = 0;
    for (; end < start + kMeasuredTime; steps += 100, end = CpuTime()) {
      for (int j = 0; j < 100; ++j) (void)engine.Step();
    }
    times.push_back((end - start) * 1e6 / steps / Engine::kStrands);
  }
  std::nth_element(times.begin(), times.begin() + kRepetitions / 2, times.end());
  return times[kRepetitions / 2];
}

std::string Row(int elements, double reference_x, double reference_z) {
  Engine engine(elements);
  bool ok = true;
  for (int i = 0; ok && i < kSettling / kDt; ++i) ok = engine.Step();
  ok = ok && engine.Speed() < kRestSpeed;
  const Vector3d tip = engine.Tip();
  const double error = std::hypot(tip.x() - reference_x, tip.y(), tip.z() - reference_z) / kLength;
  return fmt::format(
      R"({{"name": "{}", "segments": {}, "dt": {:.9g}, "us_per_strand_step": {:.6g}, )"
      R"("tip_error_over_L": {}}})",
      Engine::Name(), elements, kDt, MicrosecondsPerStep(engine),
      ok ? fmt::format("{:.6g}", error) : "null");
}

}  // namespace

// peers X Z N...: the exact tip [m], then the numbers of elements.
int main(int argc, char** argv) {
  if (argc < 4) {
    fmt::print(stderr, "usage: peers X Z N...\n");
    return 2;
  }
  std::string rows;
  for (int i = 3; i < argc; ++i) {
    if (i > 3) rows += ", ";
    rows += Row(std::stoi(argv[i]), std::stod(argv[1]), std::stod(argv[2]));
  }
  fmt::print("{{\"rows\": [{}]}}\n", rows);
}
