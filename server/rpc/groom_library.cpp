#include "rpc/groom_library.h"

#include <algorithm>
#include <chrono>
#include <cstring>
#include <limits>

#include "groom/digest.h"
#include "groom/validate_body.h"
#include "rpc/convert_body.h"
#include "rpc/convert_groom.h"
#include "rpc/convert_hairs.h"
#include "rpc/names.h"

namespace mane::rpc {
namespace {

constexpr double kNoWork = std::numeric_limits<double>::infinity();

int64_t NowNanoseconds() {
  return std::chrono::duration_cast<std::chrono::nanoseconds>(
             std::chrono::system_clock::now().time_since_epoch())
      .count();
}

std::string EncodeContent(const groom::Groom& groom,
                          const std::optional<v1::ImportReport>& import_report) {
  StoredGroom stored;
  if (import_report) *stored.mutable_import_report() = *import_report;
  for (const groom::Guide& guide : groom.guides) {
    FromDescription(groom::Describe(guide), stored.add_guides());
  }
  if (const auto* mesh = std::get_if<groom::TriangleMesh>(&groom.scalp)) {
    FromMesh(*mesh, stored.mutable_scalp_mesh());
  } else if (const auto* ellipsoid = std::get_if<groom::Ellipsoid>(&groom.scalp)) {
    FromEllipsoid(*ellipsoid, stored.mutable_ellipsoid());
  }
  for (const groom::Body& body : groom.bodies) {
    FromWholeBody(body, stored.add_bodies());
  }
  if (groom.scalp_friction) {
    FromScalpFriction(*groom.scalp_friction, stored.mutable_scalp_contact());
  }
  if (groom.hairs != nullptr) {
    FromHairs(*groom.hairs, 0, groom.hairs->count(), stored.mutable_hairs());
    stored.set_hair_offset_unit_m(groom.hairs->offset_unit);
  }
  return stored.SerializeAsString();
}

Error Damaged(const std::string& id) {
  return {ErrorCode::kInternal, fmt::format("the stored content of grooms/{} is damaged", id), ""};
}

Result<groom::Parts> DecodeContent(const storage::GroomRecord& record,
                                   const storage::GroomContent& content) {
  StoredGroom stored;
  if (!stored.ParseFromString(content.groom)) return Damaged(record.id);
  groom::Parts parts;
  parts.display_name = record.display_name;
  parts.hair_type = static_cast<groom::HairType>(record.hair_type);
  parts.seed = record.seed;
  if (stored.has_scalp_mesh()) {
    groom::TriangleMesh mesh;
    if (!AppendMesh(stored.scalp_mesh(), &mesh)) return Damaged(record.id);
    parts.scalp = std::move(mesh);
  } else if (stored.has_ellipsoid()) {
    parts.scalp = ToEllipsoid(stored.ellipsoid());
  }
  for (const v1::Guide& message : stored.guides()) {
    auto guide = groom::MakeGuide(ToDescription(message), static_cast<int>(parts.guides.size()));
    if (!guide) return Damaged(record.id);
    parts.guides.push_back(*std::move(guide));
  }
  for (const v1::Body& message : stored.bodies()) {
    auto body = ToWholeBody(message, static_cast<int>(parts.bodies.size()));
    if (!body) return Damaged(record.id);
    parts.bodies.push_back(*std::move(body));
  }
  if (stored.has_scalp_contact()) {
    const auto friction = ToScalpFriction(stored.scalp_contact());
    if (!friction) return Damaged(record.id);
    parts.scalp_friction = *friction;
  }
  if (stored.has_hairs()) {
    const auto hairs = std::make_shared<groom::Hairs>();
    hairs->offset_unit = stored.hair_offset_unit_m();
    if (!AppendHairs(stored.hairs(), hairs.get())) return Damaged(record.id);
    parts.hairs = hairs;
  }
  parts.rest.resize(content.rest.size() / sizeof(double));
  std::memcpy(parts.rest.data(), content.rest.data(), parts.rest.size() * sizeof(double));
  return parts;
}

}  // namespace

Result<std::shared_ptr<head::Bodies>> GroomLibrary::MakeShapes(const groom::Parts& parts,
                                                               const base::Cancelled& cancelled) {
  groom::Groom groom;
  groom.bodies = parts.bodies;
  groom.scalp_friction = parts.scalp_friction;
  if (groom.scalp_friction) groom.scalp = parts.scalp;
  return bodies_.MakeShapes(groom, cancelled);
}

Result<StoredContact> GroomLibrary::PrepareContact(const groom::Parts& parts,
                                                   const base::Cancelled& cancelled) {
  if (parts.bodies.empty() && !parts.scalp_friction) return StoredContact();
  const auto valid =
      groom::ValidateBodies(parts.bodies, parts.scalp_friction, parts.scalp, limits_);
  if (!valid) return valid.error();
  const auto bodies = MakeShapes(parts, cancelled);
  if (!bodies) return bodies.error();
  return DescribeContact(parts, bodies->get());
}

Result<storage::GroomRecord> GroomLibrary::Create(Draft draft) {
  const auto groom = groom::Assemble(std::move(draft.parts), limits_, &pool_);
  if (!groom) return groom.error();
  const groom::Groom& g = **groom;
  storage::GroomRecord record;
  record.id = draft.id.empty() ? RandomId() : draft.id;
  record.request_id = draft.request_id;
  record.display_name = g.display_name;
  record.hair_type = static_cast<int>(g.hair_type);
  record.seed = g.seed;
  record.guide_count = static_cast<uint32_t>(g.guide_count());
  record.element_count = static_cast<uint32_t>(g.element_count());
  for (const groom::Guide& guide : g.guides) {
    record.longest_guide_m = std::max(record.longest_guide_m, guide.strand.TotalLength());
  }
  record.has_scalp = !std::holds_alternative<std::monostate>(g.scalp);
  record.etag = groom::Digest(g);
  record.create_time_ns = NowNanoseconds();
  if (draft.import_report) {
    record.import_summary = draft.import_report->summary().SerializeAsString();
  }
  record.contact = draft.contact.SerializeAsString();
  if (g.hairs != nullptr) {
    record.hair_count = static_cast<uint32_t>(g.hairs->count());
    record.hair_point_count = g.hairs->places.size();
    record.hair_offset_unit_m = g.hairs->offset_unit;
  }
  const auto* rest = reinterpret_cast<const char*>(g.rest.data());
  auto stored = store_.Put(record, {EncodeContent(g, draft.import_report),
                                    std::string(rest, g.rest.size() * sizeof(double))});
  if (!stored && stored.error().code == ErrorCode::kAlreadyExists) return Taken(record.id);
  return stored;
}

Error GroomLibrary::Taken(const std::string& id) {
  return {ErrorCode::kAlreadyExists,
          fmt::format("header.groom_id is `{}`, and `grooms/{}` already exists", id, id),
          "header.groom_id"};
}

Result<storage::GroomRecord> GroomLibrary::Find(const std::string& name, const std::string& field) {
  const auto id = ParseName(name, "grooms", field);
  if (!id) return id.error();
  auto record = store_.Get(*id);
  if (!record) {
    Error error = record.error();
    if (error.code == ErrorCode::kNotFound) error.field = field;
    return error;
  }
  return record;
}

Result<v1::ImportReport> GroomLibrary::LoadImportReport(const std::string& name,
                                                        const std::string& field) {
  const auto record = Find(name, field);
  if (!record) return record.error();
  if (record->import_summary.empty()) {
    return Error{ErrorCode::kFailedPrecondition,
                 fmt::format("{} was not made from strands; it has no import report", name), field};
  }
  const auto content = store_.GetContent(record->id);
  if (!content) return content.error();
  StoredGroom stored;
  if (!stored.ParseFromString(content->groom) || !stored.has_import_report()) {
    return Damaged(record->id);
  }
  return std::move(*stored.mutable_import_report());
}

Result<std::shared_ptr<const groom::Groom>> GroomLibrary::Load(const std::string& name,
                                                               const std::string& field) {
  const auto record = Find(name, field);
  if (!record) return record.error();
  const std::string key = fmt::format("{} {} {}", record->id, record->etag, record->create_time_ns);
  {
    std::lock_guard lock(mutex_);
    const auto kept = std::ranges::find(recent_, key, &decltype(recent_)::value_type::first);
    if (kept != recent_.end()) {
      recent_.splice(recent_.begin(), recent_, kept);
      return recent_.front().second;
    }
  }
  auto groom = Read(*record);
  if (!groom) return groom;
  std::lock_guard lock(mutex_);
  recent_.emplace_front(key, *groom);
  if (recent_.size() > kKept) recent_.pop_back();
  return groom;
}

Result<session::Asset> GroomLibrary::LoadAsset(const std::string& name, const std::string& field,
                                               const base::Cancelled& cancelled) {
  auto groom = Load(name, field);
  if (!groom) return groom.error();
  return MakeAsset(*std::move(groom), field, cancelled);
}

Result<session::Asset> GroomLibrary::MakeAsset(std::shared_ptr<const groom::Groom> groom,
                                               const std::string& field,
                                               const base::Cancelled& cancelled) {
  auto bodies = bodies_.FindOrMake(groom, cancelled);
  if (!bodies) return Error{bodies.error().code, bodies.error().message, field};
  return session::Asset{std::move(groom), *std::move(bodies)};
}

exec::WorkerPool* GroomLibrary::MakersOf(const std::string& name) {
  const auto groom = Load(name, "name");
  return groom && bodies_.Missing(*groom) ? &bodies_.PoolFor(**groom) : nullptr;
}

Result<std::shared_ptr<const groom::Groom>> GroomLibrary::Read(const storage::GroomRecord& record) {
  const auto content = store_.GetContent(record.id);
  if (!content) return content.error();
  auto parts = DecodeContent(record, *content);
  if (!parts) return parts.error();
  // Limits are for uploads: what is stored stays usable when they are lowered.
  constexpr int kNone = std::numeric_limits<int>::max();
  return groom::Assemble(
      *std::move(parts),
      {kNone, kNone, kNone, kNoWork, kNone, kNone, kNone, kNone, kNone, kNone, kNone}, &pool_);
}

}  // namespace mane::rpc
