// Times the styling of a head: a bob of parts combed and cut.

#include <fmt/format.h>

#include "beam.h"
#include "beam/presets.h"
#include "median.h"

namespace mane {
namespace {

constexpr int kWorkers = 2;

// The bob with so many hairs of so many segments.
beam::BeamStyle Bob(int hairs, int segments) {
  beam::BeamStyle bob = beam::BeamPresets().front().style;
  int before = 0, left = hairs;
  for (const beam::Part& part : bob.parts) before += part.count;
  for (beam::Part& part : bob.parts) {
    part.count = static_cast<int>(int64_t{hairs} * part.count / before);
    part.segments = segments;
    left -= part.count;
  }
  bob.parts.back().count += left;
  return bob;
}

double Milliseconds(int hairs, int segments, exec::WorkerPool& pool) {
  const beam::BeamStyle style = Bob(hairs, segments);
  return 1e3 * Median(2, [&](int) {
           (void)*beam::ApplyBeamStyle(style, beam::PresetHull(), "style", LoopOn(pool));
         });
}

}  // namespace

void TimeStyling(Report* numbers, Report* exponents) {
  exec::WorkerPool pool(kWorkers);
  const double time = Milliseconds(20'000, 20, pool);
  numbers->emplace_back(fmt::format("\"style_20k_ms\": {:.3g}", time));
  const double hairs = Milliseconds(160'000, 20, pool) / time;
  const double segments = Milliseconds(20'000, 160, pool) / time;
  exponents->emplace_back(fmt::format("\"style_hairs\": {:.3g}", Exponent(hairs, 8)));
  exponents->emplace_back(fmt::format("\"style_segments\": {:.3g}", Exponent(segments, 8)));
}

}  // namespace mane
