#pragma once

#include <Eigen/Core>

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "math/rigid.h"
#include "rod/batch_layout.h"
#include "rod/kernels.h"
#include "rod/step.h"
#include "rod/strand.h"
#include "rod/wound.h"
#include "simd/rows.h"

namespace mane::rod {

using simd::Row;

/// A strand and the frame of its root in the head it grows on.
struct RootedStrand {
  const Strand* strand;
  math::Pose root;
  const WoundStrand* wound = nullptr;  ///< Where it is to move as a wound one; of the same strand.
};

/// Strands packed into blocks of equal element number for the batched step (rod.md, Batch), with
/// their constants. Immutable; what moves is a separate array of `state_rows()` rows.
///
/// T is float where speed counts, double where tests compare with step.h.
template <typename T>
class Batch {
 public:
  /// Up to kLanes strands of one kind and equal N. Lanes past `count` repeat the last strand, and
  /// count for nothing.
  struct Block {
    layout::Kind kind;
    int elements;
    int count;
    std::array<int, layout::kLanes> strands;  ///< Index of each lane's strand.
    size_t constants;                         ///< First row in the constants.
    size_t state;                             ///< First row in a state.
  };

  /// Which strands share a block.
  enum class Grouping {
    /// Those of equal N that wind about as far within an element; of these, with roots near each
    /// other: they see the same parts of what they meet.
    kByWinding,
    kAsGiven,  ///< Neighbours of equal N, lane by lane in the order given.
  };

  Batch() = default;
  /// Strands are grouped by kind and N, then by `grouping`.
  explicit Batch(std::span<const RootedStrand> strands, Grouping grouping = Grouping::kByWinding);

  [[nodiscard]] std::span<const Block> blocks() const { return blocks_; }
  [[nodiscard]] size_t state_rows() const { return state_rows_; }
  [[nodiscard]] int strand_count() const { return static_cast<int>(places_.size()); }

  /// Writes angles [rad] (N), rates [rad/s] (N) and velocities at the Gauss points, world [m/s]
  /// (N x kGaussPoints), into all lanes of a plain strand; of a wound one, its unknowns and beads.
  void SetStrand(int strand, const StrandState& value, std::span<Row<T>> state) const;
  void SetStrand(int strand, const WoundState& value, std::span<Row<T>> state) const;
  /// Puts a strand to the shape of these coordinates (see GetCoordinates), standing still.
  void SetStill(int strand, std::span<const double> coordinates, std::span<Row<T>> state) const;
  /// Reads them back.
  void GetStrand(int strand, std::span<const Row<T>> state, StrandState value) const;
  void GetStrand(int strand, std::span<const Row<T>> state, WoundState value) const;
  /// Only the coordinates [rad]: (N x 3) angles of a plain strand, (N x 4) unknowns of a wound one.
  void GetCoordinates(int strand, std::span<const Row<T>> state, std::span<double> values) const;

  /// Turns all velocities by `turn`.
  void RotateVelocities(const Eigen::Matrix3d& turn, std::span<Row<T>> state) const;

  /// The constants of a block.
  [[nodiscard]] const T* constants(const Block& block) const {
    return constants_[block.constants].lane;
  }

 private:
  struct Place {
    int block;
    int lane;
  };
  // Calls visit(block, lane) for every lane that holds a strand.
  template <typename Visit>
  void ForLanes(const Place& place, const Visit& visit) const;
  void SetConstants(const Block& block, int lane, const RootedStrand& strand);
  void SetPlainElements(const RootedStrand& strand, int lane, Row<T>* elements) const;
  void SetWoundElements(const RootedStrand& strand, int lane, Row<T>* elements) const;
  template <typename State>
  void Set(int strand, const State& value, std::span<Row<T>> state) const;
  template <typename State>
  void Get(int strand, std::span<const Row<T>> state, const State& value) const;
  [[nodiscard]] T Constant(const Block& block, int row, int lane) const {
    return constants_[block.constants + row].lane[lane];
  }

  std::vector<Block> blocks_;
  std::vector<Place> places_;  // By strand: where it lies first.
  std::vector<Row<T>> constants_;
  size_t state_rows_ = 0;
};

/// Head and air over one step, for lanes [first, last).
template <typename T>
void SetDrive(const ClampMotion& head, const Surroundings& air, int first, int last,
              std::span<Row<T>, layout::kDriveRows> drive);

/// The head's pose under which positions are wanted, for lanes [first, last).
template <typename T>
void SetPose(const math::Pose& head, int first, int last,
             std::span<Row<T>, layout::kPoseRows> pose);

/// One worker's memory for steps; grows to the longest strand it has seen and is reused.
class BatchScratch {
 public:
  /// `bytes` of memory aligned to 64.
  void* Reserve(size_t bytes);

 private:
  std::vector<Row<float>> rows_;
};

/// Of what the kernels say of a new state's size: bit i is set where lane i is not finite, or is
/// wound beyond 1e6 rad an element.
template <typename T>
[[nodiscard]] uint32_t FailedLanes(const Row<T>& size);

/// Advances one block by one step, as Step does each of its strands; allocates only while `scratch`
/// grows.
///
/// @param state  that of the whole batch, (state_rows).
/// @return bit i is set where lane i is not finite, or is wound beyond 1e6 rad an element; its
///         state must then be set anew.
template <typename T>
[[nodiscard]] uint32_t StepBlock(const KernelTable<T>& kernels, const Batch<T>& batch,
                                 const typename Batch<T>::Block& block,
                                 std::span<const Row<T>, layout::kDriveRows> drive,
                                 std::span<Row<T>> state, BatchScratch& scratch);

}  // namespace mane::rod
