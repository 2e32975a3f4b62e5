#include "styling/solver.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include "base/check.h"
#include "styling/joint.h"
#include "styling/wisp_segment.h"

namespace mane::styling {
namespace {

using Eigen::Quaterniond;
using Eigen::Vector3d;
using Eigen::Vector3f;

// Wisps that grow at once: they see what was laid before the first of them grew.
constexpr int kBatch = 64;
constexpr int kGrain = 8;

constexpr double kBend = 10 * std::numbers::pi / 180;  // Delta theta [rad].
constexpr int kMostBends = 9;                          // A right angle in all.
constexpr double kClearance = 1e-3;                    // Of obstacles [m].

// A box that holds all hair whatever its shape.
Eigen::AlignedBox3f HairBox(const SolverInput& input, const Masters& masters) {
  Eigen::AlignedBox3f box;
  for (size_t w = 0; w < input.roots.size(); ++w) {
    const Vector3f root = input.roots[w].position.cast<float>();
    const auto segments =
        static_cast<double>(masters.first_joint[w + 1] - masters.first_joint[w] - 1);
    const Vector3f reach =
        Vector3f::Constant(static_cast<float>(segments * masters.segment_length));
    box.extend(Eigen::AlignedBox3f(root - reach, root + reach));
  }
  if (box.isEmpty()) box.extend(Vector3f::Zero());
  return box;
}

// One call of Deform.
class Solver {
 public:
  Solver(const SolverInput& input, Masters* masters, DensityField* density)
      : input_(input),
        masters_(*masters),
        density_(*density),
        phi_(input.field),
        styler_(input.queues, input.selected, masters->wisps(), masters->segment_length),
        l_(masters->segment_length),
        clearance_(std::min({kClearance, density->box().cell / 4.0, l_ / 2})),
        wisps_(static_cast<size_t>(masters->wisps())) {
    Prepare();
  }

  Result<SolverReport> Run(const base::Cancelled& cancelled, const SolverProgress& progress,
                           exec::WorkerPool* pool);

 private:
  struct Wisp {
    uint32_t joint = 0;  // The newest.
    Vector3d q;          // Direction of the newest segment, or q0 of the first.
    int64_t tries = 0;
    int64_t dense = 0;
  };

  void Prepare();
  [[nodiscard]] bool Finished(size_t w) const {
    return wisps_[w].joint + 1 == masters_.first_joint[w + 1];
  }
  void Grow(uint32_t w);
  [[nodiscard]] Vector3d Direction(uint32_t w, const Vector3d& c, Laid* next);
  [[nodiscard]] Vector3d KeptOutsideHead(const Wisp& wisp, const Vector3d& c,
                                         const Vector3d& q) const;
  [[nodiscard]] std::span<const Laid> Own(uint32_t w) const;
  void Place(uint32_t w, uint32_t joint, const Vector3d& q);
  [[nodiscard]] Vector3d DetailsAt(uint32_t joint, const Quaterniond& frame, bool root) const;

  const SolverInput& input_;
  Masters& masters_;
  DensityField& density_;
  const ForceField phi_;
  Styler styler_;
  const double l_, clearance_;
  std::vector<Wisp> wisps_;
  std::vector<Laid> laid_;   // Segments, by the joint that they leave.
  size_t own_segments_ = 0;  // Of a wisp, whose density may be felt at the next one.
  SolverReport report_;
};

void Solver::Prepare() {
  const auto joints = static_cast<size_t>(masters_.joints());
  masters_.outline.resize(joints);
  masters_.frames.resize(joints);
  masters_.points.resize(joints);
  laid_.resize(joints);
  const float widest =
      input_.radii.empty() ? 0 : *std::max_element(input_.radii.begin(), input_.radii.end());
  // The kernel's reach and a cell's diagonal, of an outline that is straight: where it winds back
  // to itself it meets itself as it meets others.
  const double felt = density_.Reach(widest) + 1.74 * density_.box().cell;
  own_segments_ = static_cast<size_t>(std::ceil(felt / l_)) + 1;
  for (uint32_t w = 0; w < wisps_.size(); ++w) {
    wisps_[w].joint = masters_.first_joint[w];
    wisps_[w].q = input_.first_directions[w].normalized();
    MANE_CHECK(!Finished(w));
    masters_.outline[wisps_[w].joint] = input_.roots[w].position.cast<float>();
    styler_.Begin(w, input_.roots[w].position);
  }
}

Result<SolverReport> Solver::Run(const base::Cancelled& cancelled, const SolverProgress& progress,
                                 exec::WorkerPool* pool) {
  const auto joint_of = [&](uint32_t w) -> Vector3d {
    return masters_.outline[wisps_[w].joint].cast<double>();
  };
  const auto total = static_cast<double>(masters_.joints() - masters_.wisps());
  styler_.EndRound(joint_of);  // Roots may have met what they begin with.
  std::vector<uint32_t> growing(wisps_.size());
  for (uint32_t w = 0; w < growing.size(); ++w) growing[w] = w;
  std::vector<uint32_t> now;
  while (!growing.empty()) {
    now.clear();
    std::ranges::copy_if(growing, std::back_inserter(now),
                         [&](uint32_t w) { return !styler_.Waits(w); });
    const int count = static_cast<int>(now.size());
    MANE_CHECK(count > 0);
    for (int begin = 0; begin < count; begin += kBatch) {
      if (base::IsCancelled(cancelled)) return base::CancelledError();
      const int size = std::min(kBatch, count - begin);
      pool->ParallelFor(size, kGrain, [&](int first, int last) {
        for (int i = first; i < last; ++i)
          Grow(now[static_cast<size_t>(begin) + static_cast<size_t>(i)]);
      });
      for (int i = begin; i < begin + size; ++i) {
        const Laid& laid = laid_[wisps_[now[static_cast<size_t>(i)]].joint - 1];
        report_.nodes += density_.Deposit(laid.segment, laid.scale);
      }
    }
    report_.segments += count;
    if (progress) progress(static_cast<double>(report_.segments) / total);
    std::erase_if(growing, [&](uint32_t w) { return Finished(w); });
    styler_.EndRound(joint_of);
  }
  for (const Wisp& wisp : wisps_) {
    report_.tries += wisp.tries;
    report_.dense_segments += wisp.dense;
  }
  report_.constraints = styler_.Report();
  return report_;
}

void Solver::Grow(uint32_t w) {
  Wisp& wisp = wisps_[w];
  const uint32_t joint = wisp.joint;
  const Vector3d c = masters_.outline[joint].cast<double>();
  const Vector3d q = Direction(w, c, &laid_[joint]);
  Place(w, joint, q);
  wisp.q = q;
  ++wisp.joint;
  styler_.Grown(w, c, masters_.outline[joint + 1].cast<double>());
  if (!Finished(w)) return;
  styler_.Ended(w);
  masters_.frames[joint + 1] = masters_.frames[joint];
  masters_.points[joint + 1] =
      masters_.outline[joint + 1] +
      DetailsAt(joint + 1, masters_.frames[joint].cast<double>(), false).cast<float>();
}

std::span<const Laid> Solver::Own(uint32_t w) const {
  const size_t first = masters_.first_joint[w], joint = wisps_[w].joint;
  const size_t begin = joint - std::min(joint - first, own_segments_);
  return std::span(laid_).subspan(begin, joint - begin);
}

Vector3d Solver::KeptOutsideHead(const Wisp& wisp, const Vector3d& c, const Vector3d& q) const {
  if (!density_.Look((c + l_ * q).cast<float>()).near_solid) return q;
  return KeptOutside(input_.obstacles, c, l_, clearance_, wisp.q, q);
}

// Where the next segment goes (steps 1 to 4 of solver.md), and the segment.
Vector3d Solver::Direction(uint32_t w, const Vector3d& c, Laid* next) {
  Wisp& wisp = wisps_[w];
  const Styler::Pull pull = styler_.PullOf(w, c);
  Force force{phi_.At(c), input_.bending_stiffness};
  if (pull.w > 0) force = Constrained(force, pull.w, pull.psi);
  const CrowdingTest test{density_, static_cast<float>(input_.density_threshold),
                          static_cast<float>(pull.pressed ? 1 - pull.w : 1), Own(w)};
  const float volume =
      static_cast<float>(input_.strand_cross_section * l_) * input_.strands[wisp.joint];
  Vector3d q = KeptOutsideHead(wisp, c, BestDirection(force.phi, force.kappa, wisp.q));
  Vector3d best = q;
  float least = std::numeric_limits<float>::max();
  for (int bends = 0;; ++bends) {
    ++wisp.tries;
    Laid tried{{c.cast<float>(), (c + l_ * q).cast<float>(), input_.radii[wisp.joint], volume}, 0};
    tried.scale = density_.Scale(tried.segment);
    const Crowding crowding = test.Of(tried.segment, tried.scale);
    if (crowding.excess < least) {
      least = crowding.excess;
      best = q;
      *next = tried;
    }
    if (least <= 0 || bends == kMostBends) break;
    q = KeptOutsideHead(wisp, c, Turned(q, -crowding.slope.cast<double>(), kBend));
  }
  if (least > 0) ++wisp.dense;
  return best;
}

// Stores the frame and control point of `joint`, from which q goes, and the joint after it.
void Solver::Place(uint32_t w, uint32_t joint, const Vector3d& q) {
  const bool root = joint == masters_.first_joint[w];
  const Quaterniond before =
      root ? RootFrame(wisps_[w].q) : masters_.frames[joint - 1].cast<double>();
  const Quaterniond frame = Transported(before, q);
  const Vector3d c = masters_.outline[joint].cast<double>();
  masters_.frames[joint] = frame.cast<float>();
  masters_.points[joint] = masters_.outline[joint] + DetailsAt(joint, frame, root).cast<float>();
  masters_.outline[joint + 1] = (c + l_ * q).cast<float>();
}

Vector3d Solver::DetailsAt(uint32_t joint, const Quaterniond& frame, bool root) const {
  const Vector3d details = frame * masters_.details[joint].cast<double>();
  const Vector3f& c = masters_.outline[joint];
  if (!density_.Look(c + details.cast<float>()).near_solid || details.isZero()) return details;
  double clearance = clearance_;
  if (root) {
    clearance = std::min(clearance, DistanceTo(input_.obstacles, c.cast<double>()).distance);
  }
  return ShortenedDetails(input_.obstacles, c.cast<double>(), details, clearance);
}

}  // namespace

Result<Deformed> Deform(const SolverInput& input, Masters* masters,
                        const base::Cancelled& cancelled, const SolverProgress& progress,
                        exec::WorkerPool* pool) {
  const auto wisps = static_cast<size_t>(masters->wisps());
  const auto joints = static_cast<size_t>(masters->joints());
  MANE_CHECK(input.roots.size() == wisps && input.first_directions.size() == wisps);
  MANE_CHECK(input.strands.size() == joints && input.radii.size() == joints);
  MANE_CHECK(input.selected.size() == input.queues.size());
  const float widest = joints == 0 ? 0 : *std::max_element(input.radii.begin(), input.radii.end());
  const GridBox box = BoxOver(HairBox(input, *masters), input.cell, widest);
  auto density = DensityField::Make(box, input.obstacles, pool, cancelled);
  if (!density) return density.error();
  auto field = std::make_shared<DensityField>(*std::move(density));
  auto report = Solver(input, masters, field.get()).Run(cancelled, progress, pool);
  if (!report) return report.error();
  return Deformed{*std::move(report), std::move(field)};
}

}  // namespace mane::styling
