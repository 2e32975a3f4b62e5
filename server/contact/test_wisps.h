#pragma once

#include <Eigen/Core>

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "contact/test_step.h"
#include "contact/wisp_pairs.h"
#include "exec/worker_pool.h"

namespace mane::contact::fixtures {

/// Guides as lists of points, which any test may change.
struct Hair {
  std::vector<float> x, y, z, ux, uy, uz, mass, rest_x, rest_y, rest_z;
  std::vector<int32_t> first{0};
  std::vector<float> radius, curliness;

  void AddGuide(float wisp_radius, float curly);
  void AddPoint(const Eigen::Vector3d& position, const Eigen::Vector3d& velocity, double m);
  void RestHere();  ///< Makes the positions the rest shape.
  [[nodiscard]] WispPoints View() const;
  [[nodiscard]] size_t size() const { return mass.size(); }
};

/// A head of `guides` guides of 30 points, 35 cm long, that come out of a ball of 9 cm and hang
/// down, each a little off its neighbours; wisps cover the scalp and overlap. No velocity.
[[nodiscard]] Hair HeadOfHair(int guides, uint64_t seed);

/// Adds velocities of random direction, each coordinate within +-`speed` [m/s].
void Shake(double speed, uint64_t seed, Hair* hair);

/// This thread's processor time [s].
[[nodiscard]] double CpuTime();

/// Impulses that own their lists.
struct Impulses {
  std::vector<float> x, y, z;

  explicit Impulses(size_t n) : x(n), y(n), z(n) {}
  [[nodiscard]] ImpulseSpans View() { return {x, y, z}; }
  [[nodiscard]] Eigen::Vector3d Sum() const;
  [[nodiscard]] double SumOfNorms() const;
  [[nodiscard]] Eigen::Vector3d At(size_t p) const { return {x[p], y[p], z[p]}; }
};

/// A tracker with what it needs.
struct Tracking {
  WispTracker tracker;
  WispScratch scratch;
  exec::WorkerPool pool;
  Impulses impulses{0};

  explicit Tracking(const WispSettings& settings = {}, int workers = 1)
      : tracker(settings), pool(workers) {}

  void Begin(const Hair& hair, double dt = kDt);
  void Revise(const Hair& moving);
  std::span<const int32_t> RevisePassing(const Hair& moving);
};

/// Wisps that meet from the root on.
[[nodiscard]] WispSettings FromTheRoot();

/// Two guides of one segment each, that cross at right angles, `height` [m] apart; the second moves
/// along that at `velocity` [m/s].
[[nodiscard]] Hair Crossing(double height, double velocity);

/// Straight rods in a void, each either rigid, or of points that nothing joins: a model of what
/// solves strands, with which impulses between wisps can be watched over many steps.
class Rods {
 public:
  WispSettings settings;
  int passes = 3, more_passes = 3;  ///< Of all, and of what would nearly pass through another.
  double weight_scale = 1;          ///< Factor on all weights.
  bool extrapolates = false;  ///< As the rods' S4 does: velocities pass what the step solved for.

  /// From `a` to `b`, as `points` points of equal share of `mass`; `weight` [m/s^2] pulls on it.
  void Add(const Eigen::Vector3d& a, const Eigen::Vector3d& b, int points, double mass,
           float radius, float curly, const Eigen::Vector3d& velocity, bool rigid,
           const Eigen::Vector3d& weight = Eigen::Vector3d::Zero());
  void Step(double dt);

  /// Least distance of the middle lines of two rods [m].
  [[nodiscard]] double Distance(size_t a, size_t b) const;
  [[nodiscard]] double KineticEnergy() const;
  [[nodiscard]] Eigen::Vector3d Momentum() const;
  [[nodiscard]] Eigen::Vector3d Centre(size_t rod) const;
  [[nodiscard]] Eigen::Vector3d MeanVelocity(size_t rod) const;
  void Shift(size_t rod, const Eigen::Vector3d& by);
  [[nodiscard]] const WispTracker& tracker() const { return tracker_; }
  [[nodiscard]] double least_distance() const { return least_distance_; }

  /// Least distance of any two rods within all steps so far, at 64 times of each [m].
  void WatchDistance() { watch_ = true; }

 private:
  struct Rod {
    std::vector<Eigen::Vector3d> x, u, momentary;  // The last: S4's, else u.
    double m;                                      // Of a point [kg].
    float radius, curly;
    bool rigid;
    Eigen::Vector3d weight;
  };

  // A rod's velocities with impulses `p` from those without.
  static std::vector<Eigen::Vector3d> Solve(const Rod& rod, const std::vector<Eigen::Vector3d>& x,
                                            const std::vector<Eigen::Vector3d>& free,
                                            const std::vector<Eigen::Vector3d>& p);
  static std::vector<Eigen::Vector3d> Moved(const Rod& rod, double time);

  std::vector<Rod> rods_;
  WispTracker tracker_;
  WispScratch scratch_;
  std::unique_ptr<exec::WorkerPool> pool_ = std::make_unique<exec::WorkerPool>(1);
  bool watch_ = false;
  double least_distance_ = 1e9;
};

}  // namespace mane::contact::fixtures
