// Properties of imported shapes that are reported held:
//   stays         stepped as heads step them, at the longest step, they stay where they are
//   reports       what statics alone would hold, and does not stay, is stiffened or reported

#include <gtest/gtest.h>

#include <cmath>

#include "groom/import.h"
#include "rod/chain.h"
#include "rod/scheme.h"
#include "rod/test_batches.h"

namespace mane::groom {
namespace {

using Eigen::Vector3d;

// A strand of 0.2 m that rises from the root and falls over: its tangent is (sin a, cos a,
// sideways sin 3s), normalised, where a goes from `start` on by 240 degrees and s from 0 to 1.
ImportedStrand FallingOver(double sideways, double start_degrees) {
  constexpr int kSegments = 60;
  ImportedStrand strand;
  Vector3d point = Vector3d::Zero();
  strand.points.push_back(point.cast<float>());
  for (int i = 0; i < kSegments; ++i) {
    const double s = (i + 0.5) / kSegments, a = (start_degrees + 240 * s) * M_PI / 180;
    const Vector3d tangent(std::sin(a), std::cos(a), sideways * std::sin(3 * s));
    point += 0.2 / kSegments * tangent.normalized();
    strand.points.push_back(point.cast<float>());
  }
  return strand;
}

std::vector<ImportedStrand> Family() {
  std::vector<ImportedStrand> strands;
  for (const double sideways : {0.0, 0.25, 0.5, 0.75, 1.0}) {
    for (const double start : {30, 50, 60, 70, 80, 90, 100}) {
      strands.push_back(FallingOver(sideways, start));
    }
  }
  return strands;
}

Import ImportFamily(double max_stiffness_factor) {
  ImportOptions options;
  options.hair_type = HairType::kAsianSmooth;
  options.max_stiffness_factor = max_stiffness_factor;
  exec::WorkerPool pool(2);
  return *ImportStrands(Family(), options, pool);
}

// Largest distance of an element end from where it starts, over the length, strand by strand, in
// twenty seconds of the batched step.
std::vector<double> Moved(const Import& import, double dt) {
  rod::fixtures::Packed<float> packed;
  auto rest = import.rest.begin();
  for (const Guide& guide : import.guides) {
    rod::fixtures::State state(guide.strand);
    for (Vector3d& theta : state.theta) {
      for (double& angle : theta) angle = *rest++;
    }
    packed.Add(guide.strand, guide.root, state);
  }
  packed.Pack();
  const auto& kernels = rod::KernelsFor<float>(simd::Supported().back());
  std::vector<double> moved(import.guides.size(), 0);
  for (int frame = 1; frame <= 20 / dt; ++frame) {
    EXPECT_EQ(packed.Step(kernels, {{}, {}, dt}, {}), 0u);
    if (frame % 10 != 0) continue;
    for (int i = 0; i < packed.size(); ++i) {
      const rod::Strand& strand = packed.strand(i);
      const auto ends = rod::ElementFrames(strand, packed.root(i), packed.Get(i).theta);
      const auto starts = rod::ElementFrames(strand, packed.root(i), packed.start(i).theta);
      for (size_t Q = 0; Q < ends.size(); ++Q) {
        moved[i] = std::max(moved[i], (ends[Q].r - starts[Q].r).norm() / strand.TotalLength());
      }
    }
  }
  return moved;
}

TEST(ImportStaysTest, WhatIsReportedHeldStaysOnHeads) {
  for (const double max_stiffness_factor : {4.0, 1000.0}) {
    const Import import = ImportFamily(max_stiffness_factor);
    int held = 0;
    for (const double dt : {rod::kLongestStep, rod::kLongestStep / 2}) {
      const std::vector<double> moved = Moved(import, dt);
      for (size_t i = 0; i < moved.size(); ++i) {
        if (!import.outcomes[i].held) continue;
        ++held;
        EXPECT_LT(moved[i], 1e-3) << "strand " << i << ", dt " << dt << ", factor "
                                  << import.outcomes[i].stiffness_factor;
      }
    }
    EXPECT_GT(held, 5);
  }
}

TEST(ImportStaysTest, WhatDoesNotStayIsStiffenedWithinTheRangeElseReported) {
  // Statics alone would hold it with 3.46.
  const size_t index = 2 * 7 + 3;
  const StrandOutcome strict = ImportFamily(3.5).outcomes[index];
  EXPECT_FALSE(strict.held);
  EXPECT_FLOAT_EQ(strict.stiffness_factor, 3.5f);
  EXPECT_GT(strict.needed_stiffness_factor, strict.stiffness_factor);
  EXPECT_GT(strict.largest_deviation, 0.02f);  // A tenth of its length.
  const StrandOutcome free = ImportFamily(1000).outcomes[index];
  EXPECT_TRUE(free.held);
  EXPECT_EQ(free.stiffness_factor, strict.needed_stiffness_factor);
  EXPECT_LT(free.largest_deviation, 1e-5f);
}

}  // namespace
}  // namespace mane::groom
