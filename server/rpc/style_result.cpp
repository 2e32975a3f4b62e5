#include "rpc/style_result.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "rpc/convert_values.h"
#include "styling/colour.h"
#include "styling/force_field.h"
#include "styling/map.h"
#include "styling/png_image.h"

namespace mane::rpc {
namespace {

constexpr size_t kBytesPerPart = 512 * 1024;
constexpr int kMapSize = 512;    // Pixels.
constexpr int kFieldNodes = 41;  // Along an axis, at most.

template <typename Entry>
void Append(const Entry& entry, std::string* bytes) {
  bytes->append(reinterpret_cast<const char*>(&entry), sizeof(entry));
}

template <typename Entry>
void Append(const std::vector<Entry>& entries, size_t begin, size_t end, std::string* bytes) {
  bytes->append(reinterpret_cast<const char*>(entries.data() + begin),
                (end - begin) * sizeof(Entry));
}

// Sends a part when it is large, and begins the next.
class PartWriter {
 public:
  explicit PartWriter(jobs::JobContext& context) : context_(context) {}

  v1::HairstylePart part;

  Result<void> WriteIfLarge(size_t bytes) {
    return bytes < kBytesPerPart ? Result<void>() : Write();
  }
  Result<void> Write() {
    if (part.part_case() == v1::HairstylePart::PART_NOT_SET) return {};
    const auto ok = context_.AppendResult(part.SerializeAsString());
    part.Clear();
    return ok;
  }

 private:
  jobs::JobContext& context_;
};

Result<void> WriteMasters(const styling::Masters& masters, PartWriter* writer) {
  for (int wisp = 0; wisp < masters.wisps(); ++wisp) {
    v1::HairstylePart::Masters* message = writer->part.mutable_masters();
    const uint32_t begin = masters.first_joint[wisp], end = masters.first_joint[wisp + 1];
    Append(end - begin, message->mutable_joint_counts());
    Append(masters.length[wisp], message->mutable_lengths());
    Append(masters.outline, begin, end, message->mutable_outline());
    Append(masters.points, begin, end, message->mutable_points());
    if (const auto ok = writer->WriteIfLarge(2 * message->points().size()); !ok) return ok;
  }
  return writer->Write();
}

Result<void> WriteStrands(const std::vector<groom::ImportedStrand>& strands, PartWriter* writer) {
  for (const groom::ImportedStrand& strand : strands) {
    v1::HairstylePart::Masters* message = writer->part.mutable_masters();
    float length = 0;
    for (size_t i = 1; i < strand.points.size(); ++i) {
      length += (strand.points[i] - strand.points[i - 1]).norm();
    }
    Append(static_cast<uint32_t>(strand.points.size()), message->mutable_joint_counts());
    Append(length, message->mutable_lengths());
    Append(strand.points, 0, strand.points.size(), message->mutable_outline());
    Append(strand.points, 0, strand.points.size(), message->mutable_points());
    if (const auto ok = writer->WriteIfLarge(2 * message->points().size()); !ok) return ok;
  }
  return writer->Write();
}

Result<void> WriteMembers(const std::vector<uint32_t>& first_member,
                          const styling::Members& members, const std::vector<styling::Hsv>& colours,
                          PartWriter* writer) {
  for (size_t wisp = 0; wisp + 1 < first_member.size(); ++wisp) {
    for (uint32_t i = first_member[wisp]; i < first_member[wisp + 1]; ++i) {
      v1::HairstylePart::Members* message = writer->part.mutable_members();
      const uint32_t begin = members.first_point[i], end = members.first_point[i + 1];
      Append(static_cast<uint32_t>(wisp), message->mutable_wisps());
      Append(end - begin, message->mutable_point_counts());
      Append(members.points, begin, end, message->mutable_points());
      Append(styling::HsvToRgb8(colours[i]), message->mutable_colours());
      if (const auto ok = writer->WriteIfLarge(message->points().size()); !ok) return ok;
    }
  }
  return writer->Write();
}

Result<void> WriteDensity(const styling::DensityField& density, PartWriter* writer) {
  const std::vector<float> values = density.Values();
  const styling::GridBox& box = density.box();
  for (size_t begin = 0; begin < values.size(); begin += kBytesPerPart / sizeof(float)) {
    v1::HairstylePart::DensityField* message = writer->part.mutable_density();
    FromVector(box.low.cast<double>(), message->mutable_low());
    message->set_cell_m(box.cell);
    message->set_nodes_x(static_cast<uint32_t>(box.nodes.x()));
    message->set_nodes_y(static_cast<uint32_t>(box.nodes.y()));
    message->set_nodes_z(static_cast<uint32_t>(box.nodes.z()));
    FromEntries(values, begin, kBytesPerPart / sizeof(float), message->mutable_values());
    if (const auto ok = writer->Write(); !ok) return ok;
  }
  return {};
}

Result<void> WriteField(const styling::Style& style, const styling::GridBox& density,
                        PartWriter* writer) {
  const Eigen::Vector3d size = density.cell * (density.nodes.cast<double>().array() - 1);
  const double cell = std::max<double>(density.cell, size.maxCoeff() / (kFieldNodes - 1));
  const Eigen::Vector3i nodes =
      (size / cell).array().ceil().cast<int>().matrix().cwiseMin(kFieldNodes - 1).array() + 1;
  const Eigen::Vector3d low = density.low.cast<double>();
  const auto values = styling::ForceField(style.field).Sample(low, cell, nodes);
  constexpr size_t kVectors = kBytesPerPart / sizeof(Eigen::Vector3f);
  for (size_t begin = 0; begin < values.size(); begin += kVectors) {
    v1::StylingField::Grid* message = writer->part.mutable_field();
    FromVector(low, message->mutable_low());
    message->set_cell_m(cell);
    message->set_nodes_x(static_cast<uint32_t>(nodes.x()));
    message->set_nodes_y(static_cast<uint32_t>(nodes.y()));
    message->set_nodes_z(static_cast<uint32_t>(nodes.z()));
    FromEntries(values, begin, kVectors, message->mutable_values());
    if (const auto ok = writer->Write(); !ok) return ok;
  }
  return {};
}

Result<void> WriteMaps(const styling::Style& style, PartWriter* writer) {
  const std::pair<const char*, const styling::ScalpMap*> maps[] = {
      {"density", &style.density}, {"length", &style.length}, {"protrusion", &style.protrusion}};
  for (const auto& [name, map] : maps) {
    const styling::Painting painting = styling::Paint(*map, kMapSize);
    v1::HairstylePart::Map* message = writer->part.mutable_map();
    message->set_name(name);
    message->set_white(painting.scale);
    message->set_png(styling::EncodePng(painting.image));
    if (const auto ok = writer->Write(); !ok) return ok;
  }
  return {};
}

}  // namespace

v1::StyleReport MakeReport(const styling::Style& style, const styling::Hairstyle& hairstyle,
                           const styling::StageTimes& times) {
  v1::StyleReport report;
  for (size_t queue = 0; queue < hairstyle.solved.constraints.size(); ++queue) {
    const auto& constraints = hairstyle.solved.constraints[queue];
    for (size_t i = 0; i < constraints.size(); ++i) {
      v1::StyleReport::Outcome* message = report.add_outcomes();
      message->set_queue(static_cast<uint32_t>(queue));
      message->set_queue_name(style.queues[queue].name);
      message->set_constraint(static_cast<uint32_t>(i));
      message->set_selected(static_cast<uint32_t>(constraints[i].selected));
      message->set_met(static_cast<uint32_t>(constraints[i].met));
    }
  }
  report.set_wisp_count(static_cast<uint32_t>(hairstyle.roots.wisps()));
  report.set_strand_count(static_cast<uint32_t>(hairstyle.members.strands()));
  report.set_control_point_count(hairstyle.members.points.size());
  report.set_crowded_segments(static_cast<uint32_t>(hairstyle.solved.dense_segments));
  report.set_seconds_roots(times.roots);
  report.set_seconds_masters(times.masters);
  report.set_seconds_deformation(times.deformation);
  report.set_seconds_members(times.members);
  return report;
}

Result<void> WriteHairstyle(const styling::Style& style, const styling::Hairstyle& hairstyle,
                            jobs::JobContext& context) {
  PartWriter writer(context);
  if (const auto ok = WriteMasters(hairstyle.masters, &writer); !ok) return ok;
  const auto members =
      WriteMembers(hairstyle.roots.first_member, hairstyle.members, hairstyle.colours, &writer);
  if (!members) return members;
  if (const auto ok = WriteDensity(*hairstyle.density, &writer); !ok) return ok;
  if (const auto ok = WriteField(style, hairstyle.density->box(), &writer); !ok) return ok;
  return WriteMaps(style, &writer);
}

Result<void> WriteBeams(const styling::BeamHairstyle& hairstyle, jobs::JobContext& context) {
  PartWriter writer(context);
  if (const auto ok = WriteStrands(hairstyle.guides, &writer); !ok) return ok;
  return WriteMembers(hairstyle.first_member, hairstyle.members, hairstyle.colours, &writer);
}

}  // namespace mane::rpc
