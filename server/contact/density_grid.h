#pragma once

#include <Eigen/Core>

#include <cstdint>
#include <span>
#include <vector>

#include "contact/wisp_points.h"
#include "exec/worker_pool.h"

namespace mane::contact {

/// How hair keeps its volume (contact.md, H14 to H17).
struct DensitySettings {
  /// Side of a cell [m], > 0. A cell of hair should hold eight points or more: fewer make the
  /// density a matter of chance, and more blur the shape.
  double cell = 0.025;
  double excess = 1.5;        ///< Denser than at rest by this factor, hair is pressed apart; >= 1.
  double pressure_speed = 1;  ///< At which a pressure wave would travel [m/s], >= 0.
  double damping_rate = 1;    ///< At which velocities approach the mean around them [1/s], >= 0.
};

/// The mass of a head's hair on a uniform grid: by it hair that is denser than at rest is pressed
/// apart, and what moves through other hair is slowed.
///
/// Linear in points and cells, at most 64 cells along an axis: larger ones where the hair is
/// longer. Results are the same bits for any number of workers; nothing is allocated once warm.
/// Points that are not finite take no part. Scratch of one thread at a time: it keeps nothing from
/// step to step.
class DensityGrid {
 public:
  explicit DensityGrid(const DensitySettings& settings = {}) : settings_(settings) {}

  /// Spreads the points' masses over the cells' corners (H14). Lists are looked at until the next
  /// Build.
  ///
  /// @param position  in the head's frame [m].
  /// @param mass  [kg]
  void Build(const PointSpans& position, std::span<const float> mass, exec::WorkerPool& pool);

  /// Sets the largest density [kg/m^3] among the corners of each point's cell: what AddPressure
  /// takes if called for the rest shape.
  void Densities(exec::WorkerPool& pool, std::span<float> densities) const;

  /// Adds what presses hair apart in a step of `dt` [s] (H15, H16); of a point at most what moves
  /// it by a quarter of a cell.
  ///
  /// @param rest_densities  of the points [kg/m^3].
  void AddPressure(std::span<const float> rest_densities, double dt, exec::WorkerPool& pool,
                   const ImpulseSpans& impulses);

  /// Adds what brings the points' velocities nearer to the mean around them (H17): momentum is
  /// kept, kinetic energy falls.
  ///
  /// @param velocity  in the head's axes; faster than 1000 m/s counts as at rest.
  void AddDamping(const VelocitySpans& velocity, double dt, exec::WorkerPool& pool,
                  const ImpulseSpans& impulses);

 private:
  // Where a point is: the first corner of its cell, and how far in it, in [0, 1].
  struct Place {
    int32_t node;  // -1: nowhere.
    int32_t layer;
    Eigen::Vector3f fraction;
  };

  [[nodiscard]] int nodes() const { return n_[0] * n_[1] * n_[2]; }
  void FindPlaces(exec::WorkerPool& pool);
  void SortByLayer();
  // Sums weight * value(point), a vector of `width` numbers, at every corner.
  template <int width, typename Value>
  void Scatter(const Value& value, exec::WorkerPool& pool, std::vector<float>& sums) const;
  // Calls visit(node, weight, gradient of the weight) for a point's corners.
  template <typename Visit>
  void ForCorners(const Place& place, const Visit& visit) const;

  DensitySettings settings_;
  PointSpans position_;
  std::span<const float> mass_;
  float side_ = 1;                                 // Of a cell [m].
  Eigen::Vector3f low_ = Eigen::Vector3f::Zero();  // First corner [m].
  int n_[3] = {0, 0, 0};                           // Corners along each axis.
  std::vector<Place> places_;                      // Of the points.
  std::vector<int32_t> layer_start_, by_layer_;    // Points by layer of cells.
  std::vector<float> node_mass_, node_rest_, node_momentum_;
};

}  // namespace mane::contact
