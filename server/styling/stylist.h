#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "base/cancelled.h"
#include "base/result.h"
#include "exec/worker_pool.h"
#include "groom/groom.h"
#include "styling/chart.h"
#include "styling/density_field.h"
#include "styling/hairstyle.h"
#include "styling/obstacles.h"
#include "styling/solver.h"
#include "styling/style.h"

namespace mane::styling {

/// How large a hairstyle may become. What exceeds a limit is refused with RESOURCE_EXHAUSTED.
struct StyleLimits {
  long max_joints = 10'000'000;  ///< Of all masters; 70 bytes each.
  long max_points = 40'000'000;  ///< Of all members, by their masters' joints; 24 bytes each.
};

/// What a style made of a head.
struct Hairstyle {
  Roots roots;
  Masters masters;  ///< Deformed and cut.
  std::shared_ptr<const DensityField> density;
  SolverReport solved;
  Members members;
  std::vector<Hsv> colours;  ///< (strands)
};

/// What the stages took [s]; 0 for those that were kept.
struct StageTimes {
  double roots = 0;
  double masters = 0;
  double deformation = 0;
  double members = 0;
};

/// Applies styles to one head ([CK05], all of it), in stages: roots, details of masters, their
/// deformation, members, colours. Each stage is kept with what it was made of, so that a style that
/// differs in one number makes anew only what depends on it: a colour nothing but colours, a
/// fuzziness the members.
///
/// Threads: one at a time; work is shared out on the pool that Apply is given.
class Stylist {
 public:
  using Progress = std::function<void(double)>;

  /// @param scalp      valid (groom::ValidateScalp) and not empty.
  /// @param obstacles  what hair keeps out of.
  Stylist(groom::Scalp scalp, Obstacles obstacles, const StyleLimits& limits = {});
  ~Stylist();

  /// @param style     valid (ValidateStyle), its operations worked in.
  /// @param field     path of the style, for errors that show only here.
  /// @param progress  told what part is done, rising from 0 to 1; may be empty.
  /// @return what it made, kept until the next Apply: the same bits for the same arguments,
  /// whatever
  ///   was applied before and for any number of workers. kInvalidArgument for what does not fit the
  ///   head (a density of 0 everywhere, selections without wisps or that share one, points inside
  ///   the head); RESOURCE_EXHAUSTED above the limits; kCancelled soon after `cancelled` says so.
  [[nodiscard]] Result<std::shared_ptr<const Hairstyle>> Apply(
      const Style& style, const std::string& field, exec::WorkerPool& pool,
      const base::Cancelled& cancelled = {}, const Progress& progress = {});

  /// Of the last Apply.
  [[nodiscard]] const StageTimes& times() const { return times_; }
  [[nodiscard]] const ScalpChart& chart() const { return chart_; }

 private:
  struct Kept;

  [[nodiscard]] Result<std::shared_ptr<const Hairstyle>> Make(const Style& style,
                                                              const std::string& field,
                                                              exec::WorkerPool& pool,
                                                              const base::Cancelled& cancelled,
                                                              const Progress& progress);
  [[nodiscard]] Result<void> MakeRoots(const Style& style, const std::string& field,
                                       exec::WorkerPool& pool);
  [[nodiscard]] Result<void> MakeMasters(const Style& style, const std::string& field,
                                         exec::WorkerPool& pool);
  [[nodiscard]] Result<void> Deform(const Style& style, const std::string& field,
                                    exec::WorkerPool& pool, const base::Cancelled& cancelled,
                                    const Progress& progress);

  const groom::Scalp scalp_;
  const Obstacles obstacles_;
  const StyleLimits limits_;
  const ScalpChart chart_;
  std::unique_ptr<Kept> kept_;
  StageTimes times_;
};

}  // namespace mane::styling
