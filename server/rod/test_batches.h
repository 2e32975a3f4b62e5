#pragma once

#include <gtest/gtest.h>

#include <array>
#include <cstdint>
#include <deque>
#include <span>
#include <vector>

#include "rod/batch.h"
#include "rod/test_strands.h"
#include "rod/wound.h"
#include "simd/test_every_isa.h"

/// Packed strands, and a fixture of every instruction set, that the tests of this folder share.
namespace mane::rod::fixtures {

template <typename T>
using EveryIsaTest = simd::fixtures::EveryIsaTest<&KernelsFor<T>>;
using simd::fixtures::Numbers;

inline RootedStrand Rooted(const Strand& strand, const math::Pose& root) { return {&strand, root}; }
inline RootedStrand Rooted(const WoundStrand& wound, const math::Pose& root) {
  return {&wound.strand, root, &wound};
}

/// Strands with their roots and states, packed and stepped together; `Moving` is what moves of one.
template <typename T, typename Strand = rod::Strand, typename Moving = State>
class Packed {
 public:
  void Add(const Strand& strand, const math::Pose& root, const Moving& state) {
    strands_.push_back(strand);
    roots_.push_back(root);
    starts_.push_back(state);
  }

  /// Packs what was added, and puts all strands to their states.
  void Pack() {
    std::vector<RootedStrand> rooted;
    for (int i = 0; i < size(); ++i) rooted.push_back(Rooted(strands_[i], roots_[i]));
    batch_ = Batch<T>(rooted);
    state_.resize(batch_.state_rows());
    for (int i = 0; i < size(); ++i) batch_.SetStrand(i, starts_[i].View(), state_);
  }

  /// One step of all blocks; the failed lanes of all of them, joined.
  uint32_t Step(const KernelTable<T>& kernels, const ClampMotion& head, const Surroundings& air) {
    std::array<Row<T>, layout::kDriveRows> drive;
    SetDrive<T>(head, air, 0, layout::kLanes, drive);
    return StepWith(kernels, drive);
  }
  uint32_t StepWith(const KernelTable<T>& kernels,
                    std::span<const Row<T>, layout::kDriveRows> drive) {
    uint32_t failed = 0;
    for (const auto& block : batch_.blocks()) {
      failed |= StepBlock<T>(kernels, batch_, block, drive, state_, scratch_);
    }
    return failed;
  }

  [[nodiscard]] Moving Get(int i) const {
    Moving state = starts_[i];
    batch_.GetStrand(i, state_, state.View());
    return state;
  }

  /// Positions of all strands at equal arc length under a head pose, (strands x points).
  [[nodiscard]] std::vector<std::vector<Eigen::Vector3d>> Sample(const KernelTable<T>& kernels,
                                                                 const math::Pose& head,
                                                                 int points) const {
    std::array<Row<T>, layout::kPoseRows> pose;
    SetPose<T>(head, 0, layout::kLanes, pose);
    std::vector<Row<T>> rows(3 * points);
    std::vector<std::vector<Eigen::Vector3d>> positions(size());
    for (const auto& block : batch_.blocks()) {
      kernels.Of(block.kind)
          .sample(block.elements, batch_.constants(block), pose[0].lane, state_[block.state].lane,
                  points, rows[0].lane);
      for (int lane = 0; lane < block.count; ++lane) {
        for (int j = 0; j < points; ++j) {
          positions[block.strands[lane]].emplace_back(
              rows[3 * j].lane[lane], rows[3 * j + 1].lane[lane], rows[3 * j + 2].lane[lane]);
        }
      }
    }
    return positions;
  }

  [[nodiscard]] int size() const { return static_cast<int>(strands_.size()); }
  [[nodiscard]] const Strand& strand(int i) const { return strands_[i]; }
  [[nodiscard]] const math::Pose& root(int i) const { return roots_[i]; }
  [[nodiscard]] const Moving& start(int i) const { return starts_[i]; }
  [[nodiscard]] const Batch<T>& batch() const { return batch_; }
  [[nodiscard]] std::span<Row<T>> state() { return state_; }

 private:
  std::deque<Strand> strands_;
  std::vector<math::Pose> roots_;
  std::vector<Moving> starts_;
  Batch<T> batch_;
  std::vector<Row<T>> state_;
  BatchScratch scratch_;
};

}  // namespace mane::rod::fixtures
