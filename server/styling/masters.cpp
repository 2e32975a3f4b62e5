#include "styling/masters.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>
#include <utility>

#include "base/check.h"
#include "styling/map.h"
#include "styling/members.h"
#include "styling/prototype.h"
#include "styling/region.h"
#include "styling/synthesis.h"

namespace mane::styling {
namespace {

// Masters that a worker draws in one go.
constexpr int kMastersPerPiece = 32;
// Of a segment: what is left of a master at least.
constexpr double kLeastLeft = 0.1;

// The style's own synthesis, then those of its regions.
Result<std::vector<PrototypeModel>> MakeModels(const Style& style, const std::string& field) {
  std::vector<PrototypeModel> models;
  const auto add = [&](const Synthesis& synthesis, const std::string& path) -> Result<void> {
    const auto pattern =
        PrototypeDetails(synthesis.prototype, style.segment_length, path + ".prototype");
    if (!pattern) return pattern.error();
    auto model = PrototypeModel::Make(*pattern, synthesis, path);
    if (!model) return model.error();
    models.push_back(*std::move(model));
    return {};
  };
  if (const auto ok = add(style.synthesis, field + ".synthesis"); !ok) return ok.error();
  for (size_t i = 0; i < style.regional.size(); ++i) {
    const auto path = fmt::format("{}.regional[{}].synthesis", field, i);
    if (const auto ok = add(style.regional[i].synthesis, path); !ok) return ok.error();
  }
  return models;
}

// Index of the model of a wisp.
size_t ModelOf(const Style& style, const ScalpChart& chart, const Eigen::Vector3d& root,
               uint32_t wisp) {
  for (size_t i = style.regional.size(); i > 0; --i) {
    if (Contains(style.regional[i - 1].region, chart, root, wisp)) return i;
  }
  return 0;
}

// How far along the outline a master stays in a half-space [m]; infinite where it never leaves.
double LengthWithin(const Region::HalfSpace& plane, const Masters& masters, int wisp) {
  const Eigen::Vector3d n = plane.normal.normalized();
  const double offset = plane.offset / plane.normal.norm();
  const uint32_t begin = masters.first_joint[wisp], end = masters.first_joint[wisp + 1];
  double before = 0;
  for (uint32_t i = begin; i < end; ++i) {
    const double height = n.dot(masters.outline[i].cast<double>()) - offset;
    if (height < 0) {
      if (i == begin) return 0;
      return (i - 1 - begin + before / (before - height)) * masters.segment_length;
    }
    before = height;
  }
  return std::numeric_limits<double>::infinity();
}

}  // namespace

std::vector<double> LengthsOf(const ScalpMap& map, const Roots& roots, const ScalpChart& chart) {
  std::vector<double> lengths;
  for (const groom::ScalpPoint& root : roots.masters) {
    lengths.push_back(ValueAt(map, chart.At(root.position)));
  }
  return lengths;
}

void CutByLength(const std::vector<Cut>& cuts, const Roots& roots, const ScalpChart& chart,
                 std::vector<double>* lengths) {
  for (const Cut& cut : cuts) {
    if (!cut.length) continue;
    for (int wisp = 0; wisp < roots.wisps(); ++wisp) {
      const Eigen::Vector3d& root = roots.masters[wisp].position;
      if (*cut.length >= (*lengths)[wisp]) continue;
      if (!Contains(cut.region, chart, root, static_cast<uint32_t>(wisp))) continue;
      (*lengths)[wisp] = *cut.length;
    }
  }
}

void LeaveOutBald(Roots* roots, std::vector<double>* lengths) {
  Roots kept;
  std::vector<double> kept_lengths;
  kept.first_member.push_back(0);
  for (int wisp = 0; wisp < roots->wisps(); ++wisp) {
    if (!((*lengths)[wisp] > 0)) continue;
    kept.masters.push_back(roots->masters[wisp]);
    kept_lengths.push_back((*lengths)[wisp]);
    kept.members.insert(kept.members.end(), roots->members.begin() + roots->first_member[wisp],
                        roots->members.begin() + roots->first_member[wisp + 1]);
    kept.first_member.push_back(static_cast<uint32_t>(kept.members.size()));
  }
  *roots = std::move(kept);
  *lengths = std::move(kept_lengths);
}

Result<Masters> MakeMasters(const Style& style, const Roots& roots, const ScalpChart& chart,
                            const std::vector<double>& lengths, long max_joints, uint64_t seed,
                            const std::string& field, exec::WorkerPool& pool) {
  const auto models = MakeModels(style, field);
  if (!models) return models.error();
  const int wisps = roots.wisps();
  Masters masters;
  masters.segment_length = style.segment_length;
  masters.first_joint.push_back(0);
  long joints = 0;
  for (int wisp = 0; wisp < wisps; ++wisp) {
    const double length = std::max(lengths[wisp], kLeastLeft * style.segment_length);
    const double reach = Reach(style.member_length, length, style.radii);
    joints += static_cast<long>(std::ceil(reach / style.segment_length - 1e-9)) + 1;
    if (joints > max_joints) {
      return Error{ErrorCode::kResourceExhausted,
                   fmt::format("{}.segment_length_m is {} m, which gives the masters more than {} "
                               "control points: use longer segments, or fewer wisps",
                               field, style.segment_length, max_joints),
                   field + ".segment_length_m"};
    }
    masters.length.push_back(static_cast<float>(length));
    masters.first_joint.push_back(static_cast<uint32_t>(joints));
  }
  masters.details.resize(joints);
  pool.ParallelFor(wisps, kMastersPerPiece, [&](int begin, int end) {
    for (int wisp = begin; wisp < end; ++wisp) {
      const size_t model =
          ModelOf(style, chart, roots.masters[wisp].position, static_cast<uint32_t>(wisp));
      const uint32_t first = masters.first_joint[wisp];
      Synthesize((*models)[model], seed, static_cast<uint64_t>(wisp),
                 std::span(masters.details).subspan(first, masters.first_joint[wisp + 1] - first));
    }
  });
  return masters;
}

void CutByPlanes(const std::vector<Cut>& cuts, const Roots& roots, const ScalpChart& chart,
                 Masters* masters) {
  for (const Cut& cut : cuts) {
    if (!cut.plane) continue;
    for (int wisp = 0; wisp < masters->wisps(); ++wisp) {
      const auto number = static_cast<uint32_t>(wisp);
      if (!Contains(cut.region, chart, roots.masters[wisp].position, number)) continue;
      const double within = LengthWithin(*cut.plane, *masters, wisp);
      const double left = std::max(within, kLeastLeft * masters->segment_length);
      masters->length[wisp] = std::min(masters->length[wisp], static_cast<float>(left));
    }
  }
}

}  // namespace mane::styling
