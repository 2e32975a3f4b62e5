#pragma once

#include <array>
#include <vector>

#include "base/result.h"
#include "contact/field_block.h"
#include "contact/field_grid.h"
#include "contact/mesh_field.h"
#include "contact/solid_distance.h"
#include "exec/worker_pool.h"

namespace mane::contact {

/// Samples an exact distance into a grid.
///
/// A root cell is divided where the band crosses it, and one elsewhere and a child cut in two,
/// again and again, while the interpolation misses the exact distance at the corners of the next
/// cut by more than the tolerance there; once the cells are many, in the middle of each by more
/// than a share of it, which takes an eighth of the time.
///
/// Deterministic: root cells are worked off in fixed pieces, each of which owns what it makes.
class FieldBuilder {
 public:
  /// All outlive the builder.
  FieldBuilder(const SolidDistance& truth, const FieldOptions& options, exec::WorkerPool* pool,
               SearchBudget* budget)
      : truth_(truth), options_(options), pool_(pool), budget_(budget) {}

  /// @return RESOURCE_EXHAUSTED where the grid would take more than options.max_bytes; errors
  ///   of the budget.
  [[nodiscard]] Result<FieldGrid> Build();

  /// Largest error [m] of the built `grid` at random points in the band, n of them in each child;
  /// any number once the budget is over.
  [[nodiscard]] double MaxError(const FieldGrid& grid) const;

 private:
  struct Piece;

  void LayOut();
  void SampleRoots();
  [[nodiscard]] FieldBlock RootBlock(int root) const;
  void DivideRoot(int root, Piece* piece) const;
  [[nodiscard]] Result<void> LookAhead() const;
  [[nodiscard]] Result<void> DivideAll();
  void MatchAll();

  [[nodiscard]] double Away(const FieldBlock& block) const;
  [[nodiscard]] bool NeedsNoTest(const FieldBlock& block) const;
  [[nodiscard]] FieldBlock Cut(FieldBlock block) const;
  [[nodiscard]] bool FitsCorners(const FieldBlock& coarse, const FieldBlock& fine) const;
  [[nodiscard]] bool FitsMiddles(const FieldBlock& block) const;

  [[nodiscard]] double ErrorAt(const FieldGrid& grid, int root, const Eigen::Vector3d& low,
                               const Eigen::Vector3d& share) const;
  [[nodiscard]] double Allowed(double distance) const;
  [[nodiscard]] std::array<int, 3> PlaceOf(int root) const;

  const SolidDistance& truth_;
  const FieldOptions& options_;
  exec::WorkerPool* const pool_;
  SearchBudget* const budget_;
  FieldGrid grid_;                     // Until Build returns it.
  std::array<int, 3> cells_{};         // Of the grid.
  std::vector<double> root_distance_;  // Unsigned, by root corner [m].
};

}  // namespace mane::contact
