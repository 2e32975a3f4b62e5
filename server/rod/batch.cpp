#include "rod/batch.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "base/check.h"
#include "rod/scheme.h"

namespace mane::rod {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using layout::kLanes;

// Beyond it [rad], a strand's angles no longer mean anything in float32.
constexpr double kLargestAngle = 1e6;

// How many times the argument of the Stumpff functions is halved for a strand's most wound element
// in its natural shape: strands alike in that share a block, so that few lanes wait for others.
int WindingClass(const Strand& strand) {
  double most = 1;
  for (int Q = 0; Q < strand.elements(); ++Q) {
    most = std::max(most, strand.length[Q] * strand.natural[Q].norm());
  }
  return std::ilogb(most);
}

template <typename T>
void SetRow(double value, int first, int last, Row<T>* row) {
  std::fill(row->lane + first, row->lane + last, static_cast<T>(value));
}

template <typename T, typename Derived>
void SetRows(const Eigen::MatrixBase<Derived>& values, int first, int last, Row<T>* rows) {
  for (int c = 0; c < values.cols(); ++c) {
    for (int r = 0; r < values.rows(); ++r) SetRow(values(r, c), first, last, rows++);
  }
}

}  // namespace

template <typename T>
Batch<T>::Batch(std::span<const RootedStrand> strands, Grouping grouping)
    : places_(strands.size()) {
  std::vector<int> order(strands.size());
  std::iota(order.begin(), order.end(), 0);
  const auto key = [&](int i) {
    return std::pair(strands[i].strand->elements(), WindingClass(*strands[i].strand));
  };
  if (grouping == Grouping::kByWinding) std::ranges::stable_sort(order, {}, key);

  size_t constant_rows = 0;
  for (size_t i = 0; i < order.size();) {
    const int N = strands[order[i]].strand->elements();
    MANE_CHECK(N >= 1);
    Block block{
        .elements = N, .count = 0, .strands = {}, .constants = constant_rows, .state = state_rows_};
    while (i < order.size() && block.count < kLanes && strands[order[i]].strand->elements() == N) {
      places_[order[i]] = {static_cast<int>(blocks_.size()), block.count};
      block.strands[block.count++] = order[i++];
    }
    std::fill(block.strands.begin() + block.count, block.strands.end(),
              block.strands[block.count - 1]);
    constant_rows += layout::ConstantsSize(N) / kLanes;
    state_rows_ += layout::StateSize(N) / kLanes;
    blocks_.push_back(block);
  }
  constants_.resize(constant_rows);
  for (const Block& block : blocks_) {
    for (int lane = 0; lane < kLanes; ++lane) {
      SetConstants(block, lane, strands[block.strands[lane]]);
    }
  }
}

template <typename T>
void Batch<T>::SetConstants(const Block& block, int lane, const RootedStrand& rooted) {
  const Strand& strand = *rooted.strand;
  const int N = strand.elements();
  const double l0 = strand.TotalLength() / N;
  const double scale = 1 / (strand.linear_density * l0 * l0 * l0 * l0);
  Row<T>* const rows = &constants_[block.constants];
  const auto set = [lane](double value, Row<T>* row) { SetRow(value, lane, lane + 1, row); };
  SetRows(rooted.root.q.toRotationMatrix(), lane, lane + 1, rows + layout::kRootFrame);
  SetRows(rooted.root.p, lane, lane + 1, rows + layout::kRootPosition);
  set(l0, rows + layout::kUnit);
  set(1 / l0, rows + layout::kInverseUnit);
  set(strand.air_drag / strand.linear_density, rows + layout::kDrag);
  set(strand.internal_friction * scale, rows + layout::kFriction);
  SetRows(strand.stiffness * scale, lane, lane + 1, rows + layout::kStiffness);
  for (int Q = 0; Q < N; ++Q) {
    Row<T>* const element = rows + layout::kFirstElement + Q * layout::kConstantsPerElement;
    set(strand.length[Q] / l0, element + layout::kLength);
    set(l0 / strand.length[Q], element + layout::kInverseLength);
    SetRows(strand.length[Q] * strand.natural[Q], lane, lane + 1, element + layout::kNatural);
  }
}

template <typename T>
template <typename Visit>
void Batch<T>::ForLanes(const Place& place, const Visit& visit) const {
  const Block& block = blocks_[place.block];
  visit(block, place.lane);
  if (place.lane != block.count - 1) return;
  for (int lane = block.count; lane < kLanes; ++lane) visit(block, lane);
}

template <typename T>
void Batch<T>::SetStrand(int strand, const StrandState& value, std::span<Row<T>> state) const {
  ForLanes(places_[strand], [&](const Block& block, int lane) {
    const double to_unit = 1 / static_cast<double>(Constant(block, layout::kUnit, lane));
    for (int Q = 0; Q < block.elements; ++Q) {
      Row<T>* const rows = &state[block.state + Q * layout::kStatePerElement];
      SetRows(value.theta[Q], lane, lane + 1, rows + layout::kAngles);
      SetRows(value.rate[Q], lane, lane + 1, rows + layout::kRates);
      for (int g = 0; g < kGaussPoints; ++g) {
        SetRows(to_unit * value.velocity[Q * kGaussPoints + g], lane, lane + 1,
                rows + layout::kVelocities + 3 * g);
      }
    }
  });
}

template <typename T>
void Batch<T>::GetStrand(int strand, std::span<const Row<T>> state, StrandState value) const {
  const auto [block_index, lane] = places_[strand];
  const Block& block = blocks_[block_index];
  const double unit = Constant(block, layout::kUnit, lane);
  for (int Q = 0; Q < block.elements; ++Q) {
    const Row<T>* const rows = &state[block.state + Q * layout::kStatePerElement];
    for (int i = 0; i < 3; ++i) {
      value.theta[Q][i] = rows[layout::kAngles + i].lane[lane];
      value.rate[Q][i] = rows[layout::kRates + i].lane[lane];
      for (int g = 0; g < kGaussPoints; ++g) {
        value.velocity[Q * kGaussPoints + g][i] =
            unit * rows[layout::kVelocities + 3 * g + i].lane[lane];
      }
    }
  }
}

template <typename T>
void Batch<T>::GetAngles(int strand, std::span<const Row<T>> state,
                         std::span<Vector3d> theta) const {
  const auto [block_index, lane] = places_[strand];
  const Block& block = blocks_[block_index];
  for (int Q = 0; Q < block.elements; ++Q) {
    const Row<T>* const rows = &state[block.state + Q * layout::kStatePerElement + layout::kAngles];
    theta[Q] = Vector3d(rows[0].lane[lane], rows[1].lane[lane], rows[2].lane[lane]);
  }
}

template <typename T>
void Batch<T>::RotateVelocities(const Matrix3d& turn, std::span<Row<T>> state) const {
  Eigen::Matrix<T, 3, 3> R = turn.cast<T>();
  for (size_t first = 0; first < state_rows_; first += layout::kStatePerElement) {
    for (int g = 0; g < kGaussPoints; ++g) {
      Row<T>* const rows = &state[first + layout::kVelocities + 3 * g];
      for (int lane = 0; lane < kLanes; ++lane) {
        const Eigen::Matrix<T, 3, 1> u(rows[0].lane[lane], rows[1].lane[lane], rows[2].lane[lane]);
        for (int i = 0; i < 3; ++i) rows[i].lane[lane] = R.row(i).dot(u);
      }
    }
  }
}

template <typename T>
void SetDrive(const ClampMotion& head, const Surroundings& air, int first, int last,
              std::span<Row<T>, layout::kDriveRows> drive) {
  Row<T>* const rows = drive.data();
  const Matrix3d begin = head.begin.q.toRotationMatrix(), end = head.end.q.toRotationMatrix();
  const Matrix3d middle = math::Interpolate(head.begin, head.end, kTheta).q.toRotationMatrix();
  const Vector3d turn = math::RotationVector(head.end.q * head.begin.q.conjugate());
  SetRows(middle, first, last, rows + layout::kMiddleFrame);
  SetRows((end - begin) / head.dt, first, last, rows + layout::kSpread);
  SetRows((head.end.p - head.begin.p) / head.dt, first, last, rows + layout::kHeadVelocity);
  SetRows(turn / head.dt, first, last, rows + layout::kSpin);
  SetRows(air.gravity, first, last, rows + layout::kGravity);
  SetRows(air.wind, first, last, rows + layout::kWind);
  SetRow(head.dt, first, last, rows + layout::kDuration);
  SetRow(air.internal_friction_scale, first, last, rows + layout::kFrictionScale);
  SetRow(air.air_drag_scale, first, last, rows + layout::kDragScale);
}

template <typename T>
void SetPose(const math::Pose& head, int first, int last,
             std::span<Row<T>, layout::kPoseRows> pose) {
  SetRows(head.q.toRotationMatrix(), first, last, pose.data() + layout::kPoseFrame);
  SetRows(head.p, first, last, pose.data() + layout::kPosePosition);
}

void* BatchScratch::Reserve(size_t bytes) {
  const size_t rows = (bytes + sizeof(Row<float>) - 1) / sizeof(Row<float>);
  if (rows_.size() < rows) rows_.resize(rows);
  return rows_.data();
}

template <typename T>
uint32_t StepBlock(const KernelTable<T>& kernels, const Batch<T>& batch,
                   const typename Batch<T>::Block& block,
                   std::span<const Row<T>, layout::kDriveRows> drive, std::span<Row<T>> state,
                   BatchScratch& scratch) {
  const int N = block.elements;
  Row<T> size;
  kernels.step(N, batch.constants(block), drive[0].lane, state[block.state].lane,
               scratch.Reserve(static_cast<size_t>(N) * kernels.scratch_per_element), size.lane);
  uint32_t failed = 0;
  for (int lane = 0; lane < kLanes; ++lane) {
    failed |= static_cast<uint32_t>(!(size.lane[lane] < kLargestAngle * kLargestAngle)) << lane;
  }
  return failed;
}

// What both number types need.
template class Batch<float>;
template class Batch<double>;
template void SetDrive<float>(const ClampMotion&, const Surroundings&, int, int,
                              std::span<Row<float>, layout::kDriveRows>);
template void SetDrive<double>(const ClampMotion&, const Surroundings&, int, int,
                               std::span<Row<double>, layout::kDriveRows>);
template void SetPose<float>(const math::Pose&, int, int, std::span<Row<float>, layout::kPoseRows>);
template void SetPose<double>(const math::Pose&, int, int,
                              std::span<Row<double>, layout::kPoseRows>);
template uint32_t StepBlock<float>(const KernelTable<float>&, const Batch<float>&,
                                   const Batch<float>::Block&,
                                   std::span<const Row<float>, layout::kDriveRows>,
                                   std::span<Row<float>>, BatchScratch&);
template uint32_t StepBlock<double>(const KernelTable<double>&, const Batch<double>&,
                                    const Batch<double>::Block&,
                                    std::span<const Row<double>, layout::kDriveRows>,
                                    std::span<Row<double>>, BatchScratch&);

}  // namespace mane::rod
