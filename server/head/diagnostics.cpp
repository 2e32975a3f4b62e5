#include "head/diagnostics.h"

#include <algorithm>
#include <span>
#include <vector>

#include "rod/energy.h"
#include "rod/scheme.h"

namespace mane::head {
namespace {

using Eigen::Vector3d;

constexpr int kGuidesPerPiece = 16;

// A guide's state, unpacked.
struct Scratch {
  std::vector<Vector3d> theta, rate, velocity, gradient;

  explicit Scratch(size_t N) : theta(N), rate(N), velocity(N * rod::kGaussPoints), gradient(N) {}
};

double Imbalance(const rod::Strand& strand, const Vector3d& gravity,
                 std::span<const Vector3d> gradient) {
  const double L = strand.TotalLength();
  double scale = strand.linear_density * gravity.norm() * L * L / 2;
  if (scale == 0) {
    scale = strand.stiffness.maxCoeff() / *std::ranges::min_element(strand.length);
  }
  double largest = 0;
  for (const Vector3d& moment : gradient) largest = std::max(largest, moment.norm());
  return largest / scale;
}

Diagnostics DiagnoseGuide(const groom::Groom& groom, int guide, const HeadState& state,
                          const Environment& environment) {
  const rod::Strand& strand = groom.guides[guide].strand;
  const math::Pose root = state.pose * groom.guides[guide].root;
  Scratch s(strand.elements());
  groom.batch.GetStrand(guide, state.guides, {s.theta, s.rate, s.velocity});
  rod::PotentialGradient(strand, root, environment.gravity, s.theta, s.gradient);
  double largest_angle = 0;
  for (const Vector3d& theta : s.theta) largest_angle = std::max(largest_angle, theta.norm());
  return {.kinetic_energy = rod::KineticEnergy(strand, s.velocity),
          .elastic_energy = rod::ElasticEnergy(strand, s.theta),
          .gravity_energy = rod::GravityPotential(strand, root, environment.gravity, s.theta),
          .largest_angle = largest_angle,
          .imbalance = Imbalance(strand, environment.gravity, s.gradient)};
}

void Add(const Diagnostics& guide, Diagnostics* all) {
  all->kinetic_energy += guide.kinetic_energy;
  all->elastic_energy += guide.elastic_energy;
  all->gravity_energy += guide.gravity_energy;
  all->largest_angle = std::max(all->largest_angle, guide.largest_angle);
  all->imbalance = std::max(all->imbalance, guide.imbalance);
}

}  // namespace

Diagnostics Diagnose(const groom::Groom& groom, const HeadState& state,
                     const Environment& environment, exec::WorkerPool& pool) {
  if (state.detail.levels) return Diagnose(groom, FullDetail(groom, state), environment, pool);
  std::vector<Diagnostics> guides(groom.guide_count());
  pool.ParallelFor(groom.guide_count(), kGuidesPerPiece, [&](int begin, int end) {
    for (int i = begin; i < end; ++i) guides[i] = DiagnoseGuide(groom, i, state, environment);
  });
  Diagnostics all;
  for (const Diagnostics& guide : guides) Add(guide, &all);
  return all;
}

}  // namespace mane::head
