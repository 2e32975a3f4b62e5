#include "rpc/convert_style.h"

#include <cmath>
#include <cstring>
#include <limits>
#include <memory>
#include <utility>

#include "rpc/convert_style_values.h"
#include "rpc/convert_values.h"
#include "rpc/limits.h"
#include "rpc/names.h"
#include "styling/prototype.h"
#include "styling/validate_style.h"

namespace mane::rpc {
namespace {

constexpr int kMaxRadii = 1000;
constexpr int kMaxParts = 64;  // Of the field, and of regional prototypes.
constexpr int kMaxQueues = 256;
constexpr int kMaxConstraints = 64;  // Of a queue.
constexpr int kMaxPathPoints = 1000;
constexpr int kMaxOperations = 256;
constexpr size_t kMaxName = 64;
constexpr uint32_t kMaxGridNodes = 256;  // Along an axis.

Result<styling::Style::RegionalSynthesis> ToRegional(const v1::RegionalSynthesis& message,
                                                     const std::string& field,
                                                     ImageReader* images) {
  auto region = ToRegion(message.region(), field + ".region", images);
  if (!region) return region.error();
  auto synthesis = ToSynthesis(message.synthesis(), field + ".synthesis");
  if (!synthesis) return synthesis.error();
  return styling::Style::RegionalSynthesis{*std::move(region), *std::move(synthesis)};
}

Result<std::shared_ptr<const styling::FieldTerm::Grid>> ToGrid(
    const v1::StylingField::Grid& message, const std::string& field) {
  auto grid = std::make_shared<styling::FieldTerm::Grid>();
  grid->low = ToVector(message.low());
  grid->cell = message.cell_m();
  const uint32_t nodes[3] = {message.nodes_x(), message.nodes_y(), message.nodes_z()};
  const char* const names[3] = {".nodes_x", ".nodes_y", ".nodes_z"};
  for (int axis = 0; axis < 3; ++axis) {
    const auto ok = CheckRange(field + names[axis], nodes[axis], 2, kMaxGridNodes);
    if (!ok) return ok.error();
    grid->nodes[axis] = static_cast<int>(nodes[axis]);
  }
  if (const auto ok = AppendBytes(message.values(), field + ".values", &grid->values); !ok) {
    return ok.error();
  }
  const size_t needed = size_t{nodes[0]} * nodes[1] * nodes[2];
  if (grid->values.size() != needed) {
    return InvalidArgument(
        field + ".values",
        fmt::format("{}.values has {} vectors; {} x {} x {} nodes need {}", field,
                    grid->values.size(), nodes[0], nodes[1], nodes[2], needed));
  }
  return std::shared_ptr<const styling::FieldTerm::Grid>(std::move(grid));
}

Result<styling::FieldTerm> ToFieldTerm(const v1::StylingField& message, const std::string& field) {
  styling::FieldTerm term;
  if (message.kind() == v1::StylingField::KIND_UNSPECIFIED ||
      !v1::StylingField::Kind_IsValid(message.kind())) {
    return InvalidArgument(field + ".kind",
                           fmt::format("{}.kind is {}; it must be one of StylingField.Kind", field,
                                       static_cast<int>(message.kind())));
  }
  term.kind = static_cast<styling::FieldTerm::Kind>(message.kind() - 1);
  term.strength = message.strength();
  if (message.has_direction()) term.direction = ToVector(message.direction());
  term.center = ToVector(message.center());
  term.radius = message.radius_m();
  if (message.kind() == v1::StylingField::KIND_GRID) {
    auto grid = ToGrid(message.grid(), field + ".grid");
    if (!grid) return grid.error();
    term.grid = *std::move(grid);
  } else if (message.has_grid()) {
    return InvalidArgument(field + ".grid",
                           fmt::format("{}.grid is set, but {}.kind is not GRID", field, field));
  }
  return term;
}

Result<std::vector<Eigen::Vector3d>> ToPath(
    const google::protobuf::RepeatedPtrField<v1::Vector3>& message, const std::string& field) {
  return ToList(message, field, kMaxPathPoints,
                [](const v1::Vector3& point, const std::string&) -> Result<Eigen::Vector3d> {
                  return ToVector(point);
                });
}

Result<styling::Constraint> ToConstraint(const v1::Constraint& message, const std::string& field) {
  styling::Constraint constraint;
  if (message.kind() == v1::Constraint::KIND_UNSPECIFIED ||
      !v1::Constraint::Kind_IsValid(message.kind())) {
    return InvalidArgument(field + ".kind",
                           fmt::format("{}.kind is {}; it must be one of Constraint.Kind", field,
                                       static_cast<int>(message.kind())));
  }
  constraint.kind = static_cast<styling::Constraint::Kind>(message.kind() - 1);
  auto path = ToPath(message.path(), field + ".path");
  if (!path) return path.error();
  constraint.path = *std::move(path);
  constraint.radius = message.radius_m();
  constraint.weight = message.has_weight() ? message.weight() : 1;
  return constraint;
}

Result<styling::ConstraintQueue> ToQueue(const v1::ConstraintQueue& message,
                                         const std::string& field, ImageReader* images) {
  styling::ConstraintQueue queue;
  if (const auto ok = CheckText(message.name(), kMaxName, field + ".name"); !ok) return ok.error();
  queue.name = message.name();
  auto selection = ToRegion(message.selection(), field + ".selection", images);
  if (!selection) return selection.error();
  queue.selection = *std::move(selection);
  const uint32_t shares = std::max(message.share_count(), 1U);
  if (const auto ok = CheckRange(field + ".share_count", shares, 1, 1000); !ok) return ok.error();
  if (const auto ok = CheckRange(field + ".share", message.share(), 0, shares - 1); !ok) {
    return ok.error();
  }
  queue.share_count = static_cast<int>(shares);
  queue.share = static_cast<int>(message.share());
  auto constraints =
      ToList(message.constraints(), field + ".constraints", kMaxConstraints, ToConstraint);
  if (!constraints) return constraints.error();
  queue.constraints = *std::move(constraints);
  return queue;
}

Result<styling::Colouring> ToColouring(const v1::HairColour& message, const std::string& field) {
  using Form = styling::Distribution::Form;
  const styling::Distribution hue{Form::kNormal, 0.07, 0.01, 0, 1, {}};
  const styling::Distribution saturation{Form::kNormal, 0.5, 0.06, 0, 1, {}};
  const styling::Distribution value{Form::kNormal, 0.3, 0.05, 0, 1, {}};
  styling::Colouring colouring;
  auto h = ToDistribution(message.hue(), hue, field + ".hue");
  if (!h) return h.error();
  auto s = ToDistribution(message.saturation(), saturation, field + ".saturation");
  if (!s) return s.error();
  auto v = ToDistribution(message.value(), value, field + ".value");
  if (!v) return v.error();
  colouring.hue = *std::move(h);
  colouring.saturation = *std::move(s);
  colouring.value = *std::move(v);
  colouring.wisp_share = message.wisp_share();
  return colouring;
}

// The part of an operation that its kind says.
Result<decltype(styling::Operation::what)> ToWhat(const v1::HairdressingOperation& message,
                                                  const std::string& field) {
  using Operation = styling::Operation;
  using What = decltype(Operation::what);
  switch (message.operation_case()) {
    case v1::HairdressingOperation::kCut: {
      Operation::Trim trim;
      if (message.cut().length_m() != 0) trim.length = message.cut().length_m();
      if (message.cut().has_plane()) trim.plane = *ToHalfSpace(message.cut().plane(), field);
      if (!trim.length && !trim.plane) {
        return InvalidArgument(field + ".cut",
                               fmt::format("{}.cut sets neither length_m nor plane", field));
      }
      return What(trim);
    }
    case v1::HairdressingOperation::kWave: {
      auto synthesis = ToSynthesis(message.wave().synthesis(), field + ".wave.synthesis");
      if (!synthesis) return synthesis.error();
      return What(Operation::Wave{*std::move(synthesis)});
    }
    case v1::HairdressingOperation::kComb: {
      const auto& comb = message.comb();
      auto path = ToPath(comb.path(), field + ".comb.path");
      if (!path) return path.error();
      return What(Operation::Comb{*std::move(path), comb.radius_m(),
                                  comb.has_weight() ? comb.weight() : 0.8});
    }
    case v1::HairdressingOperation::kTie:
      return What(Operation::Tie{ToVector(message.tie().point()), message.tie().radius_m()});
    case v1::HairdressingOperation::kBraid: {
      const auto& braid = message.braid();
      auto path = ToPath(braid.path(), field + ".braid.path");
      if (!path) return path.error();
      const uint32_t strands = braid.strand_count() == 0 ? 3 : braid.strand_count();
      if (const auto ok = CheckRange(field + ".braid.strand_count", strands, 2, 9); !ok) {
        return ok.error();
      }
      return What(Operation::Braid{*std::move(path), static_cast<int>(strands), braid.radius_m(),
                                   braid.period_m()});
    }
    case v1::HairdressingOperation::OPERATION_NOT_SET:
      break;
  }
  return InvalidArgument(field, fmt::format("{} says no operation", field));
}

// @param style  that it is for.
Result<styling::Operation> ToOperation(const v1::HairdressingOperation& message,
                                       const styling::Style& style, const std::string& field,
                                       ImageReader* images) {
  auto region = ToRegion(message.region(), field + ".region", images);
  if (!region) return region.error();
  auto what = ToWhat(message, field);
  if (!what) return what.error();
  styling::Operation operation{field, *std::move(region), *std::move(what)};
  if (const auto ok = styling::ValidateOperation(operation, style, field); !ok) return ok.error();
  return operation;
}

// Segments that shipped prototypes need [m]; infinite where none is short.
double ShortestNeeded(const v1::Style& message, const styling::Style& style) {
  double shortest = std::numeric_limits<double>::infinity();
  const auto add = [&shortest](const styling::Prototype& prototype) {
    if (!prototype.points.empty() || prototype.kind == styling::StrandKind::kStraight) return;
    const double period =
        prototype.period_m > 0 ? prototype.period_m : styling::SizeOf(prototype.kind).period;
    shortest = std::min(shortest, std::max(period / 5, 1e-3));
  };
  add(style.synthesis.prototype);
  for (const auto& regional : style.regional) add(regional.synthesis.prototype);
  for (const v1::HairdressingOperation& operation : message.operations()) {
    if (!operation.has_wave()) continue;
    const auto wave = ToSynthesis(operation.wave().synthesis(), "");
    if (wave) add(wave->prototype);
  }
  return shortest;
}

// Everything but lists of messages.
Result<void> ToNumbers(const v1::Style& message, const std::string& field, styling::Style* style) {
  style->seed = message.seed();
  if (message.has_wisp_count()) {
    const auto ok = CheckRange(field + ".wisp_count", message.wisp_count(), 1, 20'000);
    if (!ok) return ok;
    style->wisp_count = static_cast<int>(message.wisp_count());
  }
  if (message.has_strand_count()) {
    const auto ok = CheckRange(field + ".strand_count", message.strand_count(), 0, 1'000'000);
    if (!ok) return ok;
    style->strand_count = static_cast<int>(message.strand_count());
  }
  if (message.segment_length_m() != 0) style->segment_length = message.segment_length_m();
  if (const auto ok = CheckCount(field + ".radii_m", message.radii_m_size(), kMaxRadii); !ok) {
    return ok;
  }
  if (message.radii_m_size() > 0) {
    style->radii.assign(message.radii_m().begin(), message.radii_m().end());
  }
  if (message.has_fuzziness()) style->fuzziness = message.fuzziness();
  if (message.has_bending_stiffness()) style->bending_stiffness = message.bending_stiffness();
  if (message.has_density_threshold()) style->density_threshold = message.density_threshold();
  if (message.strand_cross_section_m2() != 0) {
    style->strand_cross_section = message.strand_cross_section_m2();
  }
  if (message.cell_m() != 0) style->cell = message.cell_m();
  return {};
}

}  // namespace

Result<styling::Style> ToStyle(const v1::Style& message, const std::string& field) {
  styling::Style style;
  ImageReader images;
  const auto with_images = [&images](const auto& convert) {
    return [&images, &convert](const auto& part, const std::string& path) {
      return convert(part, path, &images);
    };
  };
  if (const auto ok = ToNumbers(message, field, &style); !ok) return ok.error();

  auto density = ToMap(message.density(), 1, field + ".density", &images);
  if (!density) return density.error();
  style.density = *std::move(density);
  auto length = ToMap(message.length(), 0.25, field + ".length", &images);
  if (!length) return length.error();
  style.length = *std::move(length);
  auto protrusion = ToMap(message.protrusion(), 0.5, field + ".protrusion", &images);
  if (!protrusion) return protrusion.error();
  style.protrusion = *std::move(protrusion);

  auto synthesis = ToSynthesis(message.synthesis(), field + ".synthesis");
  if (!synthesis) return synthesis.error();
  style.synthesis = *std::move(synthesis);
  auto regional =
      ToList(message.regional(), field + ".regional", kMaxParts, with_images(ToRegional));
  if (!regional) return regional.error();
  style.regional = *std::move(regional);

  auto member_length = ToDistribution(message.member_length(), {}, field + ".member_length");
  if (!member_length) return member_length.error();
  style.member_length = *std::move(member_length);
  auto terms = ToList(message.field(), field + ".field", kMaxParts, ToFieldTerm);
  if (!terms) return terms.error();
  style.field = *std::move(terms);
  if (style.field.empty()) style.field.emplace_back();
  auto queues = ToList(message.queues(), field + ".queues", kMaxQueues, with_images(ToQueue));
  if (!queues) return queues.error();
  style.queues = *std::move(queues);
  auto colour = ToColouring(message.colour(), field + ".colour");
  if (!colour) return colour.error();
  style.colour = *std::move(colour);

  if (message.segment_length_m() == 0) {
    style.segment_length = std::min(style.segment_length, ShortestNeeded(message, style));
  }
  // Before operations: what they add has been checked as they were.
  if (const auto ok = styling::ValidateStyle(style, field); !ok) return ok.error();
  auto operations = ToList(
      message.operations(), field + ".operations", kMaxOperations,
      [&style, &images](const v1::HairdressingOperation& operation, const std::string& path) {
        return ToOperation(operation, style, path, &images);
      });
  if (!operations) return operations.error();
  for (const styling::Operation& operation : *operations) styling::Dress(operation, &style);
  return style;
}

}  // namespace mane::rpc
