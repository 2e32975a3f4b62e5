#pragma once

#include <Eigen/Core>

#include <span>
#include <vector>

#include "exec/worker_pool.h"
#include "groom/groom.h"
#include "rod/batch.h"
#include "rod/coarsen.h"

namespace mane::head {

/// A block of guides with fewer elements, lane by lane as the groom's batch has it (rod.md,
/// Detail).
struct Level {
  int elements;             ///< Of a coarse strand, Nc.
  rod::Batch<float> batch;  ///< One block.
  rod::Parts parts;         ///< Coarse element of each fine one, (N).
  // Rows of one number a lane.
  std::vector<rod::Row<float>> share;        ///< Length of fine over coarse element, (N).
  std::vector<rod::Row<float>> rest;         ///< Angles of the coarse rest shape [rad], (Nc x 3).
  std::vector<rod::Row<float>> rest_detail;  ///< Fine rest shape less the prolonged one, (N x 3).
  std::vector<rod::Row<float>> length, inverse_length;  ///< [m], [1/m], (Nc).
  /// l^3 / 12 over the distance of the neighbours' middles, or of the tip [m^2]; 0 where only one
  /// fine element is merged, (Nc).
  std::vector<rod::Row<float>> bend_weight;
};

/// The coarser levels of a groom, of about half and a quarter of the elements. Elements are merged
/// where that changes the rest shapes least, and only where the merged rest shapes of all strands
/// of the block stay (rod::Coarsen). Immutable; a function of the groom, so that all its heads may
/// share them.
class Levels {
 public:
  /// Levels 0 (all elements), 1 and 2.
  static constexpr int kMost = 2;
  /// Strands of more elements have no coarser levels, as the time to find them grows with the
  /// square of that number.
  static constexpr int kMostElements = 64;

  /// Takes 0.16 us of one core an element and element of its strand, 0.3 us next to buckling: 1 ms
  /// for 64 guides of 10, four to eight seconds for a groom as large as groom::Limits lets in.
  Levels(const groom::Groom& groom, exec::WorkerPool& pool);

  /// Levels that a block can be taken to besides 0: fewer where its strands have few elements, or
  /// where too few of them can be merged; none where they are wound, which has few as it is, or
  /// have more than kMostElements.
  [[nodiscard]] int Count(int block) const { return static_cast<int>(blocks_[block].size()); }
  /// Level `k` of a block, 1 to Count.
  [[nodiscard]] const Level& At(int block, int k) const { return blocks_[block][k - 1]; }

 private:
  std::vector<std::vector<Level>> blocks_;
};

}  // namespace mane::head
