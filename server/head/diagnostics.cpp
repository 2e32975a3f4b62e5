#include "head/diagnostics.h"

#include <algorithm>
#include <vector>

#include "rod/energy.h"
#include "rod/scheme.h"
#include "rod/statics.h"
#include "rod/wound_hessian.h"
#include "rod/wound_shape.h"
#include "rod/wound_statics.h"

namespace mane::head {
namespace {

using Eigen::Vector3d;

constexpr int kGuidesPerPiece = 16;

// A guide's state, unpacked: element angles or unknowns of a wound one.
template <typename Vector>
struct Unpacked {
  std::vector<Vector> coordinates, rate;
  std::vector<Vector3d> velocity;

  Unpacked(size_t N, int points) : coordinates(N), rate(N), velocity(N * points) {}

  [[nodiscard]] double LargestAngle() const {
    double largest = 0;
    for (const Vector& element : coordinates) largest = std::max(largest, element.norm());
    return largest;
  }
};

Diagnostics DiagnosePlain(const groom::Groom& groom, int guide, const HeadState& state,
                          const Vector3d& gravity) {
  const rod::Strand& strand = groom.guides[guide].strand;
  const math::Pose root = state.pose * groom.guides[guide].root;
  Unpacked<Vector3d> now(strand.elements(), rod::kGaussPoints);
  groom.batch.GetStrand(guide, state.guides,
                        rod::StrandState{now.coordinates, now.rate, now.velocity});
  std::vector<Vector3d> gradient(strand.elements());
  rod::PotentialGradient(strand, root, gravity, now.coordinates, gradient);
  return {.kinetic_energy = rod::KineticEnergy(strand, now.velocity),
          .elastic_energy = rod::ElasticEnergy(strand, now.coordinates),
          .gravity_energy = rod::GravityPotential(strand, root, gravity, now.coordinates),
          .largest_angle = now.LargestAngle(),
          .imbalance = rod::StaticsResidual(strand, gravity, gradient)};
}

Diagnostics DiagnoseWound(const groom::Groom& groom, int guide, const HeadState& state,
                          const Vector3d& gravity) {
  const rod::WoundStrand& wound = *groom.guides[guide].wound;
  const math::Pose root = state.pose * groom.guides[guide].root;
  Unpacked<rod::Vector4d> now(wound.elements(), rod::kBeads);
  groom.batch.GetStrand(guide, state.guides,
                        rod::WoundState{now.coordinates, now.rate, now.velocity});
  rod::WoundHessian potential;
  potential.Linearize(wound, root, gravity, now.coordinates);
  return {.kinetic_energy = rod::KineticEnergy(wound, now.velocity),
          .elastic_energy = rod::ElasticEnergy(wound, now.coordinates),
          .gravity_energy = rod::GravityPotential(wound, root, gravity, now.coordinates),
          .largest_angle = now.LargestAngle(),
          .imbalance = rod::StaticsResidual(wound, gravity, potential.gradient())};
}

void Add(const Diagnostics& guide, Diagnostics* all) {
  all->kinetic_energy += guide.kinetic_energy;
  all->elastic_energy += guide.elastic_energy;
  all->gravity_energy += guide.gravity_energy;
  all->largest_angle = std::max(all->largest_angle, guide.largest_angle);
  all->imbalance = std::max(all->imbalance, guide.imbalance);
}

// Of a head with every block at full detail.
Diagnostics DiagnoseAll(const groom::Groom& groom, const HeadState& state,
                        const Environment& environment, exec::WorkerPool& pool) {
  std::vector<Diagnostics> guides(groom.guide_count());
  pool.ParallelFor(groom.guide_count(), kGuidesPerPiece, [&](int begin, int end) {
    for (int i = begin; i < end; ++i) {
      const auto diagnose = groom.guides[i].wound ? DiagnoseWound : DiagnosePlain;
      guides[i] = diagnose(groom, i, state, environment.gravity);
    }
  });
  Diagnostics all;
  for (const Diagnostics& guide : guides) Add(guide, &all);
  return all;
}

}  // namespace

Diagnostics Diagnose(const groom::Groom& groom, const HeadState& state,
                     const Environment& environment, exec::WorkerPool& pool) {
  const auto coarse = [](const Detail::Block& block) { return block.level > 0; };
  if (std::ranges::none_of(state.detail.blocks, coarse)) {
    return DiagnoseAll(groom, state, environment, pool);
  }
  return DiagnoseAll(groom, FullDetail(groom, state), environment, pool);
}

}  // namespace mane::head
