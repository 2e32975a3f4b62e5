// Times hairstyles on a head that is a mesh, with all cores; its distance field is there. Prints
// one JSON object; every number is a median, and exponents are of one run.

#include <fmt/format.h>

#include <cmath>
#include <fstream>
#include <string>
#include <thread>

#include "contact/field_cache.h"
#include "exec/worker_pool.h"
#include "head_mesh.h"
#include "median.h"
#include "styling/stylist.h"

namespace mane {
namespace {

using styling::Style;

// A head that is a mesh, of which the upper part grows hair.
groom::TriangleMesh Head() {
  groom::TriangleMesh head = HeadMesh();
  head.hair_triangles.clear();
  for (size_t i = 0; i < head.triangles.size(); ++i) {
    const auto& [a, b, c] = head.triangles[i];
    const auto middle = (head.vertices[a] + head.vertices[b] + head.vertices[c]) / 3;
    const bool is_face = middle.z() > 0.07F && middle.y() < 0.15F;
    if (middle.y() > 0.08F && !is_face) head.hair_triangles.push_back(static_cast<uint32_t>(i));
  }
  return head;
}

// What hair keeps out of.
styling::Obstacles HeadAndShoulders() {
  const groom::TriangleMesh head = Head();
  static contact::FieldCache fields({}, size_t{1} << 30, 2);
  return {{*fields.Get({head.vertices, head.triangles}), {}},
          {contact::Capsule{{-0.15, -0.15, 0}, {0.15, -0.15, 0}, 0.06}, {}}};
}

// Wavy hair of 28 cm under gravity.
Style Wavy(int wisps, int strands) {
  Style style;
  style.seed = 1;
  style.wisp_count = wisps;
  style.strand_count = strands;
  style.length.value = 0.28;
  style.protrusion.value = 0.4;
  style.synthesis.prototype.kind = styling::StrandKind::kWavy;
  style.synthesis.temperature = 0.1;
  style.member_length = {styling::Distribution::Form::kNormal, 0.95, 0.05, 0.7, 1, {}};
  style.radii = {0.006, 0.01, 0.006};
  style.field.emplace_back();
  return style;
}

// Seconds of one style from nothing, and its control points.
struct Run {
  double seconds;
  size_t points;
};

Run Time(const Style& style, double seconds, exec::WorkerPool& pool) {
  size_t points = 0;
  const double median = Median(seconds, [&](int) {
    styling::Stylist stylist(Head(), HeadAndShoulders());
    points = (*stylist.Apply(style, "style", pool))->members.points.size();
  });
  return {median, points};
}

// Seconds to apply a style again after `change`, which is done and undone in turn.
template <typename Change>
double TimeChange(const Style& style, const Change& change, exec::WorkerPool& pool) {
  Style other = style;
  change(&other);
  styling::Stylist stylist(Head(), HeadAndShoulders());
  (void)*stylist.Apply(style, "style", pool);
  return Median(2, [&](int i) { (void)*stylist.Apply(i % 2 == 0 ? other : style, "style", pool); });
}

// A number of kilobytes in /proc/self/status [bytes].
double StatusBytes(const std::string& name) {
  std::ifstream status("/proc/self/status");
  for (std::string word; status >> word;) {
    double kilobytes = 0;
    if (word == name + ":" && status >> kilobytes) return 1024 * kilobytes;
  }
  return 0;
}

double Exponent(double ratio, double times) { return std::log(ratio) / std::log(times); }

void Print() {
  exec::WorkerPool pool(static_cast<int>(std::thread::hardware_concurrency()));
  // First, while nothing else has been in memory.
  const double before = StatusBytes("VmRSS");
  styling::Stylist stylist(Head(), HeadAndShoulders());
  const size_t points = (*stylist.Apply(Wavy(2000, 100'000), "style", pool))->members.points.size();
  const double bytes = (StatusBytes("VmHWM") - before) / static_cast<double>(points);

  const Run small = Time(Wavy(2000, 20'000), 3, pool);
  const Run large = Time(Wavy(2000, 100'000), 5, pool);
  const Run many_wisps = Time(Wavy(8000, 20'000), 5, pool);
  Style fine = Wavy(2000, 20'000);
  fine.cell /= 2;
  const Run many_cells = Time(fine, 3, pool);
  const Style style = Wavy(2000, 20'000);
  const auto report = [](const char* name, double value) {
    return fmt::format("\"{}\": {:.4f}", name, value);
  };
  fmt::print(
      "{{{}, {}, \"restyle_after_one_change_s\": {{{}, {}, {}, {}}}, {}, \"control_points_100k\": "
      "{}, "
      "\"exponents\": {{{}, {}, {}}}}}\n",
      report("strands_20k_s", small.seconds), report("strands_100k_s", large.seconds),
      report("colour", TimeChange(
                           style, [](Style* s) { s->colour.wisp_share = 0.7; }, pool)),
      report("fuzziness", TimeChange(
                              style, [](Style* s) { s->fuzziness = 0.3; }, pool)),
      report("bending_stiffness", TimeChange(
                                      style, [](Style* s) { s->bending_stiffness = 1; }, pool)),
      report("density", TimeChange(
                            style,
                            [](Style* s) {
                              s->density.by_polar = {{0, 1}, {2, 0.5}};
                            },
                            pool)),
      report("bytes_per_control_point", bytes), large.points,
      report("strands", Exponent(large.seconds / small.seconds, 5)),
      report("wisps", Exponent(many_wisps.seconds / small.seconds, 4)),
      report("cells", Exponent(many_cells.seconds / small.seconds, 8)));
}

}  // namespace
}  // namespace mane

int main() { mane::Print(); }
