#pragma once

#include <Eigen/Core>

#include <array>
#include <span>
#include <vector>

#include "rod/batch.h"
#include "rod/chain.h"

namespace mane::rod::fixtures {

using Eigen::Vector3d;
using layout::kLanes;

inline constexpr int kPoints[] = {3, 1, 4, 2};  ///< Of elements in turn.

inline std::vector<int> FirstPoints(int N) {
  std::vector<int> first = {0};
  for (int Q = 0; Q < N; ++Q) first.push_back(first.back() + kPoints[Q % 4]);
  return first;
}
inline int PointCount(int N) { return FirstPoints(N).back(); }
inline ArcPosition Where(int point) {
  int Q = 0;
  while (point >= kPoints[Q % 4]) point -= kPoints[Q++ % 4];
  return {Q, (point + 1.0) / kPoints[Q % 4]};
}

/// What presses and rubs at a point, in SI units.
struct Load {
  Vector3d normal = Vector3d::UnitX();
  double press = 0, hold = 0;        // [kg]
  Vector3d push = Vector3d::Zero();  // [kg m/s]
  double surface_speed = 0;          // [m/s]
};

/// One block of a batch among loads.
template <typename T>
class Solver {
 public:
  Solver(const KernelTable<T>& kernels, const Batch<T>& batch, const ClampMotion& head,
         const Surroundings& air)
      : batch_(batch),
        block_(batch.blocks()[0]),
        first_point_(FirstPoints(block_.elements)),
        kernels_(kernels.Of(block_.kind)) {
    const int points = first_point_.back();
    SetDrive<T>(head, air, 0, kLanes, drive_);
    points_.resize(points * layout::kPointRows);
    loads_.resize(points * layout::kLoadRows);
    velocities_.resize(points * 3);
    loaded_.assign(points, 0);
    watched_.assign(points, 1);
    bytes_ = scratch_.Reserve(kernels_.approach_scratch(block_.elements, points));
  }
  void Approach(std::span<const Row<T>> state) {
    kernels_.approach(block_.elements, first_point_.data(), batch_.constants(block_),
                      drive_[0].lane, state[block_.state].lane, bytes_, points_[0].lane);
  }
  // `unit` is rho S l0 of the strand [kg].
  void SetLoad(int point, int lane, const Load& load, double unit) {
    Row<T>* const rows = &loads_[point * layout::kLoadRows];
    loaded_[point] = 1;
    for (int i = 0; i < 3; ++i) {
      rows[layout::kNormal + i].lane[lane] = static_cast<T>(load.normal[i]);
      // In two parts.
      rows[layout::kPush + i].lane[lane] = static_cast<T>(0.25 * load.push[i] / unit);
      rows[layout::kImpulse + i].lane[lane] = static_cast<T>(0.75 * load.push[i] / unit);
    }
    rows[layout::kPress].lane[lane] = static_cast<T>(load.press / unit);
    rows[layout::kHold].lane[lane] = static_cast<T>(load.hold / unit);
    rows[layout::kSurfaceSpeed].lane[lane] = static_cast<T>(load.surface_speed);
  }
  void Solve(std::span<const Row<T>> state, std::span<Row<T>> next) {
    Row<T> size;
    kernels_.solve(block_.elements, first_point_.data(), batch_.constants(block_), drive_[0].lane,
                   state[block_.state].lane, loads_[0].lane, loaded_.data(), watched_.data(),
                   bytes_, next[block_.state].lane, velocities_[0].lane, size.lane, turning_.lane);
  }
  // By which joints leave the straight lines of the step [m/s^2].
  double Turning(int lane) const { return turning_.lane[lane]; }
  Vector3d Point(int point, int lane, int row) const {
    return At(points_, point * layout::kPointRows + row, lane);
  }
  Vector3d Velocity(int point, int lane) const { return At(velocities_, 3 * point, lane); }

 private:
  static Vector3d At(const std::vector<Row<T>>& rows, int row, int lane) {
    return {rows[row].lane[lane], rows[row + 1].lane[lane], rows[row + 2].lane[lane]};
  }
  const Batch<T>& batch_;
  const typename Batch<T>::Block& block_;
  const std::vector<int> first_point_;
  const KindKernels<T>& kernels_;
  std::array<Row<T>, layout::kDriveRows> drive_;
  std::vector<Row<T>> points_, loads_, velocities_;
  std::vector<unsigned char> loaded_, watched_;
  Row<T> turning_;
  BatchScratch scratch_;
  void* bytes_;
};

}  // namespace mane::rod::fixtures
