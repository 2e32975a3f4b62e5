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

/// The points of a head's hair; lists have one length.
struct DensityPoints {
  PointSpans position;          ///< In the head's frame [m].
  VelocitySpans velocity;       ///< In its axes [m/s]; what is not within +-1000 m/s counts as 0.
  std::span<const float> mass;  ///< That a point stands for [kg].
  /// Densities() of the rest shape [kg/m^3]; what is not within 0 and 1e30 counts as 0.
  std::span<const float> rest_density;
};

/// The mass of a head's hair on a uniform grid: by it hair that is denser than at rest is pressed
/// apart, and what moves through other hair is slowed.
///
/// Linear in points and cells, at most 64 cells along an axis: larger ones where the hair is
/// longer. Results are the same bits for any number of workers; nothing is allocated once warm.
/// Points more than 10 km away, or of a mass that is not within 1e-12 and 1e6 kg, take no part, nor
/// does what is no number. Scratch of one thread at a time: it keeps nothing from call to call.
class DensityGrid {
 public:
  explicit DensityGrid(const DensitySettings& settings = {}) : settings_(settings) {}

  /// Sets the largest density [kg/m^3] among the corners of each point's cell (H14).
  ///
  /// @param position  in the head's frame [m].
  /// @param mass  [kg]
  void Densities(const PointSpans& position, std::span<const float> mass, exec::WorkerPool& pool,
                 std::span<float> densities);

  /// Sets the points' impulses in a step of `dt` [s]: what presses hair apart (H15, H16), of a
  /// point at most what moves it by a quarter of a cell; and what brings velocities nearer to the
  /// mean around them (H17), by which momentum is kept and kinetic energy falls.
  void Push(const DensityPoints& points, double dt, exec::WorkerPool& pool,
            const ImpulseSpans& impulses);

 private:
  // Worked on at once by every processor.
  using Four [[gnu::vector_size(16)]] = float;

  struct Point {
    Four place;     // [m]; then how far it is in its cell, in [0, 1]. Last: its mass.
    Four momentum;  // Last: its mass times its rest density.
  };
  // Where points that follow each other lie: their least and largest places.
  struct Group {
    Four low, high;
  };
  struct Corner {
    Four values;  // Sums of Point::momentum; then mean velocity and, last, f' of (H15).
  };

  // Takes points over. motion(p) is velocity and rest density.
  template <typename Motion>
  void Read(const PointSpans& position, std::span<const float> mass, exec::WorkerPool& pool,
            const Motion& motion);
  void FindPlaces(exec::WorkerPool& pool);
  // Sums what points give to the corners; then calls finish(masses, corners) for four at a time.
  template <typename Finish>
  void Scatter(exec::WorkerPool& pool, const Finish& finish);
  void Gather(double dt, exec::WorkerPool& pool, const ImpulseSpans& impulses) const;
  // Calls visit(begin, end) for parts of the points; they begin with a group.
  template <typename Visit>
  void ForPoints(exec::WorkerPool& pool, const Visit& visit) const;

  DensitySettings settings_;
  float side_ = 1;            // Of a cell [m].
  float low_[3] = {0, 0, 0};  // First corner [m].
  int n_[3] = {0, 0, 0};      // Corners along each axis.
  int layer_ = 0;             // From a corner to the next one along z, a multiple of four.
  std::vector<Point> points_;
  std::vector<Group> groups_;
  std::vector<int32_t> cells_;  // First corners of the points' cells.
  std::vector<Corner> corners_;
  std::vector<float> masses_;  // At the corners [kg].
};

}  // namespace mane::contact
