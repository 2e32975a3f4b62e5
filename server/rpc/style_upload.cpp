#include "rpc/style_upload.h"

#include <utility>

#include "groom/import.h"
#include "groom/range.h"
#include "groom/validate.h"
#include "groom/validate_body.h"
#include "rpc/convert_beam_style.h"
#include "rpc/convert_body.h"
#include "rpc/convert_groom.h"
#include "rpc/convert_import.h"
#include "rpc/convert_style.h"
#include "rpc/job_service.h"
#include "rpc/names.h"
#include "rpc/style_admission.h"
#include "rpc/style_job.h"

namespace mane::rpc {
namespace {

constexpr size_t kMaxDisplayName = 200;
constexpr size_t kMaxRequestId = 64;

// Of the job, in a few words.
std::string Summary(const v1::ApplyStyleHeader& header) {
  std::string what;
  if (header.has_beam_style()) {
    long hairs = 0;
    for (const v1::BeamPart& part : header.beam_style().parts()) {
      hairs += part.has_hair_count() ? part.hair_count() : beam::Part().count;
    }
    what = fmt::format("style of {} hairs as beams", hairs);
  } else {
    const v1::Style& style = header.style();
    what = fmt::format(
        "style of {} wisps and {} strands",
        style.has_wisp_count() ? style.wisp_count() : styling::Style().wisp_count,
        style.has_strand_count() ? style.strand_count() : styling::Style().strand_count);
  }
  return header.groom_id().empty() ? what : what + " as grooms/" + header.groom_id();
}

}  // namespace

Result<bool> StyleUpload::Add(const v1::ApplyStyleRequest& request) {
  using Request = v1::ApplyStyleRequest;
  const bool is_header = request.part_case() == Request::kHeader;
  if (is_header == has_header_) {
    return InvalidArgument(
        "header", has_header_ ? "header was sent twice" : "the first message must be header");
  }
  Result<void> added;
  switch (request.part_case()) {
    case Request::kHeader:
      added = AddHeader(request.header());
      break;
    case Request::kScalpMesh:
      added = AddMesh(request.scalp_mesh());
      break;
    case Request::kBody:
      added = bodies_.Add(request.body());
      break;
    case Request::kCommit:
      return true;
    case Request::PART_NOT_SET:
      added = InvalidArgument("part", "the message holds no part of a head or style");
      break;
  }
  if (!added) return added.error();
  return false;
}

Result<void> StyleUpload::AddHeader(const v1::ApplyStyleHeader& header) {
  has_header_ = true;
  header_ = header;
  if (!header.groom_id().empty()) {
    if (const auto ok = CheckId(header.groom_id(), "header.groom_id"); !ok) return ok;
  }
  const auto name = CheckText(header.display_name(), kMaxDisplayName, "header.display_name");
  if (!name) return name;
  const auto request_id = CheckText(header.request_id(), kMaxRequestId, "header.request_id");
  if (!request_id) return request_id;
  if (header.has_scalp_contact()) {
    if (const auto friction = ToScalpFriction(header.scalp_contact()); !friction) {
      return friction.error();
    }
  }
  const auto guides = ToGuideOptions(header);
  if (!guides) return guides.error();
  if (header.has_style() && header.has_beam_style()) {
    return InvalidArgument("header.beam_style", "header.style and header.beam_style are both set");
  }
  if (header.has_beam_style()) {
    const auto style = ToBeamStyle(header.beam_style(), "header.beam_style");
    return style ? AdmitBeamStyle(*style, *guides, library_.limits()) : style.error();
  }
  const auto style = ToStyle(header.style(), "header.style");
  return style ? AdmitStyle(*style, *guides, library_.limits()) : style.error();
}

Result<void> StyleUpload::AddMesh(const v1::TriangleMesh& piece) {
  if (header_.has_ellipsoid()) {
    return InvalidArgument("scalp_mesh", "a scalp_mesh was sent although header.ellipsoid is set");
  }
  return AppendScalpMesh(piece, library_.limits(), &mesh_);
}

Result<v1::Job> StyleUpload::Finish(const std::atomic<bool>& /*cancelled*/) {
  groom::Scalp scalp;
  StoredStyle spec;
  if (header_.has_ellipsoid()) {
    scalp = ToEllipsoid(header_.ellipsoid());
  } else if (!mesh_.vertices.empty() || !mesh_.triangles.empty()) {
    FromMesh(mesh_, spec.mutable_scalp_mesh());
    scalp = std::move(mesh_);
  } else {
    return InvalidArgument("scalp_mesh",
                           "hair needs a scalp: send scalp_mesh, or set header.ellipsoid");
  }
  if (const auto ok = groom::ValidateScalp(scalp, library_.limits()); !ok) return ok.error();
  const std::vector<groom::Body> bodies = bodies_.Take();
  std::optional<groom::Friction> friction;
  if (header_.has_scalp_contact()) friction = *ToScalpFriction(header_.scalp_contact());
  const auto valid = groom::ValidateBodies(bodies, friction, scalp, library_.limits());
  if (!valid) return valid.error();
  for (const groom::Body& body : bodies) FromWholeBody(body, spec.add_bodies());
  if (IsTaken()) return GroomLibrary::Taken(header_.groom_id());

  *spec.mutable_header() = std::move(header_);
  const auto status = queue_.Submit(
      {kStyleKind, spec.SerializeAsString(), Summary(spec.header()), spec.header().request_id()});
  if (!status) return status.error();
  v1::Job job;
  FromStatus(*status, &job);
  return job;
}

bool StyleUpload::IsTaken() {
  if (header_.groom_id().empty()) return false;
  const auto groom = library_.store().Get(header_.groom_id());
  if (!groom) return false;
  // A repeated request finds the groom that its first job made.
  const std::string job = StyledBy(groom->request_id);
  const auto made = job.empty() ? Result<jobs::JobStatus>(Error()) : queue_.Get(job);
  return !made || header_.request_id().empty() || made->job.request_id != header_.request_id();
}

}  // namespace mane::rpc
