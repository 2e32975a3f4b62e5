// Times hair among bodies and other hair on one core, over the rod kernel alone, and a full head of
// 100,000 strands on all. Prints one JSON object; every number is a median, and ratios are of one
// run.

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <functional>
#include <map>
#include <memory>
#include <numbers>
#include <string>
#include <thread>
#include <vector>

#include "exec/worker_pool.h"
#include "groom/assemble.h"
#include "groom/generate.h"
#include "head/bodies.h"
#include "head/head.h"
#include "head/kernels.h"
#include "head_mesh.h"
#include "median.h"
#include "rod/batch.h"

namespace mane {
namespace {

using Eigen::Vector3d;

constexpr double kDt = 1.0 / 60;
constexpr groom::Limits kLimits{.max_guides = 100'000, .max_elements = 500'000};
constexpr double kWalk = 1.4;     // [m/s]
constexpr double kSetsOut = 0.5;  // For so long [s],
constexpr int kLeadIn = 45;       // and these first steps are not timed.

// A head of somebody who sets out within half a second and walks: bobs, sways and looks about.
math::Pose HeadAt(int frame) {
  const double t = frame * kDt, step = 2 * std::numbers::pi * 2 * t;
  const double part = std::min(1.0, t / kSetsOut);
  const double way = kWalk * (part < 1 ? 0.5 * kSetsOut * part * part : t - 0.5 * kSetsOut);
  return {
      {part * 0.015 * std::sin(step / 2), part * 0.02 * std::sin(step), way},
      math::FromRotationVector({part * 0.03 * std::sin(step), part * 0.3 * std::sin(1.3 * t), 0})};
}

// Wisps of guides cover the scalp where `wisps`.
std::shared_ptr<groom::Groom> Hair(groom::HairType type, int guides, int N, double length,
                                   bool wisps = false) {
  groom::Generation generation;
  generation.hair_type = type;
  generation.guide_count = static_cast<uint32_t>(guides);
  generation.length_m = length;
  generation.element_count = static_cast<uint32_t>(N);
  generation.model = groom::StrandModel::kSuperHelix;
  generation.seed = 1;
  groom::Parts parts;
  parts.scalp = HeadMesh();
  parts.guides = *groom::Generate(parts.scalp, generation, kLimits);
  exec::WorkerPool pool(static_cast<int>(std::thread::hardware_concurrency()));
  auto groom = std::make_shared<groom::Groom>(**groom::Assemble(std::move(parts), kLimits, &pool));
  groom->scalp_friction = groom::Friction{};
  for (groom::Guide& guide : groom->guides)
    guide.wisp_radius = wisps ? 0.09 / std::sqrt(guides) : 0;
  groom::Body shoulders{
      "shoulders", groom::Body::Capsule{{-0.2, 0, 0}, {0.2, 0, 0}, 0.06}, {}, true, {}};
  shoulders.pose.p = {0, -0.16, 0};
  groom::Body neck{"neck", groom::Body::Capsule{{0, -0.12, 0}, {0, 0, 0}, 0.055}, {}, true, {}};
  groom->bodies = {shoulders, neck};
  return groom;
}

// Seconds of a step of all guides by the kernel alone.
double Kernel(const groom::Groom& groom, double seconds) {
  std::vector<rod::Row<float>> state = head::AtRest(groom, HeadAt(0)).guides;
  std::array<rod::Row<float>, rod::layout::kDriveRows> drive;
  rod::BatchScratch scratch;
  return Median(seconds, [&](int i) {
    rod::SetDrive<float>({HeadAt(i), HeadAt(i + 1), kDt}, {}, 0, rod::layout::kLanes, drive);
    for (const auto& block : groom.batch.blocks()) {
      (void)rod::StepBlock<float>(head::Kernels(), groom.batch, block, drive, state, scratch);
    }
  });
}

// Seconds of a step of a head among `bodies`, none where null, by so many workers.
double Step(const groom::Groom& groom, const std::shared_ptr<const head::Bodies>& bodies,
            int workers, double seconds) {
  exec::WorkerPool pool(workers);
  head::HeadState state = head::AtRest(groom, HeadAt(0));
  if (bodies != nullptr) head::StartContact(groom, bodies, &state);
  const double dt = kDt;
  const auto step = [&](int i) {
    const math::Pose pose = HeadAt(i + 1);
    std::vector<math::Pose> moving;
    if (bodies != nullptr) {
      math::Pose body;
      body.p = pose.p;
      moving = head::BodiesAtRest(*bodies, body);
    }
    head::Advance(groom, {pose, dt, 1, moving}, {}, &state, pool);
  };
  for (int i = 0; i < kLeadIn; ++i) step(i);
  return Median(seconds, [&](int i) { step(kLeadIn + i); });
}

std::shared_ptr<const head::Bodies> BodiesOf(const groom::Groom& groom) {
  static contact::FieldCache fields({}, size_t{1} << 30, 2);
  exec::WorkerPool pool(static_cast<int>(std::thread::hardware_concurrency()));
  return *head::MakeBodies(groom, &fields, pool);
}

// What contact adds to a step of 100 guides on one core, over the kernel's own time.
double OverRod(groom::HairType type, int N, bool wisps) {
  const auto groom = Hair(type, 100, N, 0.25, wisps);
  const double kernel = Kernel(*groom, 1), bare = Step(*groom, nullptr, 1, 1);
  return (Step(*groom, BodiesOf(*groom), 1, 2) - bare) / kernel;
}

// The slope of a step's time over the number of guides, both as logarithms.
double Exponent(bool wisps) {
  double x = 0, y = 0, xx = 0, xy = 0, n = 0;
  for (const int guides : {50, 150, 500, 1500, 5000}) {
    const auto groom = Hair(groom::HairType::kAsianSmooth, guides, 10, 0.25, wisps);
    const double time = std::log(Step(*groom, BodiesOf(*groom), 1, 2)), count = std::log(guides);
    n += 1, x += count, y += time, xx += count * count, xy += count * time;
  }
  return (n * xy - x * y) / (n * xx - x * x);
}

int Main() {
  using groom::HairType;
  const double bodies_smooth = OverRod(HairType::kAsianSmooth, 10, false),
               bodies_wavy = OverRod(HairType::kCaucasianWavy, 10, false),
               all = OverRod(HairType::kAsianSmooth, 10, true);
  const double exponent = Exponent(true), bodies_exponent = Exponent(false);
  const auto full = Hair(HairType::kAsianSmooth, 100'000, 5, 0.2);
  const int cores = static_cast<int>(std::thread::hardware_concurrency());
  const auto bodies = BodiesOf(*full);
  const double full_ms = 1e3 * Step(*full, bodies, cores, 4);
  const double bare_ms = 1e3 * Step(*full, nullptr, cores, 2);
  fmt::print(
      "{{\"contact_over_rod\": {:.3g}, \"bodies_over_rod\": {:.3g}, "
      "\"bodies_over_rod_wavy\": {:.3g}, \"guides_50_to_5000_exponent\": {:.3g}, "
      "\"bodies_exponent\": {:.3g}, \"full_head_100k_ms\": {:.3g}, "
      "\"full_head_100k_without_contact_ms\": {:.3g}, \"cores\": {}}}\n",
      all, bodies_smooth, bodies_wavy, exponent, bodies_exponent, full_ms, bare_ms, cores);
  return 0;
}

}  // namespace
}  // namespace mane

int main() { return mane::Main(); }
