#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <array>
#include <cstdint>
#include <vector>

#include "base/cancelled.h"
#include "base/result.h"
#include "exec/worker_pool.h"
#include "styling/obstacles.h"

namespace mane::styling {

/// Nodes of a grid: first node, their distance, how many along each axis.
struct GridBox {
  Eigen::Vector3f low = Eigen::Vector3f::Zero();  ///< [m]
  float cell = 0.01f;                             ///< [m]
  Eigen::Vector3i nodes{2, 2, 2};

  [[nodiscard]] size_t count() const { return nodes.cast<size_t>().prod(); }
};

/// A grid over `hair`, and two cells more, of at most four million nodes.
///
/// @param cell    asked for [m], > 0. Cells are larger where the box needs more nodes than that,
/// and
///                where `radius` is more than two cells: finer ones would tell nothing of wisps so
///                wide, and a segment would spread over hundreds of them.
/// @param radius  the widest wisp's [m].
[[nodiscard]] GridBox BoxOver(const Eigen::AlignedBox3f& hair, double cell, double radius);

/// What hair takes of space, on a grid ([CK05] 3.2, 3.3). Head and shoulders are 1, empty space 0;
/// hair is the fraction of space that it fills, so that thresholds mean the same whatever the
/// number of wisps.
///
/// A segment of volume V is spread over the nodes x_n as c f_n k(d_n) (D4), where d_n is the node's
/// distance from the segment, f_n what the solid leaves free there, k a kernel of the second moment
/// that a full tube of the wisp's radius has, and c such that the sum over nodes times the cells'
/// volume is V. Solid and hair are interpolated trilinearly. Numbers are those of solver.md.
///
/// Threads: const methods from any; Deposit from one at a time, while nobody reads.
class DensityField {
 public:
  /// A piece of a wisp.
  struct Segment {
    Eigen::Vector3f from, to;  ///< [m]
    float radius = 0;          ///< Of the wisp [m]; counts as a cell at least.
    float volume = 0;          ///< That its strands take: number x cross section x length [m^3].
  };

  /// The corners of a point's cell.
  struct Stencil {
    Eigen::Vector3f first;     ///< Where the first corner lies [m].
    Eigen::Vector3f fraction;  ///< Of the cell, in [0, 1].
    float cell = 1;            ///< [m]
    bool near_solid = false;   ///< Whether the solid may be nearer than a quarter of a cell.
    std::array<float, 8> hair, solid;

    /// Interpolates values of the corners, x fastest.
    [[nodiscard]] float Value(const std::array<float, 8>& corners) const;
    /// The gradient of that [1/m].
    [[nodiscard]] Eigen::Vector3f Slope(const std::array<float, 8>& corners) const;
  };

  /// The solid alone. Looks only at nodes near obstacles, each once.
  ///
  /// @return kCancelled soon after `cancelled` says so. The same bits for any number of workers.
  [[nodiscard]] static Result<DensityField> Make(const GridBox& box, const Obstacles& obstacles,
                                                 exec::WorkerPool* pool,
                                                 const base::Cancelled& cancelled = {});

  [[nodiscard]] const GridBox& box() const { return box_; }

  /// Density at a point [m]; 0 outside the grid.
  [[nodiscard]] float At(const Eigen::Vector3f& x) const;
  /// Its gradient [1/m].
  [[nodiscard]] Eigen::Vector3f SlopeAt(const Eigen::Vector3f& x) const;
  /// Densities of all nodes, x fastest.
  [[nodiscard]] std::vector<float> Values() const;

  /// What is needed to interpolate at `x`; outside the grid, nothing, and near the solid.
  [[nodiscard]] Stencil Look(const Eigen::Vector3f& x) const;

  /// c of a segment (D4); 0 if there is no free node within its reach.
  [[nodiscard]] float Scale(const Segment& segment) const;
  /// Adds a segment of that scale; returns how many nodes were looked at.
  int64_t Deposit(const Segment& segment, float scale);
  /// What the segment adds to the corners of a cell.
  void Increase(const Segment& segment, float scale, const Stencil& at,
                std::array<float, 8>* corners) const;
  /// What it would add at `x`: rho_Delta of (6).
  [[nodiscard]] float Increase(const Segment& segment, const Eigen::Vector3f& x) const;
  /// How far from a segment of a wisp of this radius its density is felt [m].
  [[nodiscard]] float Reach(float radius) const;

 private:
  struct Node {
    float hair = 0;
    float depth = kFar;  // 1/2 - d / cell, d the distance to the solid: 0 or less is free.
  };
  static constexpr float kFar = -10;

  explicit DensityField(const GridBox& box) : box_(box), nodes_(box.count()) {}
  void AddSolid(const Obstacle& obstacle, exec::WorkerPool* pool, const base::Cancelled& cancelled);
  void AddSolidRow(const Obstacle& obstacle, int y, int z, int begin, int end);
  template <typename Visit>
  int64_t ForNodes(const Segment& segment, const Visit& visit) const;
  [[nodiscard]] size_t Index(int x, int y, int z) const {
    return (static_cast<size_t>(z) * box_.nodes.y() + y) * box_.nodes.x() + x;
  }

  GridBox box_;
  std::vector<Node> nodes_;  // x fastest.
};

}  // namespace mane::styling
