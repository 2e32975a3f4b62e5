#include "head/wisps.h"

#include <algorithm>
#include <array>
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

constexpr int kPasses = 3;      // Solutions of a step (contact.md, Hair against hair),
constexpr int kMostPasses = 6;  // and of those that would nearly pass through each other.
constexpr int kBlocksPerPiece = 2;
constexpr double kCurledBend = 150;  // Natural curvature of half curliness [1/m].

struct Lists {
  std::vector<float> x, y, z;

  void Resize(size_t n) { x.resize(n), y.resize(n), z.resize(n); }
  void Set(size_t i, BlockStep::Vectors v, int lane) {
    x[i] = v[0].lane[lane], y[i] = v[1].lane[lane], z[i] = v[2].lane[lane];
  }
  [[nodiscard]] contact::PointSpans Points() const { return {x, y, z}; }
  [[nodiscard]] contact::VelocitySpans Velocities() const { return {x, y, z}; }
  [[nodiscard]] contact::ImpulseSpans Impulses() { return {x, y, z}; }
};

// One thread's memory for steps of heads whose wisps meet.
struct Memory {
  std::vector<contact::BatchContactScratch> scratch;  // By block.
  std::vector<std::optional<BlockStep>> steps;
  std::vector<const contact::BodyGroup*> groups;
  std::vector<uint8_t> due;  // Which blocks are solved once more.
  Lists position, last, velocity, impulse, volume;
  contact::WispScratch wisps;
  contact::DensityGrid grid;
};

// Where the points of each strand of a block begin among all; the last lanes repeat one.
std::array<int, kLanes> FirstPoints(const Wisps& wisps, const rod::Batch<float>::Block& block) {
  std::array<int, kLanes> first;
  for (int lane = 0; lane < kLanes; ++lane) {
    first[lane] = wisps.first[wisps.place[block.strands[lane]]];
  }
  return first;
}

// Calls visit(point, lane, index of the point among all) for the points of a block.
template <typename Visit>
void ForPoints(const Wisps& wisps, const rod::Batch<float>::Block& block, const BlockStep& step,
               const Visit& visit) {
  const std::array<int, kLanes> first = FirstPoints(wisps, block);
  for (int point = 0; point < step.points(); ++point) {
    for (int lane = 0; lane < block.count; ++lane) visit(point, lane, first[lane] + point);
  }
}

// The sums of two lists' numbers of a point of a block.
std::array<rod::Row<float>, 3> Sums(const Lists& a, const Lists& b,
                                    const std::array<int, kLanes>& first, int point) {
  std::array<rod::Row<float>, 3> sums;
  for (int lane = 0; lane < kLanes; ++lane) {
    const int i = first[lane] + point;
    sums[0].lane[lane] = a.x[i] + b.x[i];
    sums[1].lane[lane] = a.y[i] + b.y[i];
    sums[2].lane[lane] = a.z[i] + b.z[i];
  }
  return sums;
}

// Marks the blocks that hold any of `guides`, which are counted block by block and rise.
void FindBlocks(std::span<const rod::Batch<float>::Block> blocks, std::span<const int32_t> guides,
                std::vector<uint8_t>* due) {
  due->assign(blocks.size(), 0);
  size_t i = 0;
  int end = blocks[0].count;
  for (const int32_t guide : guides) {
    while (guide >= end) end += blocks[++i].count;
    (*due)[i] = 1;
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
    ForPoints(wisps, blocks[i], step, [&](int point, int lane, int index) {
      const BlockStep::Vectors p = step.Position(point);
      wisps.x[index] = p[0].lane[lane], wisps.y[index] = p[1].lane[lane],
      wisps.z[index] = p[2].lane[lane];
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
  failed->resize(blocks.size()), bends->resize(blocks.size()), memory.due.resize(blocks.size());
  const contact::BatchContact among{Kernels(),    Meetings(), memory.groups,
                                    step.motions, {},         step.surprise};
  const auto for_blocks = [&](const auto& visit) {
    pool.ParallelFor(count, kBlocksPerPiece, [&](int first, int last) {
      for (int i = first; i < last; ++i) visit(i);
    });
  };

  for_blocks([&](int i) {
    const Contact::Block& block = contact->blocks[i];
    BlockStep& own_step =
        memory.steps[i].emplace(among, groom.batch, blocks[i], block.first_point,
                                step.drives[step.drives.size() == 1 ? 0 : i],
                                std::span(contact->memory).subspan(block.first, block.rows), guides,
                                memory.scratch[i], true);
    own_step.Begin();
    ForPoints(wisps, blocks[i], own_step, [&](int point, int lane, int index) {
      memory.position.Set(index, own_step.Position(point), lane);
      memory.last.Set(index, own_step.LastVelocity(point), lane);
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

  const auto solve = [&](int i, bool is_first) {
    BlockStep& own_step = *memory.steps[i];
    const std::array<int, kLanes> first = FirstPoints(wisps, blocks[i]);
    for (int point = 0; point < own_step.points(); ++point) {
      own_step.SetImpulse(point, Sums(memory.impulse, memory.volume, first, point));
    }
    // What another worker is at is left alone.
    if ((i + 1) % kBlocksPerPiece != 0 && i + 1 < count) memory.steps[i + 1]->ExpectSolve();
    own_step.Solve();
    if (is_first) (void)own_step.Revise();
    ForPoints(wisps, blocks[i], own_step, [&](int point, int lane, int index) {
      memory.velocity.Set(index, own_step.Velocity(point), lane);
    });
  };
  for (int pass = 0; pass < kPasses; ++pass) {
    for_blocks([&](int i) { solve(i, pass == 0); });
    if (pass + 1 < kPasses) {
      contact->wisps.Revise(memory.velocity.Velocities(), memory.wisps, pool,
                            memory.impulse.Impulses());
    }
  }
  for (int pass = kPasses; pass < kMostPasses; ++pass) {
    const std::span<const int32_t> revised = contact->wisps.RevisePassing(
        memory.velocity.Velocities(), memory.wisps, pool, memory.impulse.Impulses());
    if (revised.empty()) break;
    FindBlocks(blocks, revised, &memory.due);
    for_blocks([&](int i) {
      if (memory.due[i] != 0) solve(i, false);
    });
  }
  for_blocks([&](int i) {
    BlockStep& own_step = *memory.steps[i];
    while (own_step.Finish()) own_step.Solve();
    (*bends)[i] = own_step.Bend();
    (*failed)[i] = own_step.Commit();
  });
}

}  // namespace mane::head
