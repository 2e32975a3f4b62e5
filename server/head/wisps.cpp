#include "head/wisps.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "contact/density_grid.h"
#include "contact/wisp_pairs.h"
#include "head/kernels.h"
#include "rod/scheme.h"

namespace mane::head {
namespace {

using contact::BlockStep;
using rod::layout::kLanes;

constexpr int kPasses = 3;  // Solutions of a step (contact.md, Hair against hair).
constexpr int kBlocksPerPiece = 2;
constexpr double kCurledBend = 150;  // Natural curvature of half curliness [1/m].

struct Lists {
  std::vector<float> x, y, z;

  void Resize(size_t n) { x.resize(n), y.resize(n), z.resize(n); }
  void Set(size_t i, const Eigen::Vector3f& v) { x[i] = v.x(), y[i] = v.y(), z[i] = v.z(); }
  [[nodiscard]] Eigen::Vector3f At(size_t i) const { return {x[i], y[i], z[i]}; }
  [[nodiscard]] contact::PointSpans Points() const { return {x, y, z}; }
  [[nodiscard]] contact::VelocitySpans Velocities() const { return {x, y, z}; }
  [[nodiscard]] contact::ImpulseSpans Impulses() { return {x, y, z}; }
};

// One thread's memory for steps of heads whose wisps meet.
struct Memory {
  std::vector<contact::BatchContactScratch> scratch;  // By block.
  std::vector<std::optional<BlockStep>> steps;
  std::vector<const contact::BodyGroup*> groups;
  Lists position, last, velocity, impulse, volume;
  contact::WispScratch wisps;
  contact::DensityGrid grid;
};

// Calls visit(step, block, point, lane, index of the point among all) for the points of block `i`.
template <typename Visit>
void ForPoints(const groom::Groom& groom, const Wisps& wisps, int i, const BlockStep& step,
               int lanes, const Visit& visit) {
  const auto& block = groom.batch.blocks()[i];
  for (int lane = 0; lane < lanes; ++lane) {
    const int first = wisps.first[wisps.place[block.strands[lane]]];
    for (int point = 0; point < step.points(); ++point) visit(point, lane, first + point);
  }
}

double Curliness(const rod::Strand& strand) {
  double bend = 0;
  for (int Q = 0; Q < strand.elements(); ++Q) {
    bend += strand.length[Q] * strand.natural[Q].tail<2>().norm();
  }
  bend /= strand.TotalLength();
  return bend / (bend + kCurledBend);
}

}  // namespace

bool HasWisps(const groom::Groom& groom) {
  return std::ranges::any_of(groom.guides,
                             [](const groom::Guide& guide) { return guide.wisp_radius > 0; });
}

Wisps MakeWisps(const groom::Groom& groom, const Bodies& bodies, exec::WorkerPool& pool) {
  Wisps wisps;
  const auto blocks = groom.batch.blocks();
  std::vector<std::vector<int>> first_points;
  wisps.place.resize(groom.guide_count());
  wisps.first = {0};
  for (const auto& block : blocks) {
    first_points.push_back(contact::FirstPoints(groom.batch, block));
    for (int lane = 0; lane < block.count; ++lane) {
      const groom::Guide& guide = groom.guides[block.strands[lane]];
      wisps.place[block.strands[lane]] = static_cast<int32_t>(wisps.radius.size());
      wisps.first.push_back(wisps.first.back() + first_points.back().back());
      wisps.radius.push_back(static_cast<float>(guide.wisp_radius));
      wisps.curliness.push_back(static_cast<float>(Curliness(guide.strand)));
    }
  }
  const size_t points = wisps.first.back();
  for (auto* list : {&wisps.mass, &wisps.x, &wisps.y, &wisps.z, &wisps.density}) {
    list->resize(points);
  }
  std::vector<rod::Row<float>> guides = bodies.settled;
  WispStep::Drive drive;
  rod::SetDrive<float>({{}, {}, rod::kLongestStep}, {}, 0, kLanes, drive);
  const contact::BatchContact among{Kernels(), Meetings(), {}, {}, {}};
  contact::BatchContactScratch scratch;
  for (int i = 0; i < std::ssize(blocks); ++i) {
    std::vector<rod::Row<float>> memory(contact::MemoryRows(first_points[i].back(), 0));
    BlockStep step(among, groom.batch, blocks[i], first_points[i], drive, memory, guides, scratch);
    step.Begin();
    ForPoints(groom, wisps, i, step, blocks[i].count, [&](int point, int lane, int index) {
      const Eigen::Vector3f p = step.Position(point, lane);
      wisps.x[index] = p.x(), wisps.y[index] = p.y(), wisps.z[index] = p.z();
      wisps.mass[index] = step.Mass(point, lane);
    });
  }
  contact::DensityGrid grid;
  grid.Densities({wisps.x, wisps.y, wisps.z}, wisps.mass, pool, wisps.density);
  return wisps;
}

void StepAmongWisps(const groom::Groom& groom, const WispStep& step,
                    std::span<rod::Row<float>> guides, Contact* contact, exec::WorkerPool& pool,
                    std::vector<uint32_t>* failed, std::vector<float>* bends) {
  thread_local Memory own;
  Memory& memory = own;  // Of this thread, in all workers.
  const Wisps& wisps = *contact->bodies->wisps;
  const auto blocks = groom.batch.blocks();
  const int count = static_cast<int>(blocks.size());
  const size_t points = wisps.mass.size();
  if (memory.scratch.size() < blocks.size()) memory.scratch.resize(blocks.size());
  memory.groups.clear();
  for (const Bodies::Group& group : contact->bodies->groups) {
    memory.groups.push_back(&group.bodies);
  }
  for (Lists* lists :
       {&memory.position, &memory.last, &memory.velocity, &memory.impulse, &memory.volume}) {
    lists->Resize(points);
  }
  if (memory.steps.size() < blocks.size()) memory.steps.resize(blocks.size());
  failed->resize(blocks.size()), bends->resize(blocks.size());
  const contact::BatchContact among{Kernels(),    Meetings(), memory.groups,
                                    step.motions, {},         step.surprise};
  const auto for_blocks = [&](const auto& visit) {
    pool.ParallelFor(count, kBlocksPerPiece, [&](int first, int last) {
      for (int i = first; i < last; ++i) visit(i);
    });
  };
  const auto for_points = [&](int i, int lanes, const auto& visit) {
    ForPoints(groom, wisps, i, *memory.steps[i], lanes, visit);
  };

  for_blocks([&](int i) {
    const Contact::Block& block = contact->blocks[i];
    BlockStep& own_step =
        memory.steps[i].emplace(among, groom.batch, blocks[i], block.first_point,
                                step.drives[step.drives.size() == 1 ? 0 : i],
                                std::span(contact->memory).subspan(block.first, block.rows), guides,
                                memory.scratch[i], true);
    own_step.Begin();
    for_points(i, blocks[i].count, [&](int point, int lane, int index) {
      memory.position.Set(index, own_step.Position(point, lane));
      memory.last.Set(index, own_step.LastVelocity(point, lane));
    });
  });
  const contact::WispPoints wisp_points{memory.position.Points(),
                                        memory.last.Velocities(),
                                        wisps.mass,
                                        {wisps.x, wisps.y, wisps.z},
                                        wisps.first,
                                        wisps.radius,
                                        wisps.curliness};
  contact->wisps.Begin(wisp_points, step.dt, memory.wisps, pool, memory.impulse.Impulses());
  memory.grid.Push({memory.position.Points(), memory.last.Velocities(), wisps.mass, wisps.density},
                   step.dt, pool, memory.volume.Impulses());

  for (int pass = 0; pass < kPasses; ++pass) {
    for_blocks([&](int i) {
      BlockStep& own_step = *memory.steps[i];
      for_points(i, kLanes, [&](int point, int lane, int index) {
        own_step.SetImpulse(point, lane, memory.impulse.At(index) + memory.volume.At(index));
      });
      // What another worker is at is left alone.
      if ((i + 1) % kBlocksPerPiece != 0 && i + 1 < count) memory.steps[i + 1]->ExpectSolve();
      own_step.Solve();
      if (pass == 0) (void)own_step.Revise();
      for_points(i, blocks[i].count, [&](int point, int lane, int index) {
        memory.velocity.Set(index, own_step.Velocity(point, lane));
      });
    });
    if (pass + 1 < kPasses) {
      contact->wisps.Revise(memory.velocity.Velocities(), memory.wisps, pool,
                            memory.impulse.Impulses());
    }
  }
  for_blocks([&](int i) {
    BlockStep& own_step = *memory.steps[i];
    while (own_step.Finish()) own_step.Solve();
    (*bends)[i] = own_step.Bend();
    (*failed)[i] = own_step.Commit();
  });
}

}  // namespace mane::head
