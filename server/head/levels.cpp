#include "head/levels.h"

#include <algorithm>
#include <utility>

namespace mane::head {
namespace {

using Eigen::Vector3d;
using rod::layout::kLanes;
using Rows = std::vector<rod::Row<float>>;

constexpr int kBlocksPerPiece = 1;  // One takes a quarter of a millisecond or more.
// A strand of fewer elements than these is not worth the name.
constexpr int kFewestElements = 2;
// A level is worth having from so few elements on, relative to the one before.
constexpr double kWorthwhile = 0.75;
// What merging costs, besides the rest shape, where strands move: that of a slope of curvature of
// so many radians over the strand's length squared (D1).
constexpr double kTypicalSlope = 1;
const Vector3d kGravity(0, -9.81, 0);  // Under which the groom rests.

void Set(const Vector3d& value, int lane, rod::Row<float>* rows) {
  for (int i = 0; i < 3; ++i) rows[i].lane[lane] = static_cast<float>(value[i]);
}

void SetBendWeights(const std::vector<double>& length, int lane, Level* level) {
  const int Nc = level->elements;
  for (int c = 0; c < Nc; ++c) {
    const double l = length[c];
    double distance = c == 0 || c + 1 == Nc ? l / 2 : l;
    if (c > 0) distance += length[c - 1] / 2;
    if (c + 1 < Nc) distance += length[c + 1] / 2;
    const bool merged = std::ranges::count(level->parts, c) > 1;
    level->bend_weight[c].lane[lane] = merged ? static_cast<float>(l * l * l / 12 / distance) : 0;
  }
}

// Rows of one lane: `fine` prolonged from `coarse`.
void SetLane(const rod::RestingStrand& fine, const rod::RestingStrand& coarse, int lane,
             Level* level) {
  for (int c = 0; c < level->elements; ++c) {
    Set(coarse.rest[c], lane, &level->rest[3 * c]);
    level->length[c].lane[lane] = static_cast<float>(coarse.strand.length[c]);
    level->inverse_length[c].lane[lane] = static_cast<float>(1 / coarse.strand.length[c]);
  }
  SetBendWeights(coarse.strand.length, lane, level);
  for (int Q = 0; Q < fine.strand.elements(); ++Q) {
    const int c = level->parts[Q];
    const double share = fine.strand.length[Q] / coarse.strand.length[c];
    level->share[Q].lane[lane] = static_cast<float>(share);
    Set(fine.rest[Q] - share * coarse.rest[c], lane, &level->rest_detail[3 * Q]);
  }
}

// The strands of a block: at full detail, and as far merged as was possible so far.
class Merging {
 public:
  Merging(const groom::Groom& groom, const rod::Batch<float>::Block& block)
      : groom_(groom), block_(block), forbidden_(block.elements, false) {
    for (int lane = 0; lane < block.count; ++lane) {
      const int guide = block.strands[lane];
      const std::span<const double> rest = groom.rest_of(guide);
      std::vector<Vector3d> theta(block.elements);
      for (int Q = 0; Q < block.elements; ++Q) theta[Q] = Eigen::Map<const Vector3d>(&rest[3 * Q]);
      fine_.push_back({groom.guides[guide].strand, std::move(theta)});
    }
    coarse_ = fine_;
    for (int Q = 0; Q < block.elements; ++Q) parts_.push_back(Q);
  }

  [[nodiscard]] int elements() const { return parts_.back() + 1; }

  // Merges the cheapest neighbours until `target` elements are left, or none can be merged.
  void MergeTo(int target) {
    while (elements() > target) {
      int best = -1;  // Last fine element before the joint that goes.
      double least = 0;
      for (int Q = 0; Q + 1 < block_.elements; ++Q) {
        if (parts_[Q] == parts_[Q + 1] || forbidden_[Q]) continue;
        const double cost = Cost(PartBegin(parts_[Q]), PartBegin(parts_[Q] + 2));
        if (best < 0 || cost < least) best = Q, least = cost;
      }
      if (best < 0) return;
      // What does not stay now does not stay with fewer elements either.
      if (!Adopt(Without(best))) forbidden_[best] = true;
    }
  }

  [[nodiscard]] Level MakeLevel() const {
    const int N = block_.elements, Nc = elements();
    std::vector<rod::RootedStrand> strands;
    strands.reserve(block_.count);
    for (int lane = 0; lane < block_.count; ++lane) {
      strands.push_back({&coarse_[lane].strand, groom_.guides[block_.strands[lane]].root});
    }
    Level level{.elements = Nc,
                .batch = rod::Batch<float>(strands, rod::Batch<float>::Grouping::kAsGiven),
                .parts = parts_,
                .share = Rows(N),
                .rest = Rows(3 * Nc),
                .rest_detail = Rows(3 * N),
                .length = Rows(Nc),
                .inverse_length = Rows(Nc),
                .bend_weight = Rows(Nc)};
    for (int lane = 0; lane < kLanes; ++lane) {
      const int strand = std::min(lane, block_.count - 1);  // Lanes past the last repeat it.
      SetLane(fine_[strand], coarse_[strand], lane, &level);
    }
    return level;
  }

 private:
  // The parts with the joint behind fine element `joint` taken out.
  [[nodiscard]] rod::Parts Without(int joint) const {
    rod::Parts parts = parts_;
    for (size_t Q = joint + 1; Q < parts.size(); ++Q) --parts[Q];
    return parts;
  }

  // First fine element of part `c`, or N beyond the last.
  [[nodiscard]] int PartBegin(int c) const {
    return static_cast<int>(std::ranges::lower_bound(parts_, c) - parts_.begin());
  }

  // How far the rest shape, or a typical motion, is off where the fine elements [begin, end) are of
  // one curvature [m], the worst of all strands.
  [[nodiscard]] double Cost(int begin, int end) const {
    double worst = 0;
    for (const rod::RestingStrand& strand : fine_) {
      double length = 0, loss = 0;
      Vector3d sum = Vector3d::Zero();
      for (int Q = begin; Q < end; ++Q) {
        length += strand.strand.length[Q];
        sum += strand.rest[Q];
      }
      for (int Q = begin; Q < end; ++Q) {
        const double share = strand.strand.length[Q] / length;
        loss += (strand.rest[Q] - share * sum).norm() * length / 4;
      }
      const double L = strand.strand.TotalLength();
      worst = std::max(worst, loss + kTypicalSlope * length * length * length / (12 * L * L));
    }
    return worst;
  }

  // Merges by `parts` if all strands then stay at rest.
  bool Adopt(const rod::Parts& parts) {
    std::vector<rod::RestingStrand> merged;
    for (int lane = 0; lane < block_.count; ++lane) {
      bool stable = false;
      merged.push_back(rod::Coarsen(fine_[lane], parts, groom_.guides[block_.strands[lane]].root,
                                    kGravity, &stable));
      if (!stable) return false;
    }
    coarse_ = std::move(merged);
    parts_ = parts;
    return true;
  }

  const groom::Groom& groom_;
  const rod::Batch<float>::Block& block_;
  std::vector<bool> forbidden_;  // By the fine element before a joint: it has to stay.
  std::vector<rod::RestingStrand> fine_, coarse_;
  rod::Parts parts_;
};

std::vector<Level> MakeLevels(const groom::Groom& groom, const rod::Batch<float>::Block& block) {
  std::vector<Level> levels;
  if (block.kind == rod::layout::Kind::kWound || block.elements > Levels::kMostElements) {
    return levels;
  }
  Merging merging(groom, block);
  for (int k = 1; k <= Levels::kMost; ++k) {
    const int before = merging.elements();
    merging.MergeTo(std::max(kFewestElements, (block.elements + (1 << k) - 1) >> k));
    if (merging.elements() > kWorthwhile * before) break;
    levels.push_back(merging.MakeLevel());
  }
  return levels;
}

}  // namespace

Levels::Levels(const groom::Groom& groom, exec::WorkerPool& pool)
    : blocks_(groom.batch.blocks().size()) {
  pool.ParallelFor(static_cast<int>(blocks_.size()), kBlocksPerPiece, [&](int begin, int end) {
    for (int i = begin; i < end; ++i) blocks_[i] = MakeLevels(groom, groom.batch.blocks()[i]);
  });
}

}  // namespace mane::head
