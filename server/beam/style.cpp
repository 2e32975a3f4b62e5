#include "beam/style.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <memory>
#include <utility>

#include "beam/bend.h"
#include "beam/bend_batch.h"
#include "beam/cut.h"
#include "beam/packing.h"
#include "beam/pores.h"
#include "beam/style_plan.h"
#include "math/random.h"

namespace mane::beam {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3f;
using simd::kLanes;

constexpr float kLeastAmbient = 0.05F;

// Rows of one piece of work.
struct Scratch {
  std::vector<simd::Row<float>> hairs, nodes;
};

class Styler {
 public:
  Styler(const BeamStyle& style, const Hull& hull, const std::string& field)
      : style_(style),
        hull_(hull),
        lifted_(Lifted(hull, std::numeric_limits<float>::epsilon())),
        prefix_(field.empty() ? field : field + ".") {
    size_t nodes = 0;
    for (size_t i = 0; i < style.parts.size(); ++i) {
      const Part& part = style.parts[i];
      const int index = static_cast<int>(i);
      Plan plan{&part,   index, Pores(lifted_, part, style.seed, index), {}, {}, nullptr, hairs_,
                blocks_, nodes};
      AddForces(&plan);
      AddCuts(style.cuts, prefix_, &plan);
      AddCuts(part.cuts, fmt::format("{}parts[{}].", prefix_, i), &plan);
      plans_.emplace_back(std::move(plan));
      hairs_ += part.count;
      blocks_ += simd::BlocksOf(part.count);
      nodes += static_cast<size_t>(part.count) * (part.segments + 1);
    }
    styled_.nodes.resize(nodes);
    styled_.pores.resize(hairs_);
    styled_.kept.resize(hairs_, 2);  // Of hair that the loop leaves out, as if it were there.
    styled_.cut_by.resize(hairs_);
    styled_.sunk.resize(hairs_);
    styled_.ambient.resize(hairs_);
  }

  void Run(const Loop& loop) {
    loop(blocks_, [&](int first, int last) {
      Scratch scratch;
      auto plan = plans_.begin();
      for (int block = first; block < last; ++block) {
        while (block >= plan->first_block + simd::BlocksOf(plan->part->count)) ++plan;
        StyleBlock(*plan, block - plan->first_block, &scratch);
      }
    });
  }

  [[nodiscard]] Result<void> Check() const {
    return CheckFit(plans_, styled_, prefix_, style_.cuts.size());
  }

  // What is left, moved together.
  StyledHairs Take() && {
    StyledHairs out;
    size_t to = 0;
    for (size_t i = 0; i < plans_.size(); ++i) {
      const Plan& plan = plans_[i];
      for (int hair = 0; hair < plan.part->count; ++hair) {
        const int kept = styled_.kept[plan.first_hair + hair];
        if (kept == 0) continue;
        const auto nodes = NodesOf(plan, hair).first(kept);
        out.part.emplace_back(static_cast<uint32_t>(i));
        out.first_node.emplace_back(static_cast<uint32_t>(to));
        out.ambient.emplace_back(styled_.ambient[plan.first_hair + hair]);
        std::copy(nodes.begin(), nodes.end(), styled_.nodes.begin() + static_cast<ptrdiff_t>(to));
        to += nodes.size();
      }
    }
    out.first_node.emplace_back(static_cast<uint32_t>(to));
    styled_.nodes.resize(to);
    out.nodes = std::move(styled_.nodes);
    return out;
  }

 private:
  void AddForces(Plan* plan) {
    BendField field;
    field.gravity.y() = -style_.gravity;
    for (const auto* forces : {&style_.forces, &plan->part->forces}) {
      for (const Force& force : *forces) {
        plan->forces.emplace_back(&force);
        field.forces.emplace_back(force);
      }
    }
    plan->batch =
        std::make_unique<BendBatch<float>>(TurnWeights(plan->part->segments), field, lifted_);
  }

  static void AddCuts(const std::vector<Cut>& cuts, const std::string& prefix, Plan* plan) {
    for (size_t c = 0; c < cuts.size(); ++c) {
      plan->cuts.emplace_back(NamedCut{&cuts[c], fmt::format("{}cuts[{}]", prefix, c)});
    }
  }

  std::span<Vector3f> NodesOf(const Plan& plan, int hair) {
    const size_t nodes = plan.part->segments + 1;
    return {styled_.nodes.data() + plan.first_node + nodes * hair, nodes};
  }

  // A hair of a part, and what of it is known before it is bent.
  BendHair Begin(const Plan& plan, int hair) {
    const Part& part = *plan.part;
    math::RandomStream random(style_.seed, StreamOf(plan.index, hair, Purpose::kHair));
    const auto fluctuating = [&](double value, double fluctuation) {
      return value * (1 + random.Uniform(-fluctuation, fluctuation));
    };
    const double length = fluctuating(part.length, part.length_fluctuation);
    const double rigidity = fluctuating(part.rigidity, part.rigidity_fluctuation);
    const int own = plan.first_hair + hair;
    styled_.ambient[own] =
        std::max(kLeastAmbient, static_cast<float>(1 + style_.ambient_deviation * random.Normal()));
    const Pore pore = plan.pores.At(hair);
    styled_.pores[own] = pore.polar;
    styled_.sunk[own] = part.tied_at && lifted_.At(pore.root) < 0 ? 1 : 0;
    const double d = length / part.segments;
    uint32_t mask = 0;
    for (size_t f = 0; f < plan.forces.size(); ++f) {
      mask |= uint32_t{Contains(plan.forces[f]->pores, pore.polar)} << f;
    }
    return {pore.root, pore.direction, d, SoftnessOf(part.line_density, d, rigidity, part.segments),
            mask};
  }

  void StyleBlock(const Plan& plan, int block, Scratch* scratch) {
    scratch->hairs.resize(plan.batch->hair_rows());
    scratch->nodes.resize(plan.batch->node_rows());
    const int first = block * kLanes, count = std::min(plan.part->count - first, kLanes);
    BendHair hairs[kLanes];
    for (int lane = 0; lane < count; ++lane) hairs[lane] = Begin(plan, first + lane);
    plan.batch->Bend(KernelsFor<float>(simd::Best()), {hairs, static_cast<size_t>(count)},
                     scratch->hairs, scratch->nodes);
    for (int lane = 0; lane < count; ++lane) {
      const auto nodes = NodesOf(plan, first + lane);
      for (int i = 0; i < static_cast<int>(nodes.size()); ++i) {
        nodes[i] = (hull_.center + VectorAt(&scratch->nodes[3 * i], lane)).cast<float>();
      }
      CutHair(plan, first + lane, hairs[lane].segment_length, nodes);
    }
  }

  void CutHair(const Plan& plan, int hair, double segment_length, std::span<Vector3f> nodes) {
    const int own = plan.first_hair + hair;
    double kept = plan.part->segments;
    uint8_t by = 0;
    for (size_t c = 0; c < plan.cuts.size(); ++c) {
      const Cut& cut = *plan.cuts[c].cut;
      if (!Contains(cut.pores, styled_.pores[own])) continue;
      const double left = KeptBy(cut, nodes, segment_length);
      if (left < kept) kept = left, by = static_cast<uint8_t>(c);
    }
    styled_.kept[own] = EndHair(kept, lifted_, nodes);
    styled_.cut_by[own] = by;
  }

  const BeamStyle& style_;
  const Hull hull_;
  const Hull lifted_;
  const std::string prefix_;  // Of fields.
  std::vector<Plan> plans_;
  int hairs_ = 0;
  int blocks_ = 0;
  MadeHairs styled_;
};

}  // namespace

Result<StyledHairs> ApplyBeamStyle(const BeamStyle& style, const Hull& hull,
                                   const std::string& field, const Loop& loop) {
  Styler styler(style, hull, field);
  styler.Run(loop);
  if (const auto ok = styler.Check(); !ok) return ok.error();
  return std::move(styler).Take();
}

}  // namespace mane::beam
