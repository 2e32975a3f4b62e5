#include "rpc/groom_upload.h"

#include <utility>

#include "groom/generate.h"
#include "groom/range.h"
#include "rpc/convert_body.h"
#include "rpc/convert_groom.h"
#include "rpc/convert_import.h"
#include "rpc/names.h"

namespace mane::rpc {
namespace {

constexpr size_t kMaxDisplayName = 200;
constexpr size_t kMaxRequestId = 64;

}  // namespace

Result<bool> GroomUpload::Add(const v1::CreateGroomRequest& request) {
  const bool is_header = request.part_case() == v1::CreateGroomRequest::kHeader;
  if (is_header == has_header_) {
    return InvalidArgument(
        "header", has_header_ ? "header was sent twice" : "the first message must be header");
  }
  Result<void> added;
  switch (request.part_case()) {
    case v1::CreateGroomRequest::kHeader:
      added = AddHeader(request.header());
      break;
    case v1::CreateGroomRequest::kGuides:
      added = AddGuides(request.guides());
      break;
    case v1::CreateGroomRequest::kStrands:
      added = AddStrands(request.strands());
      break;
    case v1::CreateGroomRequest::kScalpMesh:
      added = AddMesh(request.scalp_mesh());
      break;
    case v1::CreateGroomRequest::kBody:
      added = bodies_.Add(request.body());
      break;
    case v1::CreateGroomRequest::kHairs:
      added = hairs_.Add(request.hairs());
      break;
    case v1::CreateGroomRequest::kCommit:
      return true;
    case v1::CreateGroomRequest::PART_NOT_SET:
      added = InvalidArgument("part", "the message holds no part of a groom");
      break;
  }
  if (!added) return added.error();
  return false;
}

Result<void> GroomUpload::AddHeader(const v1::CreateGroomHeader& header) {
  has_header_ = true;
  header_ = header;
  if (!header.groom_id().empty()) {
    if (const auto ok = CheckId(header.groom_id(), "header.groom_id"); !ok) return ok;
  }
  if (const auto ok = CheckText(header.display_name(), kMaxDisplayName, "header.display_name");
      !ok) {
    return ok;
  }
  if (header.has_scalp_contact()) {
    auto friction = ToScalpFriction(header.scalp_contact());
    if (!friction) return friction.error();
    scalp_friction_ = *friction;
  }
  if (header.has_import_options()) {
    auto options = ToImportOptions(header.import_options());
    if (!options) return options.error();
    if (auto ok = groom::ValidateImportOptions(*options); !ok) return ok;
    import_options_ = *std::move(options);
  }
  return CheckText(header.request_id(), kMaxRequestId, "header.request_id");
}

Result<void> GroomUpload::AddGuides(const v1::GuideBatch& batch) {
  if (header_.has_generate()) {
    return InvalidArgument("guides", "guides were sent although header.generate makes them");
  }
  if (header_.has_import_options()) {
    return InvalidArgument("guides", "guides were sent although header.import_options is set");
  }
  const size_t limit = static_cast<size_t>(library_.limits().max_guides);
  for (const v1::Guide& message : batch.guides()) {
    if (guides_.size() == limit) {
      return groom::TooMany("guides", "guides", static_cast<long>(limit) + 1,
                            static_cast<long>(limit));
    }
    auto guide = groom::MakeGuide(ToDescription(message), static_cast<int>(guides_.size()));
    if (!guide) return guide.error();
    element_count_ += guide->strand.elements();
    if (element_count_ > library_.limits().max_elements) {
      return groom::TooMany("guides", "elements", element_count_, library_.limits().max_elements);
    }
    guides_.push_back(*std::move(guide));
  }
  return {};
}

Result<void> GroomUpload::AddStrands(const v1::StrandBatch& batch) {
  if (!header_.has_import_options()) {
    return InvalidArgument("strands", "strands were sent, but header.import_options is unset");
  }
  const groom::Limits& limits = library_.limits();
  for (const v1::ImportedStrand& message : batch.strands()) {
    if (strands_.size() == static_cast<size_t>(limits.max_guides)) {
      return groom::TooMany("strands", "strands", long{limits.max_guides} + 1, limits.max_guides);
    }
    const int index = static_cast<int>(strands_.size());
    auto strand = ToImportedStrand(message, index);
    if (!strand) return strand.error();
    if (auto ok = groom::ValidateStrand(*strand, import_options_, index); !ok) return ok;
    point_count_ += std::ssize(strand->points);
    if (point_count_ > limits.max_points) {
      return groom::TooMany("strands", "points", point_count_, limits.max_points);
    }
    import_cost_ += groom::ImportCost(strand->points.size(), import_options_);
    if (import_cost_ > limits.max_import_cost_s) {
      return Error{ErrorCode::kResourceExhausted,
                   fmt::format("the first {} strands would take {:.0f} s to import; at most {:.0f} "
                               "s are allowed: use fewer elements a strand, or fewer strands",
                               index + 1, import_cost_, limits.max_import_cost_s),
                   "strands"};
    }
    strands_.push_back(*std::move(strand));
  }
  return {};
}

Result<void> GroomUpload::AddMesh(const v1::TriangleMesh& piece) {
  if (header_.has_ellipsoid()) {
    return InvalidArgument("scalp_mesh", "a scalp_mesh was sent although header.ellipsoid is set");
  }
  return AppendScalpMesh(piece, library_.limits(), &mesh_);
}

size_t GroomUpload::GuideCount() const {
  if (header_.has_import_options()) return strands_.size();
  return header_.has_generate() ? header_.generate().guide_count() : guides_.size();
}

Result<v1::Groom> GroomUpload::Finish(const std::atomic<bool>& cancelled) {
  const auto record = Create(cancelled);
  if (!record) return record.error();
  v1::Groom groom;
  FromRecord(*record, &groom);
  return groom;
}

Result<storage::GroomRecord> GroomUpload::Create(const std::atomic<bool>& cancelled) {
  if (!header_.request_id().empty()) {
    const auto earlier = library_.store().FindByRequestId(header_.request_id());
    if (!earlier) return earlier.error();
    if (earlier->has_value()) return **earlier;
  }
  // Again when it is stored; before all that takes long.
  if (!header_.groom_id().empty() && library_.store().Get(header_.groom_id())) {
    return GroomLibrary::Taken(header_.groom_id());
  }
  GroomLibrary::Draft draft{header_.groom_id(), header_.request_id(), {}, {}, {}};
  draft.parts.display_name = header_.display_name();
  if (header_.has_ellipsoid()) {
    draft.parts.scalp = ToEllipsoid(header_.ellipsoid());
  } else if (!mesh_.vertices.empty() || !mesh_.triangles.empty()) {
    draft.parts.scalp = std::move(mesh_);
  }
  auto hairs = hairs_.Take(header_.hair_offset_unit_m(), GuideCount());
  if (!hairs) return hairs.error();
  draft.parts.hairs = *std::move(hairs);
  draft.parts.bodies = bodies_.Take();
  draft.parts.scalp_friction = scalp_friction_;
  const base::Cancelled is_cancelled = [&cancelled] { return cancelled.load(); };
  auto contact = library_.PrepareContact(draft.parts, is_cancelled);
  if (!contact) return contact.error();
  draft.contact = *std::move(contact);
  if (header_.has_generate() && header_.has_import_options()) {
    return InvalidArgument("header.import_options",
                           "header.import_options is set although header.generate makes guides");
  }
  if (header_.has_import_options()) {
    if (strands_.empty()) {
      return InvalidArgument("strands", "strands is empty; header.import_options is set for them");
    }
    auto import = groom::ImportStrands(strands_, import_options_, library_.pool(), is_cancelled);
    if (!import) return import.error();
    FromImport(import_options_, import->outcomes, &draft.import_report.emplace());
    draft.parts.guides = std::move(import->guides);
    draft.parts.rest = std::move(import->rest);
  } else if (header_.has_generate()) {
    const auto generation = ToGeneration(header_.generate());
    if (!generation) return generation.error();
    auto guides = groom::Generate(draft.parts.scalp, *generation, library_.limits());
    if (!guides) return guides.error();
    draft.parts.hair_type = generation->hair_type;
    draft.parts.seed = generation->seed;
    draft.parts.guides = *std::move(guides);
  } else {
    draft.parts.guides = std::move(guides_);
  }
  return library_.Create(std::move(draft));
}

}  // namespace mane::rpc
