// Times the batched step on one core, against the double-precision reference and as part of a whole
// head step. Prints one JSON object; every number is a median, and ratios are of one run.

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <deque>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "exec/worker_pool.h"
#include "head/diagnostics.h"
#include "head/frame.h"
#include "head/head.h"
#include "head/sample_groom.h"
#include "median.h"
#include "rod/batch.h"
#include "rod/scheme.h"
#include "rod/step.h"
#include "simd/isa.h"

namespace mane {
namespace {

using Eigen::Vector3d;
using rod::layout::kLanes;

constexpr double kDt = 1.0 / 60;

// Head poses of a gentle shake: the state keeps moving, and never settles.
math::Pose HeadAt(int frame) {
  const double t = frame * kDt;
  return {{0.01 * std::sin(9 * t), 0, 0}, math::FromRotationVector({0, 0.1 * std::sin(7 * t), 0})};
}

// Guides of the sample groom, `count` of them with N elements, once more as plain strands.
class Strands {
 public:
  Strands(int count, int N, head::SampleHair hair = head::SampleHair::kPlain)
      : groom_(head::SampleGroom(std::min(count, 1000), N, hair)) {
    std::vector<rod::RootedStrand> rooted;
    for (int i = 0; i < count; ++i) {
      const groom::Guide& guide = groom_->guides[i % groom_->guide_count()];
      rooted.push_back({&guide.strand, guide.root, guide.wound ? &*guide.wound : nullptr});
    }
    batch_ = rod::Batch<float>(rooted);
    state_.resize(batch_.state_rows());
    for (int i = 0; i < count; ++i) {
      batch_.SetStill(i, groom_->rest_of(i % groom_->guide_count()), state_);
    }
  }

  // Seconds of a step of all strands by the kernel alone.
  double Step(simd::Isa isa, double seconds) {
    const auto& kernels = rod::KernelsFor<float>(isa);
    std::array<rod::Row<float>, rod::layout::kDriveRows> drive;
    return Median(seconds, [&](int i) {
      rod::SetDrive<float>({HeadAt(i), HeadAt(i + 1), kDt}, {}, 0, kLanes, drive);
      for (const auto& block : batch_.blocks()) {
        failed_ |= rod::StepBlock<float>(kernels, batch_, block, drive, state_, scratch_);
      }
    });
  }

  [[nodiscard]] double StateBytes() const {
    const auto& block = batch_.blocks()[0];
    const size_t constants = rod::layout::ConstantRows(block.kind, block.elements);
    return static_cast<double>((state_.size() + batch_.blocks().size() * constants) *
                               sizeof(rod::Row<float>)) /
           batch_.strand_count();
  }
  [[nodiscard]] const groom::Groom& groom() const { return *groom_; }
  [[nodiscard]] bool failed() const { return failed_ != 0; }

 private:
  std::shared_ptr<const groom::Groom> groom_;
  rod::Batch<float> batch_;
  std::vector<rod::Row<float>> state_;
  rod::BatchScratch scratch_;
  uint32_t failed_ = 0;
};

// Microseconds a strand-step of rod::Step.
double Reference(int N) {
  constexpr int kCount = 64;
  const auto groom = head::SampleGroom(kCount, N, head::SampleHair::kPlain);
  std::vector<Vector3d> theta(groom->element_count());
  for (size_t Q = 0; Q < theta.size(); ++Q) {
    theta[Q] = Eigen::Map<const Vector3d>(&groom->rest[3 * Q]);
  }
  std::vector<Vector3d> rate(theta.size(), Vector3d::Zero()),
      velocity(theta.size() * rod::kGaussPoints, Vector3d::Zero());
  rod::StepScratch scratch;
  const double seconds = Median(1, [&](int i) {
    for (int g = 0; g < kCount; ++g) {
      const size_t first = groom->first_element[g];
      const groom::Guide& guide = groom->guides[g];
      (void)rod::Step(
          guide.strand, {HeadAt(i) * guide.root, HeadAt(i + 1) * guide.root, kDt}, {},
          {std::span(theta).subspan(first, N), std::span(rate).subspan(first, N),
           std::span(velocity).subspan(first * rod::kGaussPoints, size_t(N) * rod::kGaussPoints)},
          scratch);
    }
  });
  return seconds / kCount * 1e6;
}

// Seconds of a whole head step by one worker: a pose in, positions at 16 points a guide out.
double HeadStep(const groom::Groom& groom) {
  exec::WorkerPool pool(1);
  head::HeadState state = head::AtRest(groom, HeadAt(0));
  const head::View view{head::FrameFormat::kPositionsFloat32, head::Space::kWorld, 16};
  return Median(1, [&](int i) {
    head::Advance(groom, {HeadAt(i + 1), kDt, 1}, {}, &state, pool);
    (void)head::EncodeFrame(groom, state, view, pool);
  });
}

// Seconds of the diagnostics of one frame, by one worker.
double Diagnostics(const groom::Groom& groom) {
  exec::WorkerPool pool(1);
  head::HeadState state = head::AtRest(groom, HeadAt(0));
  head::Advance(groom, {HeadAt(1), kDt, 1}, {}, &state, pool);
  return Median(1, [&](int) { (void)head::Diagnose(groom, state, {}, pool); });
}

// Largest relative distance of times from their straight line over N.
double Nonlinearity(const std::map<int, double>& times) {
  double n = 0, x = 0, y = 0, xx = 0, xy = 0;
  for (const auto& [N, t] : times) n += 1, x += N, y += t, xx += double(N) * N, xy += N * t;
  const double slope = (n * xy - x * y) / (n * xx - x * x), start = (y - slope * x) / n;
  double worst = 0;
  for (const auto& [N, t] : times) worst = std::max(worst, std::abs(t / (start + slope * N) - 1));
  return worst;
}

int Main() {
  const simd::Isa best = simd::Best();
  constexpr int kCount = 1024;
  std::map<std::string, std::map<int, double>> us;  // By instruction set and N.
  bool failed = false;
  for (const simd::Isa isa : simd::Supported()) {
    for (const int N : {5, 10}) {
      Strands strands(kCount, N);
      us[std::string(simd::Name(isa))][N] = strands.Step(isa, 1) / kCount * 1e6;
      failed |= strands.failed();
    }
  }
  std::map<int, double> by_elements, by_strands, by_reference;
  for (const int N : {5, 10, 15, 20, 30, 40}) {
    by_elements[N] = Strands(kCount, N).Step(best, 1) / kCount * 1e6;
  }
  for (const int count : {1000, 10000, 100000}) {
    by_strands[count] = Strands(count, 5).Step(best, 1) / count * 1e6;
  }
  for (const int N : {5, 10}) by_reference[N] = Reference(N);
  std::map<int, double> by_wound;
  for (const int N : {5, 10}) {
    Strands strands(kCount, N, head::SampleHair::kWound);
    by_wound[N] = strands.Step(best, 1) / kCount * 1e6;
    failed |= strands.failed();
  }
  std::map<int, double> head_over_kernel;
  for (const int guides : {100, 1000}) {
    Strands strands(guides, 5);
    const double kernel = strands.Step(best, 1);
    head_over_kernel[guides] = HeadStep(strands.groom()) / kernel;
  }
  std::map<int, double> diagnostics_over_step;
  for (const int N : {5, 10}) {
    Strands strands(1000, N);
    const double step = strands.Step(best, 1);
    diagnostics_over_step[N] = Diagnostics(strands.groom()) / step;
  }

  const auto& fastest = us[std::string(simd::Name(best))];
  const auto object = [](const std::map<int, double>& values) {
    std::string text;
    for (const auto& [key, value] : values) {
      text += fmt::format("{}\"{}\": {:.4g}", text.empty() ? "" : ", ", key, value);
    }
    return "{" + text + "}";
  };
  std::string all;
  for (const auto& [name, values] : us) {
    all += fmt::format("{}\"{}\": {}", all.empty() ? "" : ", ", name, object(values));
  }
  const double avx_ratio = us.contains("avx512") ? us["avx2"][5] / us["avx512"][5] : 0;
  std::map<int, double> speedup;
  for (const auto& [N, t] : by_reference) speedup[N] = t / fastest.at(N);
  fmt::print(
      "{{\"isa\": \"{}\", \"us_per_strand_step\": {}, \"us_per_strand_step_by_isa\": {{{}}}, "
      "\"avx2_over_avx512\": {:.3g}, \"reference_us\": {}, \"scalar_double_over_best\": {}, "
      "\"head_step_over_kernel\": {}, \"diagnostics_over_step\": {}, \"state_bytes_n5\": {:.4g}, "
      "\"us_by_elements\": {}, \"us_wound\": {}, \"wound_over_plain_n10\": {:.3g}, "
      "\"linear_in_n\": {:.3g}, \"us_by_strands\": {}, \"linear_in_strands\": {:.3g}}}\n",
      simd::Name(best), object(fastest), all, avx_ratio, object(by_reference), object(speedup),
      object(head_over_kernel), object(diagnostics_over_step), Strands(kCount, 5).StateBytes(),
      object(by_elements), object(by_wound), by_wound[10] / fastest.at(10),
      Nonlinearity(by_elements), object(by_strands), by_strands[100000] / by_strands[1000]);
  return failed ? 1 : 0;
}

}  // namespace
}  // namespace mane

int main() { return mane::Main(); }
