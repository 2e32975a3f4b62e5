#include "styling/solver.h"

#include <gtest/gtest.h>

#include <chrono>
#include <cstdio>

#include "styling/solver_fixture.h"

namespace mane::styling {
namespace {
TEST(SolverTest, Speed) {
  for (float strands : {10.f, 50.f})
    for (double tau : {0.9, 0.1}) {
      auto hair = fixtures::HairOn(fixtures::Head(), 2000, 40, 0.01, strands);
      hair.input.density_threshold = tau;
      const auto t0 = std::chrono::steady_clock::now();
      auto d = fixtures::Solve(&hair);
      const auto t1 = std::chrono::steady_clock::now();
      double rms = 0;
      for (auto& c : hair.masters.outline)
        rms += std::pow(DistanceTo(hair.input.obstacles, c.cast<double>()).distance, 2);
      std::printf(
          "strands %g tau %g: %.1f ms seg %ld tries %ld dense %ld nodes %ld cell %g n %zu rms %g\n",
          strands, tau, std::chrono::duration<double, std::milli>(t1 - t0).count(),
          d.report.segments, d.report.tries, d.report.dense_segments, d.report.nodes,
          d.density->box().cell, d.density->box().count(), std::sqrt(rms / hair.masters.joints()));
    }
}
}  // namespace
}  // namespace mane::styling
