#include "rpc/style_admission.h"

#include <algorithm>
#include <string_view>

#include "groom/range.h"
#include "rpc/convert_import.h"

namespace mane::rpc {
namespace {

// Where the style does not say how much stiffer guides may become to hold their shape.
constexpr double kStyledStiffnessFactor = 100;
constexpr const char* kWispCount = "header.style.wisp_count";
constexpr const char* kGuideCount = "header.beam_style.guide_count";

Result<void> AdmitSeconds(double seconds, size_t guides, const groom::Limits& limits,
                          const std::string& field) {
  if (seconds <= limits.max_import_cost_s) return {};
  return Error{ErrorCode::kResourceExhausted,
               fmt::format("{} strands would take {:.0f} s to become guides; at most {:.0f} s are "
                           "allowed: use fewer of them, longer segments, or fewer elements a guide",
                           guides, seconds, limits.max_import_cost_s),
               field};
}

}  // namespace

Result<groom::ImportOptions> ToGuideOptions(const v1::ApplyStyleHeader& header) {
  auto options = ToImportOptions(header.guides());
  if (options && !header.guides().has_max_stiffness_factor()) {
    options->max_stiffness_factor = kStyledStiffnessFactor;
  }
  Result<void> valid;
  if (options) valid = groom::ValidateImportOptions(*options);
  const Error* wrong = !options ? &options.error() : !valid ? &valid.error() : nullptr;
  if (wrong == nullptr) return options;
  // They are called header.import_options where grooms are uploaded.
  Error error = *wrong;
  constexpr std::string_view kThere = "header.import_options";
  for (std::string* text : {&error.field, &error.message}) {
    for (size_t at = text->find(kThere); at != std::string::npos; at = text->find(kThere, at)) {
      text->replace(at, kThere.size(), "header.guides");
    }
  }
  return error;
}

Result<void> AdmitStyle(const styling::Style& style, const groom::ImportOptions& guides,
                        const groom::Limits& limits) {
  if (style.wisp_count > limits.max_guides) {
    return groom::TooMany(kWispCount, "guides", style.wisp_count, limits.max_guides);
  }
  if (style.strand_count > limits.max_hairs) {
    return groom::TooMany("header.style.strand_count", "hairs", style.strand_count,
                          limits.max_hairs);
  }
  return AdmitSeconds(style.wisp_count * groom::ImportCost(2, guides),
                      static_cast<size_t>(style.wisp_count), limits, kWispCount);
}

Result<void> AdmitBeamStyle(const BeamDocument& style, const groom::ImportOptions& guides,
                            const groom::Limits& limits) {
  long hairs = 0, points = 0;
  for (const beam::Part& part : style.style.parts) {
    hairs += part.count;
    points += long{part.count} * (part.segments + 2);  // Nodes, and skin below the pore.
  }
  const std::string field = "header.beam_style.parts";
  if (hairs > limits.max_hairs) return groom::TooMany(field, "hairs", hairs, limits.max_hairs);
  if (points > limits.max_hair_points) {
    return groom::TooMany(field, "nodes", points, limits.max_hair_points);
  }
  // At least one a part.
  const auto parts = static_cast<int>(style.style.parts.size());
  const int most_guides = std::max(style.guide_count, parts);
  if (most_guides > limits.max_guides) {
    return groom::TooMany(style.guide_count < parts ? field : kGuideCount, "guides", most_guides,
                          limits.max_guides);
  }
  const auto count = static_cast<size_t>(std::min<long>(most_guides, hairs));
  return AdmitSeconds(static_cast<double>(count) * groom::ImportCost(2, guides), count, limits,
                      kGuideCount);
}

Result<void> AdmitGuides(const std::vector<groom::ImportedStrand>& strands,
                         const groom::ImportOptions& guides, const groom::Limits& limits,
                         const std::string& field) {
  double seconds = 0;
  for (const groom::ImportedStrand& strand : strands) {
    seconds += groom::ImportCost(strand.points.size(), guides);
  }
  return AdmitSeconds(seconds, strands.size(), limits, field);
}

}  // namespace mane::rpc
