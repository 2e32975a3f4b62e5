#include "groom/assemble.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <span>
#include <utility>

#include "groom/hairs.h"
#include "groom/range.h"
#include "groom/rest.h"
#include "groom/validate.h"
#include "groom/validate_body.h"

namespace mane::groom {
namespace {

using Eigen::Vector3d;

constexpr size_t kMaxNameBytes = 200;
constexpr int kGuidesPerPiece = 2;  // One guide takes long enough to outweigh handing it over.
constexpr double kTurningPart = 0.95;
const Vector3d kGravity(0, -9.81, 0);

bool AllFinite(std::span<const double> numbers) {
  return std::ranges::all_of(numbers, [](double number) { return std::isfinite(number); });
}

Result<void> Validate(const Parts& parts, const Limits& limits) {
  if (parts.display_name.size() > kMaxNameBytes) {
    return InvalidArgument("header.display_name",
                           fmt::format("header.display_name has {} bytes; at most {} are allowed",
                                       parts.display_name.size(), kMaxNameBytes));
  }
  if (parts.guides.empty()) {
    return InvalidArgument("guides", "guides is empty; a groom needs at least one guide");
  }
  if (std::ssize(parts.guides) > limits.max_guides) {
    return TooMany("guides", "guides", std::ssize(parts.guides), limits.max_guides);
  }
  long elements = 0, coordinates = 0;
  for (const Guide& guide : parts.guides) {
    elements += guide.strand.elements();
    coordinates += guide.coordinate_count();
  }
  if (elements > limits.max_elements) {
    return TooMany("guides", "elements", elements, limits.max_elements);
  }
  if (!parts.rest.empty() && (std::ssize(parts.rest) != coordinates || !AllFinite(parts.rest))) {
    return InvalidArgument("rest", fmt::format("rest holds {} numbers; it must hold {}, all finite",
                                               parts.rest.size(), coordinates));
  }
  if (parts.hairs != nullptr && parts.hairs->count() > 0) {
    const int guides = static_cast<int>(parts.guides.size());
    if (auto hairs = ValidateHairs(*parts.hairs, guides, limits); !hairs) return hairs;
  }
  if (auto scalp = ValidateScalp(parts.scalp, limits); !scalp) return scalp;
  return ValidateBodies(parts.bodies, parts.scalp_friction, parts.scalp, limits);
}

// Which all but one in twenty guides are below.
double TurningOf(const Groom& groom) {
  std::vector<double> turning;
  turning.reserve(groom.guides.size());
  for (int i = 0; i < groom.guide_count(); ++i) {
    turning.push_back(Turning(groom.guides[i], groom.rest_of(i)));
  }
  const auto rank = static_cast<std::ptrdiff_t>(kTurningPart * (turning.size() - 1));
  std::ranges::nth_element(turning, turning.begin() + rank);
  return turning[rank];
}

}  // namespace

Result<std::shared_ptr<const Groom>> Assemble(Parts parts, const Limits& limits,
                                              exec::WorkerPool* pool) {
  if (auto valid = Validate(parts, limits); !valid) return valid.error();
  auto groom = std::make_shared<Groom>();
  groom->display_name = std::move(parts.display_name);
  groom->hair_type = parts.hair_type;
  groom->seed = parts.seed;
  groom->scalp = std::move(parts.scalp);
  groom->guides = std::move(parts.guides);
  groom->bodies = std::move(parts.bodies);
  groom->scalp_friction = parts.scalp_friction;
  if (parts.hairs != nullptr && parts.hairs->count() > 0) groom->hairs = std::move(parts.hairs);
  groom->has_contact =
      !groom->bodies.empty() || groom->scalp_friction ||
      std::ranges::any_of(groom->guides, [](const Guide& guide) { return guide.wisp_radius > 0; });

  groom->first_element = {0};
  groom->first_coordinate = {0};
  for (const Guide& guide : groom->guides) {
    groom->first_element.push_back(groom->element_count() + guide.strand.elements());
    groom->first_coordinate.push_back(groom->coordinate_count() + guide.coordinate_count());
  }
  groom->rest = std::move(parts.rest);
  if (groom->rest.empty()) {
    groom->rest.resize(groom->coordinate_count());
    const auto solve = [&](int begin, int end) {
      for (int i = begin; i < end; ++i) {
        const Guide& guide = groom->guides[i];
        const auto rest =
            std::span(groom->rest).subspan(groom->first_coordinate[i], guide.coordinate_count());
        const std::vector<double> natural = NaturalShape(guide);
        std::ranges::copy(natural, rest.begin());
        (void)SolveRest(guide, kGravity, rest);
        if (!AllFinite(rest)) std::ranges::copy(natural, rest.begin());
      }
    };
    if (pool != nullptr) {
      pool->ParallelFor(groom->guide_count(), kGuidesPerPiece, solve);
    } else {
      solve(0, groom->guide_count());
    }
  }
  groom->turning = TurningOf(*groom);
  std::vector<rod::RootedStrand> strands;
  strands.reserve(groom->guides.size());
  for (const Guide& guide : groom->guides) {
    strands.push_back({&guide.strand, guide.root, guide.wound ? &*guide.wound : nullptr});
  }
  groom->batch = rod::Batch<float>(strands);
  return std::shared_ptr<const Groom>(std::move(groom));
}

}  // namespace mane::groom
