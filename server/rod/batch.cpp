#include "rod/batch.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <tuple>

#include "base/check.h"
#include "math/space_order.h"
#include "rod/rotary_inertia.h"
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

// What stiffness and friction are multiplied by: 1 / (rho S l0^4) (batch_layout.h).
double StiffnessUnit(const Strand& strand) {
  const double l0 = strand.TotalLength() / strand.elements();
  return 1 / (strand.linear_density * l0 * l0 * l0 * l0);
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

// Rows of a state's element, by kind.
struct StateLayout {
  int coordinates;  // How many, from row 0; then as many rates.
  int velocities;   // Their first row,
  int points;       // and how many points they are at.
  int rows;
};

StateLayout StateOf(layout::Kind kind) {
  if (kind == layout::Kind::kWound) {
    return {4, layout::kBeadVelocities, kBeads, layout::kStatePerWoundElement};
  }
  return {3, layout::kVelocities, kGaussPoints, layout::kStatePerElement};
}

// The same names for both kinds of state.
std::span<Vector3d> Coordinates(const StrandState& state) { return state.theta; }
std::span<Vector4d> Coordinates(const WoundState& state) { return state.x; }
layout::Kind KindOf(const StrandState& /*state*/) { return layout::Kind::kPlain; }
layout::Kind KindOf(const WoundState& /*state*/) { return layout::Kind::kWound; }

}  // namespace

template <typename T>
Batch<T>::Batch(std::span<const RootedStrand> strands, Grouping grouping)
    : places_(strands.size()) {
  std::vector<int> order(strands.size());
  std::iota(order.begin(), order.end(), 0);
  const auto group = [&](int i) {
    return std::pair(strands[i].wound != nullptr, strands[i].strand->elements());
  };
  if (grouping == Grouping::kByWinding) {
    std::vector<Vector3d> roots;
    roots.reserve(strands.size());
    for (const RootedStrand& strand : strands) roots.push_back(strand.root.p);
    const std::vector<uint64_t> places = math::SpaceOrder(roots);
    std::ranges::stable_sort(order, {}, [&](int i) {
      return std::tuple(group(i), WindingClass(*strands[i].strand), places[i]);
    });
  }

  size_t constant_rows = 0;
  for (size_t i = 0; i < order.size();) {
    const auto [wound, N] = group(order[i]);
    MANE_CHECK(N >= 1);
    Block block{.kind = wound ? layout::Kind::kWound : layout::Kind::kPlain,
                .elements = N,
                .count = 0,
                .strands = {},
                .constants = constant_rows,
                .state = state_rows_};
    while (i < order.size() && block.count < kLanes && group(order[i]) == std::pair(wound, N)) {
      places_[order[i]] = {static_cast<int>(blocks_.size()), block.count};
      block.strands[block.count++] = order[i++];
    }
    std::fill(block.strands.begin() + block.count, block.strands.end(),
              block.strands[block.count - 1]);
    constant_rows += layout::ConstantRows(block.kind, N);
    state_rows_ += static_cast<size_t>(N) * StateOf(block.kind).rows;
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
  const double l0 = strand.TotalLength() / strand.elements();
  Row<T>* const rows = &constants_[block.constants];
  const auto set = [lane](double value, Row<T>* row) { SetRow(value, lane, lane + 1, row); };
  Matrix3d root = rooted.root.q.toRotationMatrix();
  if (rooted.wound != nullptr) root *= rooted.wound->coil[0].F;
  SetRows(root, lane, lane + 1, rows + layout::kRootFrame);
  SetRows(rooted.root.p, lane, lane + 1, rows + layout::kRootPosition);
  set(l0, rows + layout::kUnit);
  set(1 / l0, rows + layout::kInverseUnit);
  set(strand.linear_density * l0, rows + layout::kUnitMass);
  set(strand.air_drag / strand.linear_density, rows + layout::kDrag);
  set(strand.internal_friction * StiffnessUnit(strand), rows + layout::kFriction);
  if (rooted.wound != nullptr) {
    SetWoundElements(rooted, lane, rows + layout::kFirstElement);
  } else {
    SetRows(strand.stiffness * StiffnessUnit(strand), lane, lane + 1, rows + layout::kStiffness);
    set(RotaryInertia(strand), rows + layout::kRotaryInertia);
    SetPlainElements(rooted, lane, rows + layout::kFirstElement);
  }
}

template <typename T>
void Batch<T>::SetPlainElements(const RootedStrand& rooted, int lane, Row<T>* element) const {
  const Strand& strand = *rooted.strand;
  const double l0 = strand.TotalLength() / strand.elements();
  for (int Q = 0; Q < strand.elements(); ++Q, element += layout::kConstantsPerElement) {
    SetRow(strand.length[Q] / l0, lane, lane + 1, element + layout::kLength);
    SetRow(l0 / strand.length[Q], lane, lane + 1, element + layout::kInverseLength);
    SetRows(strand.length[Q] * strand.natural[Q], lane, lane + 1, element + layout::kNatural);
  }
}

template <typename T>
void Batch<T>::SetWoundElements(const RootedStrand& rooted, int lane, Row<T>* element) const {
  const Strand& strand = *rooted.strand;
  const double l0 = strand.TotalLength() / strand.elements();
  const auto set = [&](double value, int row) { SetRow(value, lane, lane + 1, element + row); };
  double phase = 0;
  for (int Q = 0; Q < strand.elements(); ++Q, element += layout::kConstantsPerWoundElement) {
    const Coil& coil = rooted.wound->coil[Q];
    const Eigen::Matrix4d K = coil.stiffness * StiffnessUnit(strand);
    set(strand.length[Q] / l0, layout::kLength);
    set(l0 / strand.length[Q], layout::kInverseLength);
    set(coil.winding * strand.length[Q], layout::kWinding);
    set(coil.rise, layout::kRise);
    set(coil.slant, layout::kSlant);
    set(coil.radius / l0, layout::kRadius);
    set(K(0, 0), layout::kTwisting);
    set(K(1, 1), layout::kBending);
    set(K(3, 3), layout::kStretching);
    set(K(0, 3), layout::kCoupling);
    SetRows(rooted.wound->natural[Q], lane, lane + 1, element + layout::kNaturalUnknowns);
    set(std::cos(phase), layout::kPhaseCosine);
    set(std::sin(phase), layout::kPhaseSine);
    phase += coil.winding * strand.length[Q];
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
template <typename State>
void Batch<T>::Set(int strand, const State& value, std::span<Row<T>> state) const {
  ForLanes(places_[strand], [&](const Block& block, int lane) {
    MANE_CHECK(block.kind == KindOf(value));
    const StateLayout at = StateOf(block.kind);
    const double to_unit = 1 / static_cast<double>(Constant(block, layout::kUnit, lane));
    for (int Q = 0; Q < block.elements; ++Q) {
      Row<T>* const rows = &state[block.state + Q * at.rows];
      SetRows(Coordinates(value)[Q], lane, lane + 1, rows);
      SetRows(value.rate[Q], lane, lane + 1, rows + at.coordinates);
      for (int g = 0; g < at.points; ++g) {
        SetRows(to_unit * value.velocity[Q * at.points + g], lane, lane + 1,
                rows + at.velocities + 3 * g);
      }
    }
  });
}

template <typename T>
template <typename State>
void Batch<T>::Get(int strand, std::span<const Row<T>> state, const State& value) const {
  const auto [block_index, lane] = places_[strand];
  const Block& block = blocks_[block_index];
  MANE_CHECK(block.kind == KindOf(value));
  const StateLayout at = StateOf(block.kind);
  const double unit = Constant(block, layout::kUnit, lane);
  for (int Q = 0; Q < block.elements; ++Q) {
    const Row<T>* const rows = &state[block.state + Q * at.rows];
    for (int i = 0; i < at.coordinates; ++i) {
      Coordinates(value)[Q][i] = rows[i].lane[lane];
      value.rate[Q][i] = rows[at.coordinates + i].lane[lane];
    }
    for (int i = 0; i < 3 * at.points; ++i) {
      value.velocity[Q * at.points + i / 3][i % 3] = unit * rows[at.velocities + i].lane[lane];
    }
  }
}

template <typename T>
void Batch<T>::SetStrand(int strand, const StrandState& value, std::span<Row<T>> state) const {
  Set(strand, value, state);
}

template <typename T>
void Batch<T>::SetStrand(int strand, const WoundState& value, std::span<Row<T>> state) const {
  Set(strand, value, state);
}

template <typename T>
void Batch<T>::GetStrand(int strand, std::span<const Row<T>> state, StrandState value) const {
  Get(strand, state, value);
}

template <typename T>
void Batch<T>::GetStrand(int strand, std::span<const Row<T>> state, WoundState value) const {
  Get(strand, state, value);
}

template <typename T>
void Batch<T>::SetStill(int strand, std::span<const double> coordinates,
                        std::span<Row<T>> state) const {
  ForLanes(places_[strand], [&](const Block& block, int lane) {
    const StateLayout at = StateOf(block.kind);
    MANE_CHECK(static_cast<int>(coordinates.size()) == block.elements * at.coordinates);
    for (int Q = 0; Q < block.elements; ++Q) {
      Row<T>* const rows = &state[block.state + Q * at.rows];
      for (int i = 0; i < at.rows; ++i) {
        const bool given = i < at.coordinates;
        SetRow(given ? coordinates[Q * at.coordinates + i] : 0, lane, lane + 1, rows + i);
      }
    }
  });
}

template <typename T>
void Batch<T>::GetCoordinates(int strand, std::span<const Row<T>> state,
                              std::span<double> values) const {
  const auto [block_index, lane] = places_[strand];
  const Block& block = blocks_[block_index];
  const StateLayout at = StateOf(block.kind);
  MANE_CHECK(static_cast<int>(values.size()) == block.elements * at.coordinates);
  auto value = values.begin();
  for (int Q = 0; Q < block.elements; ++Q) {
    const Row<T>* const rows = &state[block.state + Q * at.rows];
    for (int i = 0; i < at.coordinates; ++i) *value++ = rows[i].lane[lane];
  }
}

template <typename T>
void Batch<T>::RotateVelocities(const Matrix3d& turn, std::span<Row<T>> state) const {
  Eigen::Matrix<T, 3, 3> R = turn.cast<T>();
  for (const Block& block : blocks_) {
    const StateLayout at = StateOf(block.kind);
    for (int i = 0; i < block.elements * at.points; ++i) {
      const int Q = i / at.points, g = i % at.points;
      Row<T>* const rows = &state[block.state + Q * at.rows + at.velocities + 3 * g];
      for (int lane = 0; lane < kLanes; ++lane) {
        const Eigen::Matrix<T, 3, 1> u(rows[0].lane[lane], rows[1].lane[lane], rows[2].lane[lane]);
        for (int c = 0; c < 3; ++c) rows[c].lane[lane] = R.row(c).dot(u);
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
uint32_t FailedLanes(const Row<T>& size) {
  uint32_t failed = 0;
  for (int lane = 0; lane < kLanes; ++lane) {
    failed |= static_cast<uint32_t>(!(size.lane[lane] < kLargestAngle * kLargestAngle)) << lane;
  }
  return failed;
}

template <typename T>
uint32_t StepBlock(const KernelTable<T>& kernels, const Batch<T>& batch,
                   const typename Batch<T>::Block& block,
                   std::span<const Row<T>, layout::kDriveRows> drive, std::span<Row<T>> state,
                   BatchScratch& scratch) {
  const int N = block.elements;
  Row<T> size;
  const KindKernels<T>& kind = kernels.Of(block.kind);
  kind.step(N, batch.constants(block), drive[0].lane, state[block.state].lane,
            scratch.Reserve(static_cast<size_t>(N) * kind.scratch_per_element), size.lane);
  return FailedLanes(size);
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
template uint32_t FailedLanes<float>(const Row<float>&);
template uint32_t FailedLanes<double>(const Row<double>&);
template uint32_t StepBlock<float>(const KernelTable<float>&, const Batch<float>&,
                                   const Batch<float>::Block&,
                                   std::span<const Row<float>, layout::kDriveRows>,
                                   std::span<Row<float>>, BatchScratch&);
template uint32_t StepBlock<double>(const KernelTable<double>&, const Batch<double>&,
                                    const Batch<double>::Block&,
                                    std::span<const Row<double>, layout::kDriveRows>,
                                    std::span<Row<double>>, BatchScratch&);

}  // namespace mane::rod
