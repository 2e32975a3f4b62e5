#include "head/detail.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/check.h"
#include "rod/chain.h"
#include "rod/coarsen.h"

namespace mane::head {
namespace {

using Eigen::Vector3d;
using rod::layout::kAngles;
using rod::layout::kLanes;
using rod::layout::kRates;
using rod::layout::kStatePerElement;
using Row = rod::Row<float>;

// What a coarse level cannot hold fades by half in about this time [s].
constexpr double kFading = 0.15;
// A block is coarsened once it would have been right for so long [s], by so much of the tolerance.
constexpr double kCalmTime = 0.25;
constexpr double kCalmShare = 0.5;
// Motion counts as the bend to which it leads within this time [s].
constexpr float kLookAhead = 0.1F;

// The rows of a coarse block.
struct Coarse {
  const Level& level;
  Row* state;
  Row* offset;  // Shown less prolonged less rest_detail [rad], and its rate [rad/s].
  Row* offset_rate;
};

Coarse CoarseOf(const groom::Groom& groom, int block, Detail* detail) {
  const Detail::Block& own = detail->blocks[block];
  const int N = groom.batch.blocks()[block].elements;
  Row* const state = &detail->rows[own.first];
  Row* const offset = state + static_cast<size_t>(N) * kStatePerElement;
  return {detail->levels->At(block, own.level), state, offset, offset + 3 * N};
}

// offset'' + 2 offset' / kFading + offset / kFading^2 = 0: critically damped, with no kink.
void Fade(double duration, int rows, Row* offset, Row* rate) {
  const double decay = std::exp(-duration / kFading);
  const auto a = static_cast<float>(decay * (1 + duration / kFading)),
             b = static_cast<float>(decay * duration),
             c = static_cast<float>(-decay * duration / (kFading * kFading)),
             d = static_cast<float>(decay * (1 - duration / kFading));
  for (int i = 0; i < rows; ++i) {
    for (int lane = 0; lane < kLanes; ++lane) {
      const float x = offset[i].lane[lane], v = rate[i].lane[lane];
      offset[i].lane[lane] = a * x + b * v;
      rate[i].lane[lane] = c * x + d * v;
    }
  }
}

// Angles and rates of coarse elements, from those shown: sums, less the rest shape.
struct Sums {
  Row angles[3];
  Row rates[3];
};

void Sum(const Level& level, const Row* shown, std::vector<Sums>* sums) {
  sums->resize(level.elements);
  for (int c = 0; c < level.elements; ++c) {
    for (int i = 0; i < 3; ++i) {
      for (int lane = 0; lane < kLanes; ++lane) {
        (*sums)[c].angles[i].lane[lane] = -level.rest[3 * c + i].lane[lane];
        (*sums)[c].rates[i].lane[lane] = 0;
      }
    }
  }
  for (size_t Q = 0; Q < level.parts.size(); ++Q) {
    Sums& part = (*sums)[level.parts[Q]];
    const Row* const element = shown + Q * kStatePerElement;
    for (int i = 0; i < 3; ++i) {
      for (int lane = 0; lane < kLanes; ++lane) {
        part.angles[i].lane[lane] += element[kAngles + i].lane[lane];
        part.rates[i].lane[lane] += element[kRates + i].lane[lane];
      }
    }
  }
}

// How far a tip may be off where a level drops the slope of curvature within its elements [m], by
// the curvatures of their neighbours (D4).
void AddBend(const Level& level, const std::vector<Sums>& sums, Row* error) {
  const int Nc = level.elements;
  for (int c = 0; c < Nc; ++c) {
    const int before = std::max(c - 1, 0), after = std::min(c + 1, Nc - 1);
    // Beyond the tip there is no moment, and so no curvature but the rest shape's.
    const float is_tip = c + 1 == Nc ? 0.0F : 1.0F;
    const Row &before_length = level.inverse_length[before],
              &after_length = level.inverse_length[after], &weight = level.bend_weight[c];
    for (int i = 0; i < 3; ++i) {
      const Row &x0 = sums[before].angles[i], &x1 = sums[after].angles[i],
                &v0 = sums[before].rates[i], &v1 = sums[after].rates[i];
      for (int lane = 0; lane < kLanes; ++lane) {
        const float l0 = before_length.lane[lane], l1 = is_tip * after_length.lane[lane];
        error->lane[lane] +=
            weight.lane[lane] * (std::abs(l1 * x1.lane[lane] - l0 * x0.lane[lane]) +
                                 kLookAhead * std::abs(l1 * v1.lane[lane] - l0 * v0.lane[lane]));
      }
    }
  }
}

// How far a tip moves while what a level cannot hold of the shown angles fades [m] (D4).
void AddLoss(const Level& level, const Row* shown, const std::vector<Sums>& sums, Row* error) {
  for (size_t Q = 0; Q < level.parts.size(); ++Q) {
    const int c = level.parts[Q];
    const Row* const element = shown + Q * kStatePerElement;
    const Row &share = level.share[Q], &length = level.length[c];
    for (int i = 0; i < 3; ++i) {
      const Row &rest = level.rest[3 * c + i], &detail = level.rest_detail[3 * Q + i];
      for (int lane = 0; lane < kLanes; ++lane) {
        const float held =
            share.lane[lane] * (sums[c].angles[i].lane[lane] + rest.lane[lane]) + detail.lane[lane];
        const float lost = element[kAngles + i].lane[lane] - held;
        const float rate =
            element[kRates + i].lane[lane] - share.lane[lane] * sums[c].rates[i].lane[lane];
        error->lane[lane] +=
            0.25F * length.lane[lane] * (std::abs(lost) + kLookAhead * std::abs(rate));
      }
    }
  }
}

// The largest error [m] of a block's strands at `level`, and what coarsening to it would lose.
double Error(const Level& level, const Row* shown, bool with_loss) {
  thread_local std::vector<Sums> sums;
  Sum(level, shown, &sums);
  Row error{};
  AddBend(level, sums, &error);
  if (with_loss) AddLoss(level, shown, sums, &error);
  return *std::ranges::max_element(error.lane);
}

void SetRow(const Vector3d& value, int lane, Row* rows) {
  for (int i = 0; i < 3; ++i) rows[i].lane[lane] = static_cast<float>(value[i]);
}

// What a lane shows beyond the prolonged angles and rates, and the rest detail.
void SetOffset(const Coarse& coarse, int lane, std::span<const Vector3d> theta,
               std::span<const Vector3d> rate, const rod::StrandState& held) {
  for (size_t Q = 0; Q < theta.size(); ++Q) {
    const int c = coarse.level.parts[Q];
    const double share = coarse.level.share[Q].lane[lane];
    const Row* const rest = &coarse.level.rest_detail[3 * Q];
    const Vector3d detail(rest[0].lane[lane], rest[1].lane[lane], rest[2].lane[lane]);
    SetRow(theta[Q] - share * held.theta[c] - detail, lane, coarse.offset + 3 * Q);
    SetRow(rate[Q] - share * held.rate[c], lane, coarse.offset_rate + 3 * Q);
  }
}

}  // namespace

void StartDetail(const groom::Groom& groom, std::shared_ptr<const Levels> levels, Detail* detail) {
  detail->levels = std::move(levels);
  detail->blocks.clear();
  size_t rows = 0;
  for (int i = 0; i < std::ssize(groom.batch.blocks()); ++i) {
    detail->blocks.push_back({.first = rows});
    if (detail->levels->Count(i) == 0) continue;
    rows += static_cast<size_t>(groom.batch.blocks()[i].elements) * (kStatePerElement + 6);
  }
  detail->rows.assign(rows, Row{});
}

Rows CoarseState(const groom::Groom& groom, int block, Detail* detail) {
  const Coarse coarse = CoarseOf(groom, block, detail);
  return {coarse.state, coarse.level.batch.state_rows()};
}

void RestLane(const groom::Groom& groom, int block, int lane, Detail* detail) {
  const Coarse coarse = CoarseOf(groom, block, detail);
  for (int c = 0; c < coarse.level.elements; ++c) {
    Row* const element = coarse.state + static_cast<size_t>(c) * kStatePerElement;
    for (int i = 0; i < kStatePerElement; ++i) element[i].lane[lane] = 0;
    for (int i = 0; i < 3; ++i) {
      element[kAngles + i].lane[lane] = coarse.level.rest[3 * c + i].lane[lane];
    }
  }
  for (size_t i = 0; i < 3 * coarse.level.parts.size(); ++i) {
    coarse.offset[i].lane[lane] = coarse.offset_rate[i].lane[lane] = 0;
  }
}

void ShowBlock(const groom::Groom& groom, int block, double duration, Rows guides, Detail* detail) {
  const Coarse coarse = CoarseOf(groom, block, detail);
  const auto& own = groom.batch.blocks()[block];
  Fade(duration, 3 * own.elements, coarse.offset, coarse.offset_rate);
  for (int Q = 0; Q < own.elements; ++Q) {
    Row* const shown = &guides[own.state + static_cast<size_t>(Q) * kStatePerElement];
    const Row* const held =
        coarse.state + static_cast<size_t>(coarse.level.parts[Q]) * kStatePerElement;
    const Row& share = coarse.level.share[Q];
    for (int i = 0; i < 3; ++i) {
      const Row &rest = coarse.level.rest_detail[3 * Q + i], &offset = coarse.offset[3 * Q + i],
                &offset_rate = coarse.offset_rate[3 * Q + i];
      for (int lane = 0; lane < kLanes; ++lane) {
        shown[kAngles + i].lane[lane] =
            share.lane[lane] * held[kAngles + i].lane[lane] + (rest.lane[lane] + offset.lane[lane]);
        shown[kRates + i].lane[lane] =
            share.lane[lane] * held[kRates + i].lane[lane] + offset_rate.lane[lane];
      }
    }
  }
}

void SwitchBlock(const groom::Groom& groom, int block, int level, const math::Pose& clamp,
                 Rows guides, Detail* detail) {
  const auto& own = groom.batch.blocks()[block];
  const int N = own.elements;
  detail->blocks[block].level = level;
  detail->blocks[block].calm = 0;
  thread_local std::vector<Vector3d> theta, rate, velocity, held, held_rate;
  thread_local std::vector<double> length;
  for (int i = 0; i < own.count; ++i) {
    const groom::Guide& guide = groom.guides[own.strands[i]];
    theta.resize(N);
    rate.resize(N);
    velocity.resize(static_cast<size_t>(N) * rod::kGaussPoints);
    groom.batch.GetStrand(own.strands[i], guides, rod::StrandState{theta, rate, velocity});
    held = theta;
    held_rate = rate;
    length = guide.strand.length;
    if (level > 0) {
      const rod::Parts& parts = detail->levels->At(block, level).parts;
      rod::Merge(parts, &held);
      rod::Merge(parts, &held_rate);
      rod::Merge(parts, &length);
    }
    velocity.resize(length.size() * rod::kGaussPoints);
    const math::Pose root = clamp * guide.root;
    const Vector3d arm = root.p - clamp.p;
    rod::GaussVelocities(length, root, detail->velocity + detail->spin.cross(arm), detail->spin,
                         held, held_rate, velocity);
    const rod::StrandState state{held, held_rate, velocity};
    if (level == 0) {
      groom.batch.SetStrand(own.strands[i], state, guides);
      continue;
    }
    const Coarse coarse = CoarseOf(groom, block, detail);
    coarse.level.batch.SetStrand(i, state, {coarse.state, coarse.level.batch.state_rows()});
    const int last = i + 1 == own.count ? kLanes : i + 1;  // Lanes past the last repeat it.
    for (int lane = i; lane < last; ++lane) SetOffset(coarse, lane, theta, rate, state);
  }
}

int ChooseLevel(const groom::Groom& groom, int block, double duration, double tolerance,
                Rows guides, Detail* detail) {
  Detail::Block& own = detail->blocks[block];
  const Levels& levels = *detail->levels;
  const Row* const shown = &guides[groom.batch.blocks()[block].state];
  if (own.level > 0 && !(Error(levels.At(block, own.level), shown, false) <= tolerance)) {
    return own.level - 1;
  }
  if (own.level == levels.Count(block)) return own.level;
  const bool calm = Error(levels.At(block, own.level + 1), shown, true) <= kCalmShare * tolerance;
  own.calm = calm ? own.calm + duration : 0;
  return own.calm >= kCalmTime ? own.level + 1 : own.level;
}

}  // namespace mane::head
