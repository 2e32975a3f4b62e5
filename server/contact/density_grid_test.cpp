// Laws of hair's volume:
//   oracle     densities are those of a sum over all points, one by one
//   rest       the rest shape, and hair near it, feels nothing
//   energy     pressure is minus the gradient of its energy, by finite differences
//   expands    hair that is pressed together is pressed apart
//   mean       damping draws to the mean of a sum over all points, one by one
//   momentum   damping keeps momentum, and kinetic energy falls; even motion is left alone
//   bounded    whatever comes in, what comes out is finite and moves no point by half a cell
//   workers    the same bits for any number of them, and no allocation once warm

#include "contact/density_grid.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>

#include "base/test_allocations.h"
#include "contact/test_wisps.h"
#include "math/random.h"
#include "rod/scheme.h"

namespace mane::contact {
namespace {

using Eigen::Vector3d;
using fixtures::CpuTime;
using fixtures::Hair;
using fixtures::HeadOfHair;
using fixtures::Impulses;

constexpr double kDt = 1.0 / 60;

DensityPoints View(const Hair& hair, const std::vector<float>& rest) {
  return {{hair.x, hair.y, hair.z}, {hair.ux, hair.uy, hair.uz}, hair.mass, rest};
}

class DensityGridTest : public testing::Test {
 protected:
  exec::WorkerPool pool_{1};

  std::vector<float> RestDensities(const Hair& hair, const DensitySettings& settings) {
    DensityGrid grid(settings);
    std::vector<float> densities(hair.size());
    grid.Densities({hair.x, hair.y, hair.z}, hair.mass, pool_, densities);
    return densities;
  }
  // Without damping.
  Impulses Pressure(const Hair& hair, const std::vector<float>& rest, DensitySettings settings,
                    double dt) {
    settings.damping_rate = 0;
    DensityGrid grid(settings);
    Impulses impulses(hair.size());
    grid.Push(View(hair, rest), dt, pool_, impulses.View());
    return impulses;
  }
};

// A corner's mass, one point after the other, in double precision.
double CornerMass(const Hair& hair, double cell, const Vector3d& corner, size_t moved = SIZE_MAX,
                  const Vector3d& by = Vector3d::Zero()) {
  double sum = 0;
  for (size_t p = 0; p < hair.size(); ++p) {
    Vector3d x(hair.x[p], hair.y[p], hair.z[p]);
    if (p == moved) x += by;
    double weight = 1;
    for (int a = 0; a < 3; ++a) weight *= std::max(0.0, 1 - std::abs(x[a] - corner[a]) / cell);
    sum += weight * hair.mass[p];
  }
  return sum;
}

TEST_F(DensityGridTest, DensitiesAreThoseOfASumOverAllPoints) {
  const Hair hair = HeadOfHair(30, 1);
  const DensitySettings settings;
  const std::vector<float> densities = RestDensities(hair, settings);
  const double volume = std::pow(settings.cell, 3);
  for (size_t p = 0; p < hair.size(); p += 37) {
    double most = 0;
    for (int k = 0; k < 8; ++k) {
      const Vector3d corner =
          settings.cell *
              (Vector3d(hair.x[p], hair.y[p], hair.z[p]) / settings.cell).array().floor() +
          settings.cell * Eigen::Array3d(k & 1, k >> 1 & 1, k >> 2);
      most = std::max(most, CornerMass(hair, settings.cell, corner) / volume);
    }
    EXPECT_NEAR(densities[p] / most, 1, 2e-4) << p;
  }
}

TEST_F(DensityGridTest, HairAtRestFeelsNothing) {
  const DensitySettings settings;
  for (const int guides : {100, 400}) {
    Hair hair = HeadOfHair(guides, 2);
    const std::vector<float> rest = RestDensities(hair, settings);
    EXPECT_EQ(Pressure(hair, rest, settings, kDt).SumOfNorms(), 0);

    // Elsewhere between the corners, random points happen to lie closer; little comes of it.
    for (size_t p = 0; p < hair.size(); ++p) hair.x[p] += 0.4f * static_cast<float>(settings.cell);
    const double moved = Pressure(hair, rest, settings, kDt).SumOfNorms();
    double mass = 0;
    for (const float m : hair.mass) mass += m;
    std::printf("%d guides, moved by 0.4 cells: mean change of velocity %.1e m/s a step\n", guides,
                moved / mass);
    EXPECT_LT(moved / mass, 2e-3);
  }
}

// Points in a small ball, pressed to a third of its width after their rest densities were taken.
struct Pressed {
  Hair hair;
  std::vector<float> rest;

  explicit Pressed(int points) {
    math::RandomStream random(3, 0);
    hair.AddGuide(0, 0);
    for (int i = 0; i < points; ++i) {
      hair.AddPoint(0.02 * Vector3d(random.Normal(), random.Normal(), random.Normal()),
                    Vector3d::Zero(), 1e-6);
    }
    rest.assign(hair.size(), 0.05f);  // [kg/m^3]
  }
};

TEST_F(DensityGridTest, PressureIsMinusTheGradientOfItsEnergy) {
  DensitySettings settings;
  settings.pressure_speed = 0.1;  // Nothing is cut.
  const Pressed pressed(60);
  const double volume = std::pow(settings.cell, 3), rest = settings.excess * 0.05;
  const auto energy = [&](size_t moved, const Vector3d& by) {
    double sum = 0;
    for (int i = 0; i < 11 * 11 * 11; ++i) {
      const Vector3d corner = settings.cell * Vector3d(i % 11 - 5, i / 11 % 11 - 5, i / 121 - 5);
      const double over =
          std::max(0.0, CornerMass(pressed.hair, settings.cell, corner, moved, by) / volume - rest);
      sum += volume * std::pow(settings.pressure_speed, 2) * over * over / (2 * rest);
    }
    return sum;
  };
  const Impulses impulses = Pressure(pressed.hair, pressed.rest, settings, kDt);
  const double courant = settings.pressure_speed * kDt / settings.cell;
  double largest = 0;
  for (size_t p = 0; p < 10; ++p) {
    Vector3d force;
    for (int a = 0; a < 3; ++a) {
      const Vector3d by = 1e-6 * Vector3d::Unit(a);
      force[a] = -(energy(p, by) - energy(p, -by)) / 2e-6;
    }
    const Vector3d impulse = rod::kTheta * kDt / (1 + courant * courant) * force;
    largest = std::max(largest, impulse.norm());
    EXPECT_LT((impulses.At(p) - impulse).norm(), 1e-3 * impulse.norm() + 1e-14) << p;
  }
  EXPECT_GT(largest, 1e-12);
}

TEST_F(DensityGridTest, HairThatIsPressedTogetherIsPressedApart) {
  const DensitySettings settings;
  Hair hair = HeadOfHair(400, 4);
  const std::vector<float> rest = RestDensities(hair, settings);
  double last = 0;
  for (const double width : {1.0, 0.7, 0.5}) {
    Hair narrow = hair;
    for (size_t p = 0; p < hair.size(); ++p) {
      narrow.x[p] *= static_cast<float>(width);
      narrow.z[p] *= static_cast<float>(width);
    }
    const Impulses impulses = Pressure(narrow, rest, settings, kDt);
    double outward = 0;
    for (size_t p = 0; p < hair.size(); ++p) {
      outward += Vector3d(narrow.x[p], 0, narrow.z[p]).normalized().dot(impulses.At(p));
    }
    std::printf("width %.1f: outward %.2e N s, sum %.2e, sum of sizes %.2e\n", width, outward,
                impulses.Sum().norm(), impulses.SumOfNorms());
    EXPECT_GE(outward, last);
    last = outward;
  }
  EXPECT_GT(last, 0);
}

TEST_F(DensityGridTest, DampingDrawsToTheMeanAround) {
  DensitySettings settings;
  settings.pressure_speed = 0;
  Hair hair = HeadOfHair(20, 13);
  fixtures::Shake(1, 14, &hair);
  const auto at = [&](size_t p) { return Vector3d(hair.x[p], hair.y[p], hair.z[p]); };
  const auto velocity = [&](size_t p) { return Vector3d(hair.ux[p], hair.uy[p], hair.uz[p]); };
  const auto weight = [&](size_t p, const Vector3d& corner) {
    return (1 - (at(p) - corner).array().abs() / settings.cell).max(0.0).prod();
  };
  DensityGrid grid(settings);
  Impulses impulses(hair.size());
  grid.Push(View(hair, std::vector<float>(hair.size(), 1.0f)), kDt, pool_, impulses.View());
  for (size_t p = 0; p < hair.size(); p += 7) {
    Vector3d mean = Vector3d::Zero();
    for (int k = 0; k < 8; ++k) {
      const Vector3d corner = settings.cell * ((at(p) / settings.cell).array().floor() +
                                               Eigen::Array3d(k & 1, k >> 1 & 1, k >> 2));
      if (weight(p, corner) == 0) continue;
      Vector3d momentum = Vector3d::Zero();
      for (size_t q = 0; q < hair.size(); ++q) {
        momentum += weight(q, corner) * hair.mass[q] * velocity(q);
      }
      mean += weight(p, corner) * momentum / CornerMass(hair, settings.cell, corner);
    }
    const Vector3d change = (1 - std::exp(-settings.damping_rate * kDt)) * (mean - velocity(p));
    EXPECT_LT((impulses.At(p) / hair.mass[p] - change).norm(), 1e-6) << p;
  }
}

TEST_F(DensityGridTest, DampingKeepsMomentumAndTakesEnergy) {
  DensitySettings settings;
  settings.damping_rate = 30;
  settings.pressure_speed = 0;
  Hair hair = HeadOfHair(200, 5);
  const std::vector<float> rest(hair.size(), 0.01f);
  DensityGrid grid(settings);
  for (const double even : {0.0, 3.0}) {
    fixtures::Shake(even > 0 ? 0 : 1, 6, &hair);
    for (float& u : hair.ux) u += static_cast<float>(even);
    Impulses impulses(hair.size());
    grid.Push(View(hair, rest), kDt, pool_, impulses.View());
    double before = 0, after = 0, momentum = 0;
    for (size_t p = 0; p < hair.size(); ++p) {
      const Vector3d u(hair.ux[p], hair.uy[p], hair.uz[p]);
      momentum += hair.mass[p] * u.norm();
      before += 0.5 * hair.mass[p] * u.squaredNorm();
      after += 0.5 * hair.mass[p] * (u + impulses.At(p) / hair.mass[p]).squaredNorm();
    }
    EXPECT_LT(impulses.Sum().norm(), 1e-7 * momentum);
    if (even > 0) {
      EXPECT_NEAR(after / before, 1, 1e-6);
    } else {
      EXPECT_LT(after, 0.8 * before);
    }
  }
}

TEST_F(DensityGridTest, WhateverComesInWhatComesOutIsBounded) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const float infinity = std::numeric_limits<float>::infinity();
  math::RandomStream random(7, 0);
  DensityGrid grid;
  for (const double dt : {0.0, 1e-9, kDt, 0.1, 1e9}) {
    Hair hair = HeadOfHair(50, 8);
    fixtures::Shake(1, 9, &hair);
    std::vector<float> rest(hair.size(), 1);
    for (std::vector<float>* list :
         {&hair.x, &hair.y, &hair.z, &hair.ux, &hair.uy, &hair.uz, &hair.mass, &rest}) {
      for (const float absurd : {nan, infinity, -infinity, 1e30f, -1e30f, 1e-30f, 9e3f, 0.0f}) {
        (*list)[random.Bits() % list->size()] = absurd;
      }
    }
    Impulses impulses(hair.size());
    for (std::vector<float>* list : {&impulses.x, &impulses.y, &impulses.z}) {
      std::fill(list->begin(), list->end(), nan);
    }
    grid.Push(View(hair, rest), dt, pool_, impulses.View());
    for (size_t p = 0; p < hair.size(); ++p) {
      ASSERT_TRUE(impulses.At(p).allFinite()) << p;
      const bool takes_part = Within({hair.x[p], hair.y[p], hair.z[p]}, 1e4f) &&
                              hair.mass[p] >= 1e-12f && hair.mass[p] <= 1e6f;
      if (!takes_part) {
        EXPECT_EQ(impulses.At(p).norm(), 0) << p;
      }
    }
  }

  // However dense, and however fast pressure is: no point moves by more than a quarter of a cell.
  Pressed pressed(2000);
  DensitySettings settings;
  settings.pressure_speed = 1e3;
  settings.cell = 0.01;
  const Impulses impulses = Pressure(pressed.hair, pressed.rest, settings, kDt);
  for (size_t p = 0; p < pressed.hair.size(); ++p) {
    EXPECT_LE(impulses.At(p).norm() * kDt / pressed.hair.mass[p], 0.2501 * settings.cell);
  }
}

TEST_F(DensityGridTest, AnyNumberOfWorkersGivesTheSameBits) {
  // As many points as five workers share, near the origin and where numbers are coarse.
  for (const float far : {0.0f, 9e3f}) {
    Hair hair = HeadOfHair(700, 10);
    for (float& z : hair.z) z += far;
    for (size_t p = 0; p < hair.size(); p += 97) hair.x[p] = 1e30f;
    const std::vector<float> rest(hair.size(), 0.01f);
    fixtures::Shake(1, 11, &hair);
    std::vector<Impulses> results;
    for (const int workers : {1, 2, 5}) {
      exec::WorkerPool pool(workers);
      DensityGrid grid;
      results.emplace_back(hair.size());
      grid.Push(View(hair, rest), kDt, pool, results.back().View());
      EXPECT_EQ(results.back().x, results.front().x);
      EXPECT_EQ(results.back().y, results.front().y);
      EXPECT_EQ(results.back().z, results.front().z);
    }
    EXPECT_GT(results.front().SumOfNorms(), 0);
  }
}

TEST_F(DensityGridTest, AWarmGridAllocatesNothingAndItsCostIsLinear) {
  for (const int guides : {50, 500, 5000}) {
    Hair hair = HeadOfHair(guides, 12);
    const std::vector<float> rest(hair.size(), 0.01f);
    DensityGrid grid;
    Impulses impulses(hair.size());
    double time = 1e9;
    for (int i = 0; i < 3; ++i) {
      const mane::fixtures::AllocationCount count;
      const double start = CpuTime();
      grid.Push(View(hair, rest), kDt, pool_, impulses.View());
      time = std::min(time, CpuTime() - start);
      EXPECT_EQ(i > 0 ? count.count() : 0, 0);
    }
    std::printf("%d guides: %.0f ns a point\n", guides,
                1e9 * time / static_cast<double>(hair.size()));
  }
}

}  // namespace
}  // namespace mane::contact
