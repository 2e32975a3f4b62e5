// Times a head whose calm hair is stepped with fewer elements against the same head at full detail,
// on one core, and measures how far its tips are off. Prints one JSON object; ratios are of one
// run, frame by frame in turn.

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <string>
#include <vector>

#include "exec/worker_pool.h"
#include "head/head.h"
#include "head/sample_groom.h"
#include "rod/chain.h"

namespace mane::head {
namespace {

using Eigen::Vector3d;

constexpr int kGuides = 512;
constexpr double kDt = 1.0 / 60;

// A moderate shake of the head, by the factor `size`.
math::Pose HeadAt(double t, double size) {
  const double e = size * std::min(1.0, t / 0.2);
  return {e * Vector3d(0.03 * std::sin(8.2 * t), 0.01 * std::sin(12 * t), 0.02 * std::sin(5.7 * t)),
          math::FromRotationVector(
              e * Vector3d(0.1 * std::sin(5 * t), 0.5 * std::sin(7 * t), 0.1 * std::sin(8.8 * t)))};
}

std::vector<Vector3d> Tips(const groom::Groom& groom, const HeadState& state) {
  const std::vector<double> coordinates = Coordinates(groom, state);  // Of plain guides.
  std::vector<Vector3d> theta(coordinates.size() / 3);
  for (size_t Q = 0; Q < theta.size(); ++Q) {
    theta[Q] = Eigen::Map<const Vector3d>(&coordinates[3 * Q]);
  }
  std::vector<Vector3d> tips;
  for (int i = 0; i < groom.guide_count(); ++i) {
    const size_t first = groom.first_element[i], N = groom.first_element[i + 1] - first;
    tips.push_back(rod::ElementFrames(groom.guides[i].strand, state.pose * groom.guides[i].root,
                                      std::span(theta).subspan(first, N))
                       .back()
                       .r);
  }
  return tips;
}

double Median(std::vector<double> values) {
  std::ranges::nth_element(values, values.begin() + std::ssize(values) / 2);
  return values[values.size() / 2];
}

// Seconds of one frame.
double Advanced(const groom::Groom& groom, const Movement& movement, const Environment& environment,
                HeadState* state, exec::WorkerPool& pool) {
  const auto start = std::chrono::steady_clock::now();
  Advance(groom, movement, environment, state, pool);
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

// Ten seconds, of which the last eight are timed: the levels have settled.
std::string Measure(const groom::Groom& groom, double size, double tolerance) {
  exec::WorkerPool pool(1);
  HeadState full = AtRest(groom, {}), coarse = full;
  StartDetail(groom, std::make_shared<const Levels>(groom, pool), &coarse.detail);
  Environment tolerant;
  tolerant.detail_tolerance = tolerance;
  std::vector<double> full_times, coarse_times;
  double worst = 0, stepped = 0;
  constexpr int kFrames = 600, kSettling = 120;
  for (int i = 1; i <= kFrames; ++i) {
    const Movement movement{HeadAt(i * kDt, size), kDt, 1};
    const double a = Advanced(groom, movement, {}, &full, pool),
                 b = Advanced(groom, movement, tolerant, &coarse, pool);
    if (i > kSettling) {
      full_times.push_back(a);
      coarse_times.push_back(b);
      stepped += SteppedElements(groom, coarse) / double(kFrames - kSettling);
    }
    const std::vector<Vector3d> x = Tips(groom, full), y = Tips(groom, coarse);
    for (size_t k = 0; k < x.size(); ++k) worst = std::max(worst, (x[k] - y[k]).norm());
  }
  return fmt::format(
      "{{\"time_ratio\": {:.3g}, \"elements_ratio\": {:.3g}, \"worst_tip_m\": {:.2g}}}",
      Median(coarse_times) / Median(full_times), stepped / groom.element_count(), worst);
}

int Main() {
  const struct {
    const char* name;
    groom::HairType type;
  } hairs[] = {{"smooth", groom::HairType::kAsianSmooth},
               {"wavy", groom::HairType::kCaucasianWavy},
               {"curly", groom::HairType::kCaucasianCurly}};
  std::string all;
  for (const auto& hair : hairs) {
    const auto groom = GeneratedGroom(hair.type, kGuides, 0.1, 10);
    all += fmt::format("{}\"{}\": {{\"still\": {}, \"small_shake_3mm\": {}, \"shake_10mm\": {}}}",
                       all.empty() ? "" : ", ", hair.name, Measure(*groom, 0, 1e-3),
                       Measure(*groom, 0.3, 3e-3), Measure(*groom, 1, 1e-2));
  }
  fmt::print("{{{}}}\n", all);
  return 0;
}

}  // namespace
}  // namespace mane::head

int main() { return mane::head::Main(); }
