#include <fmt/format.h>

#include <cmath>
#include <vector>

#include "beam.h"
#include "beam/motion.h"
#include "beam/response.h"
#include "exec/worker_pool.h"
#include "math/random.h"
#include "median.h"
#include "simd/isa.h"

namespace mane {
namespace {

using beam::MotionHair;
using Eigen::Vector3d;

constexpr double kDt = 1.0 / 60, kLength = 0.25;

// Hairs that leave the upper half of the hull along its normal and turn down.
class Head {
 public:
  Head(int count, int segments) {
    const Eigen::Vector3d radii(0.08, 0.11, 0.095);
    math::RandomStream random(1, 1);
    std::vector<std::vector<Vector3d>> rests;
    std::vector<Vector3d> roots;
    for (int i = 0; i < count; ++i) {
      const double y = random.Uniform(0, 1), f = random.Uniform(-3.14, 3.14);
      const Vector3d on_ball(std::sqrt(1 - y * y) * std::sin(f), y,
                             std::sqrt(1 - y * y) * std::cos(f));
      roots.emplace_back(radii.cwiseProduct(on_ball));
      Vector3d e = on_ball.cwiseQuotient(radii).normalized(), node = roots.back();
      std::vector<Vector3d>& rest = rests.emplace_back();
      for (int s = 0; s < segments; ++s) {
        const Vector3d normal = node.cwiseQuotient(radii.cwiseProduct(radii)).normalized();
        e = (e - 4.0 / segments * Vector3d::UnitY()).normalized();
        const double into = e.dot(normal);
        if (into < 0 && node.cwiseQuotient(radii).norm() < 1.1)
          e = (e - into * normal).normalized();
        rest.push_back(e);
        node += kLength / segments * e;
      }
    }
    const std::vector<double> hold = beam::HoldOf(5e-9, 5e-6, kLength, segments);
    const std::vector<double> response = beam::ResponseOf(kLength, segments);
    std::vector<MotionHair> hairs;
    hairs.reserve(count);
    for (int i = 0; i < count; ++i) {
      hairs.push_back({roots[i], kLength / segments, rests[i], response, hold, 1.0, 0.02});
    }
    beam::MotionSettings settings;
    settings.hull = beam::Hull{Vector3d::Zero(), radii};
    settings.epsilon.assign(segments, 1);
    for (int s = 0; s < segments / 4; ++s) settings.epsilon[s] = 0.1F;
    batch_ = beam::MotionBatch<float>(segments, hairs, kGravity, settings);
    state_.resize(batch_.state_rows());
    nodes_.resize(static_cast<size_t>(batch_.blocks()) * NodeRows());
    for (int i = 0; i < count; ++i) batch_.SetHair(i, rests[i], {}, kDt, state_);
  }

  // One frame: a step of every hair, and its nodes.
  void Frame(int frame, exec::WorkerPool& pool) {
    const double t = frame * kDt;
    beam::MotionDrive drive;
    drive.head = {{0.03 * std::sin(9 * t), 0, 0},
                  math::FromRotationVector({0, 0.5 * std::sin(7 * t), 0})};
    drive.velocity = {0.27 * std::cos(9 * t), 0, 0};
    drive.velocity_before = {0.27 * std::cos(9 * (t - kDt)), 0, 0};
    drive.spin = {0, 3.5 * std::cos(7 * t), 0};
    drive.spin_before = {0, 3.5 * std::cos(7 * (t - kDt)), 0};
    drive.gravity = kGravity;
    drive.duration = kDt;
    const simd::Row<float> calm[3] = {};
    const auto& kernels = beam::KernelsFor<float>(simd::Best());
    pool.ParallelFor(batch_.blocks(), 16, [&](int begin, int end) {
      for (int block = begin; block < end; ++block) {
        batch_.Step(kernels, block, drive, calm, state_);
        batch_.Nodes(kernels, block, drive.head, state_,
                     std::span(nodes_).subspan(block * NodeRows(), NodeRows()));
      }
    });
  }

 private:
  const Vector3d kGravity{0, -9.81, 0};
  [[nodiscard]] size_t NodeRows() const { return 3 * (static_cast<size_t>(batch_.segments()) + 1); }

  beam::MotionBatch<float> batch_;
  std::vector<simd::Row<float>> state_, nodes_;
};

// Milliseconds of a frame.
double FrameTime(int count, int segments, int workers) {
  Head head(count, segments);
  exec::WorkerPool pool(workers);
  return 1e3 * Median(1, [&](int i) { head.Frame(i, pool); });
}

}  // namespace

void TimeMotion(Report* numbers, Report* exponents) {
  const double frame = FrameTime(20'000, 20, 1);
  numbers->emplace_back(fmt::format("\"frame_20k_ms_one_core\": {:.3g}", frame));
  numbers->emplace_back(fmt::format("\"frame_50k_ms\": {:.3g}", FrameTime(50'000, 20, 2)));
  const double hairs = frame / FrameTime(1'250, 20, 1);
  const double segments = FrameTime(2'000, 160, 1) / FrameTime(2'000, 10, 1);
  exponents->emplace_back(fmt::format("\"frame_hairs\": {:.3g}", Exponent(hairs, 16)));
  exponents->emplace_back(fmt::format("\"frame_segments\": {:.3g}", Exponent(segments, 16)));
}

}  // namespace mane
