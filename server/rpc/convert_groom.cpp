#include "rpc/convert_groom.h"

#include <limits>
#include <vector>

#include "rpc/convert_values.h"
#include "stored.pb.h"

namespace mane::rpc {
namespace {

using google::protobuf::RepeatedField;

std::vector<double> ToList(const RepeatedField<double>& values) {
  return {values.begin(), values.end()};
}

void FromList(const std::vector<double>& values, RepeatedField<double>* message) {
  message->Assign(values.begin(), values.end());
}

// None where it is unset. What this program does not know stays a number that no model has.
std::optional<groom::StrandModel> ToModel(v1::StrandModel model) {
  if (model == v1::STRAND_MODEL_UNSPECIFIED) return std::nullopt;
  static_assert(v1::STRAND_MODEL_WOUND - 1 == static_cast<int>(groom::StrandModel::kWound));
  return static_cast<groom::StrandModel>(model - 1);
}

}  // namespace

groom::GuideDescription ToDescription(const v1::Guide& message) {
  groom::GuideDescription guide;
  guide.root_position = ToVector(message.root_position());
  if (message.has_root_frame()) guide.root_frame = ToQuaternion(message.root_frame());
  guide.length_m = message.length_m();
  guide.element_count = message.element_count();
  guide.element_lengths_m = ToList(message.element_lengths_m());
  guide.radius_1_m = message.radius_1_m();
  guide.radius_2_m = message.radius_2_m();
  guide.young_modulus_pa = message.young_modulus_pa();
  guide.poisson_ratio = message.poisson_ratio();
  guide.density_kg_m3 = message.density_kg_m3();
  guide.internal_friction = message.internal_friction();
  guide.air_drag = message.air_drag();
  guide.natural_twist = ToList(message.natural_twist());
  guide.natural_curvature_1 = ToList(message.natural_curvature_1());
  guide.natural_curvature_2 = ToList(message.natural_curvature_2());
  if (const auto model = ToModel(message.model())) guide.model = *model;
  guide.wisp_radius_m = message.wisp_radius_m();
  return guide;
}

void FromDescription(const groom::GuideDescription& guide, v1::Guide* message) {
  FromVector(guide.root_position, message->mutable_root_position());
  FromQuaternion(guide.root_frame, message->mutable_root_frame());
  message->set_length_m(guide.length_m);
  message->set_element_count(guide.element_count);
  FromList(guide.element_lengths_m, message->mutable_element_lengths_m());
  message->set_radius_1_m(guide.radius_1_m);
  message->set_radius_2_m(guide.radius_2_m);
  message->set_young_modulus_pa(guide.young_modulus_pa);
  message->set_poisson_ratio(guide.poisson_ratio);
  message->set_density_kg_m3(guide.density_kg_m3);
  message->set_internal_friction(guide.internal_friction);
  message->set_air_drag(guide.air_drag);
  FromList(guide.natural_twist, message->mutable_natural_twist());
  FromList(guide.natural_curvature_1, message->mutable_natural_curvature_1());
  FromList(guide.natural_curvature_2, message->mutable_natural_curvature_2());
  if (guide.model == groom::StrandModel::kWound) message->set_model(v1::STRAND_MODEL_WOUND);
  message->set_wisp_radius_m(guide.wisp_radius_m);
}

Result<void> AppendMesh(const v1::TriangleMesh& message, groom::TriangleMesh* mesh) {
  if (const auto ok = AppendBytes(message.vertices(), "scalp_mesh.vertices", &mesh->vertices);
      !ok) {
    return ok;
  }
  if (const auto ok = AppendBytes(message.triangles(), "scalp_mesh.triangles", &mesh->triangles);
      !ok) {
    return ok;
  }
  return AppendBytes(message.hair_triangles(), "scalp_mesh.hair_triangles", &mesh->hair_triangles);
}

Result<void> AppendScalpMesh(const v1::TriangleMesh& message, const groom::Limits& limits,
                             groom::TriangleMesh* mesh) {
  if (const auto ok = AppendMesh(message, mesh); !ok) return ok;
  if (mesh->vertices.size() > static_cast<size_t>(limits.max_vertices)) {
    return groom::TooMany("scalp_mesh.vertices", "vertices", std::ssize(mesh->vertices),
                          limits.max_vertices);
  }
  const size_t triangles = std::max(mesh->triangles.size(), mesh->hair_triangles.size());
  if (triangles > static_cast<size_t>(limits.max_triangles)) {
    return groom::TooMany("scalp_mesh.triangles", "triangles", static_cast<long>(triangles),
                          limits.max_triangles);
  }
  return {};
}

void FromMesh(const groom::TriangleMesh& mesh, v1::TriangleMesh* message) {
  FromMeshPiece(mesh, 0, std::numeric_limits<size_t>::max(), message);
}

void FromMeshPiece(const groom::TriangleMesh& mesh, size_t begin, size_t count,
                   v1::TriangleMesh* message) {
  FromEntries(mesh.vertices, begin, count, message->mutable_vertices());
  FromEntries(mesh.triangles, begin, count, message->mutable_triangles());
  FromEntries(mesh.hair_triangles, begin, count, message->mutable_hair_triangles());
}

groom::Ellipsoid ToEllipsoid(const v1::EllipsoidScalp& message) {
  groom::Ellipsoid ellipsoid;
  ellipsoid.center = ToVector(message.center());
  ellipsoid.radii = ToVector(message.radii_m());
  if (message.has_cap_axis()) ellipsoid.cap_axis = ToVector(message.cap_axis());
  if (message.cap_angle() != 0) ellipsoid.cap_angle = message.cap_angle();
  return ellipsoid;
}

void FromEllipsoid(const groom::Ellipsoid& ellipsoid, v1::EllipsoidScalp* message) {
  FromVector(ellipsoid.center, message->mutable_center());
  FromVector(ellipsoid.radii, message->mutable_radii_m());
  FromVector(ellipsoid.cap_axis, message->mutable_cap_axis());
  message->set_cap_angle(ellipsoid.cap_angle);
}

Result<groom::HairType> ToHairType(v1::HairType message, const std::string& field) {
  if (message <= v1::HAIR_TYPE_UNSPECIFIED || message > v1::HAIR_TYPE_AFRICAN_FUZZY) {
    return InvalidArgument(
        field, fmt::format("{} is {}; it must be one of the HairType presets, 1 to 4", field,
                           static_cast<int>(message)));
  }
  return static_cast<groom::HairType>(message);
}

Result<groom::Generation> ToGeneration(const v1::GuideGeneration& message) {
  const auto hair_type = ToHairType(message.hair_type(), "header.generate.hair_type");
  if (!hair_type) return hair_type.error();
  groom::Generation generation;
  generation.hair_type = *hair_type;
  generation.guide_count = message.guide_count();
  generation.length_m = message.length_m();
  generation.element_count = message.element_count();
  if (message.has_error_target()) generation.error_target = message.error_target();
  generation.seed = message.seed();
  if (message.has_curl_variation()) generation.curl_variation = message.curl_variation();
  if (message.has_root_droop()) generation.root_droop = message.root_droop();
  generation.model = ToModel(message.model());
  generation.wisp_radius_m = message.wisp_radius_m();
  return generation;
}

void FromRecord(const storage::GroomRecord& record, v1::Groom* message) {
  message->set_name("grooms/" + record.id);
  message->set_display_name(record.display_name);
  FromNanoseconds(record.create_time_ns, message->mutable_create_time());
  message->set_guide_count(record.guide_count);
  message->set_element_count(record.element_count);
  message->set_longest_guide_m(record.longest_guide_m);
  message->set_hair_type(static_cast<v1::HairType>(record.hair_type));
  message->set_seed(record.seed);
  message->set_etag(record.etag);
  message->set_has_scalp(record.has_scalp);
  if (!record.import_summary.empty()) {
    message->mutable_import_summary()->ParseFromString(record.import_summary);
  }
  message->set_hair_count(record.hair_count);
  message->set_hair_point_count(record.hair_point_count);
  message->set_hair_offset_unit_m(record.hair_offset_unit_m);
  StoredContact contact;
  contact.ParseFromString(record.contact);
  message->set_body_count(static_cast<uint32_t>(contact.bodies_size()));
  *message->mutable_bodies() = std::move(*contact.mutable_bodies());
  if (contact.has_scalp_contact()) *message->mutable_scalp_contact() = contact.scalp_contact();
}

}  // namespace mane::rpc
