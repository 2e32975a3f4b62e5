#include <gtest/gtest.h>
#include <cstdio>
#include "contact/test_wisps.h"
namespace mane::contact {
namespace {
using Eigen::Vector3d;
TEST(WispImpulseTest, Explore) {
  for (const bool extra : {false, true})
    for (const bool rigid : {false, true})
      for (const int passes : {2, 3, 4})
        for (const double dt : {1.0 / 240, 1.0 / 60, 1.0 / 10})
          for (const double v : {0.1, 1.0, 4.0}) {
            fixtures::Rods rods;
            rods.settings.root_length = 0;
            rods.passes = passes;
            rods.extrapolates = extra;
            rods.Add({-0.05, 0, 0}, {0.05, 0, 0}, rigid ? 11 : 2, 1e-4, 0.005f, 0, {0, 0, 0},
                     rigid);
            rods.Add({0.003, 0.035, -0.048}, {0.003, 0.035, 0.052}, rigid ? 11 : 2, 1e-4, 0.005f, 0,
                     {0, -v, 0}, rigid);
            rods.WatchDistance();
            double ke = rods.KineticEnergy(), worst = 0;
            for (int i = 0; i < 0.6 / v / dt + 3; ++i) {
              rods.Step(dt);
              worst = std::max(worst, rods.KineticEnergy() / ke);
              ke = rods.KineticEnergy();
            }
            std::printf(
                "extra %d rigid %d passes %d dt %.4f v %.1f least %.4f side %+.4f worst KE ratio "
                "%.6f w "
                "%.4f\n",
                extra, rigid, passes, dt, v, rods.least_distance(),
                rods.Centre(1).y() - rods.Centre(0).y(), worst,
                (rods.MeanVelocity(1) - rods.MeanVelocity(0)).y());
          }
}
}  // namespace
}  // namespace mane::contact

#include <chrono>
namespace mane::contact {
namespace {
double Cpu() {
  timespec t;
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return double(t.tv_sec) + 1e-9 * double(t.tv_nsec);
}
TEST(WispImpulseTest, Scale) {
  for (int guides : {50, 100, 500, 1000, 5000}) {
    fixtures::Hair hair = fixtures::HeadOfHair(guides, 1);
    hair.RestHere();
    for (double speed : {0.0, 0.3}) {
      fixtures::Shake(speed, 2, &hair);
      WispTracker tracker;
      WispScratch scratch;
      exec::WorkerPool pool(1);
      fixtures::Impulses p(hair.size());
      double begin = 1e9, revise = 1e9, grid = 1e9;
      size_t segs = hair.size();
      for (int i = 0; i < 4; ++i) {
        auto t0 = Cpu();
        tracker.Begin(hair.View(), 1.0 / 60, scratch, pool, p.View());
        auto t1 = Cpu();
        tracker.Revise({hair.ux, hair.uy, hair.uz}, scratch, pool, p.View());
        auto t2 = Cpu();
        scratch.grid.Build(scratch.boxes);
        auto t3 = Cpu();
        begin = std::min(begin, t1 - t0);
        revise = std::min(revise, t2 - t1);
        grid = std::min(grid, t3 - t2);
      }
      size_t overlaps = 0;
      {
        auto t0 = Cpu();
        for (int b = 0; b < (int)segs; ++b)
          scratch.grid.ForOverlapping(b, [&](int) { ++overlaps; });
        std::printf("overlaps %.1f/seg in %.0f ns/seg ", (double)overlaps / (double)segs,
                    (Cpu() - t0) * 1e9 / (double)segs);
      }
      size_t contacts = 0;
      for (auto& c : scratch.pieces) contacts += c.contacts.size();
      std::printf(
          "guides %d speed %.1f points %zu pairs %zu per guide %.1f tests/seg %.0f begin %.2f ms "
          "(%.0f ns/pt) grid %.2f ms revise %.2f ms (%.0f ns/pair) sum %g of %g\n",
          guides, speed, segs, tracker.pairs().size(), double(tracker.pairs().size()) / guides,
          scratch.grid.tests() / segs, begin * 1e3, begin * 1e9 / segs, grid * 1e3, revise * 1e3,
          revise * 1e9 / tracker.pairs().size(), p.Sum().norm(), p.SumOfNorms());
    }
  }
}
}
}
