#include "rpc/style_job.h"

#include <algorithm>
#include <utility>
#include <vector>

#include "base/clock.h"
#include "rpc/beam_style_job.h"
#include "rpc/convert_body.h"
#include "rpc/convert_groom.h"
#include "rpc/convert_import.h"
#include "rpc/convert_style.h"
#include "rpc/style_admission.h"
#include "rpc/style_result.h"
#include "stored.pb.h"
#include "styling/guides.h"

namespace mane::rpc {
namespace {

// Shares of a job's progress.
constexpr double kStyled = 0.3;
constexpr double kWritten = 0.4;
constexpr double kImported = 0.95;
// Of the request id of a job's groom: it is made once, even if the job is run again.
constexpr std::string_view kRequestPrefix = "style-";
// Members' control points that a kept stylist may hold: some 200 MB with what belongs to them.
constexpr size_t kMostKeptPoints = 8'000'000;
// Strands that are imported between two looks at progress.
constexpr size_t kStrandsPerStep = 64;

// The head that is styled, and what the groom is made of but its hair.
Result<groom::Parts> ToParts(const StoredStyle& spec) {
  groom::Parts parts;
  parts.display_name = spec.header().display_name();
  parts.seed = spec.header().has_beam_style() ? spec.header().beam_style().seed()
                                              : spec.header().style().seed();
  if (spec.header().has_ellipsoid()) {
    parts.scalp = ToEllipsoid(spec.header().ellipsoid());
  } else {
    groom::TriangleMesh mesh;
    if (const auto ok = AppendMesh(spec.scalp_mesh(), &mesh); !ok) return ok.error();
    parts.scalp = std::move(mesh);
  }
  for (const v1::Body& message : spec.bodies()) {
    auto body = ToWholeBody(message, static_cast<int>(parts.bodies.size()));
    if (!body) return body.error();
    parts.bodies.push_back(*std::move(body));
  }
  if (spec.header().has_scalp_contact()) {
    const auto friction = ToScalpFriction(spec.header().scalp_contact());
    if (!friction) return friction.error();
    parts.scalp_friction = *friction;
  }
  return parts;
}

// What styled hair keeps out of: the scalp whether or not the groom's hair will meet it, and
// bodies. A scalp that bounds no solid, such as a cap of skin, is left out where there are bodies.
Result<styling::Obstacles> MakeObstacles(GroomLibrary& library, const groom::Parts& parts,
                                         const base::Cancelled& cancelled) {
  groom::Parts solid;
  solid.scalp = parts.scalp;
  solid.bodies = parts.bodies;
  solid.scalp_friction = groom::Friction();
  auto bodies = library.MakeShapes(solid, cancelled);
  const bool is_open = !bodies && bodies.error().code == ErrorCode::kInvalidArgument &&
                       bodies.error().field.starts_with("scalp_mesh");
  if (is_open && !parts.bodies.empty() && !parts.scalp_friction) {
    solid.scalp_friction.reset();
    bodies = library.MakeShapes(solid, cancelled);
  }
  if (!bodies) return bodies.error();
  styling::Obstacles obstacles;
  for (const head::Bodies::Body& body : (*bodies)->bodies) {
    obstacles.push_back({body.shape, body.pose});
  }
  return obstacles;
}

// Imports the masters, some at a time.
Result<groom::Import> ImportMasters(const std::vector<groom::ImportedStrand>& strands,
                                    const groom::ImportOptions& options, exec::WorkerPool& pool,
                                    jobs::JobContext& context) {
  groom::Import all;
  for (size_t begin = 0; begin < strands.size(); begin += kStrandsPerStep) {
    const size_t count = std::min(kStrandsPerStep, strands.size() - begin);
    auto some = groom::ImportStrands(std::span(strands).subspan(begin, count), options, pool,
                                     [&] { return context.Cancelled(); });
    if (context.Cancelled()) return jobs::JobContext::StoppedError();
    if (!some) return some.error();
    std::ranges::move(some->guides, std::back_inserter(all.guides));
    std::ranges::copy(some->rest, std::back_inserter(all.rest));
    std::ranges::copy(some->outcomes, std::back_inserter(all.outcomes));
    const double done = static_cast<double>(begin + count) / static_cast<double>(strands.size());
    context.Progress(kWritten + (kImported - kWritten) * done);
  }
  return all;
}

}  // namespace

std::string StyledBy(const std::string& request_id) {
  return request_id.starts_with(kRequestPrefix) ? request_id.substr(kRequestPrefix.size()) : "";
}

Result<void> StyleJobs::Run(const std::string& job, jobs::JobContext& context) {
  StoredStyle spec;
  if (!spec.ParseFromString(context.spec())) {
    return Error{ErrorCode::kInternal, "the stored style does not parse", ""};
  }
  const auto options = ToGuideOptions(spec.header());
  if (!options) return options.error();
  auto parts = ToParts(spec);
  if (!parts) return parts.error();
  auto contact = library_.PrepareContact(*parts, [&context] { return context.Cancelled(); });
  if (context.Cancelled()) return jobs::JobContext::StoppedError();
  if (!contact) return contact.error();
  auto hair = spec.header().has_beam_style()
                  ? StyleByBeams(spec.header().beam_style(), parts->scalp, *options,
                                 library_.limits(), pool_, context)
                  : StyleByWisps(spec, *parts, *options, context);
  if (!hair) return hair.error();

  context.Progress(kWritten);
  const double begin = base::SteadySeconds();
  auto import = ImportMasters(hair->guides, *options, pool_, context);
  if (!import) return import.error();
  GroomLibrary::Draft draft{
      spec.header().groom_id(), std::string(kRequestPrefix) + job, *std::move(parts), {}, {}};
  draft.contact = *std::move(contact);
  if (context.Cancelled()) return jobs::JobContext::StoppedError();
  draft.parts.hairs = std::make_shared<const groom::Hairs>(
      styling::ToHairs(hair->guides, hair->first_member, *hair->members, hair->colours,
                       import->guides, import->rest));
  hair->owner.reset();  // Not needed any more, and large.
  if (context.Cancelled()) return jobs::JobContext::StoppedError();
  FromImport(*options, import->outcomes, &draft.import_report.emplace());
  draft.parts.guides = std::move(import->guides);
  draft.parts.rest = std::move(import->rest);
  const auto record = library_.Create(std::move(draft));
  if (!record) return record.error();
  v1::HairstylePart last;
  *last.mutable_report() = std::move(hair->report);
  last.mutable_report()->set_groom("grooms/" + record->id);
  last.mutable_report()->set_seconds_guides(base::SteadySeconds() - begin);
  return context.AppendResult(last.SerializeAsString());
}

Result<StyledHair> StyleJobs::StyleByWisps(const StoredStyle& spec, const groom::Parts& parts,
                                           const groom::ImportOptions& guides,
                                           jobs::JobContext& context) {
  const base::Cancelled cancelled = [&context] { return context.Cancelled(); };
  const auto style = ToStyle(spec.header().style(), "header.style");
  if (!style) return style.error();
  LastHead head = Take(spec);
  if (head.stylist == nullptr) {
    auto obstacles = MakeObstacles(library_, parts, cancelled);
    if (context.Cancelled()) return jobs::JobContext::StoppedError();
    if (!obstacles) return obstacles.error();
    head.stylist = std::make_unique<styling::Stylist>(parts.scalp, *std::move(obstacles));
  }
  auto hairstyle =
      head.stylist->Apply(*style, "header.style", pool_, cancelled,
                          [&context](double done) { context.Progress(kStyled * done); });
  const styling::StageTimes times = head.stylist->times();
  Keep(std::move(head), hairstyle ? (*hairstyle)->members.points.size() : 0);
  if (context.Cancelled()) return jobs::JobContext::StoppedError();
  if (!hairstyle) return hairstyle.error();
  const styling::Hairstyle& h = **hairstyle;

  StyledHair hair{styling::ToStrands(h.masters),
                  h.roots.first_member,
                  &h.members,
                  h.colours,
                  MakeReport(*style, h, times),
                  {}};
  const auto admitted =
      AdmitGuides(hair.guides, guides, library_.limits(), "header.style.wisp_count");
  if (!admitted) return admitted.error();
  if (const auto ok = WriteHairstyle(*style, h, context); !ok) return ok.error();
  hair.owner = *std::move(hairstyle);
  return hair;
}

StyleJobs::LastHead StyleJobs::Take(const StoredStyle& spec) {
  StoredStyle head;
  *head.mutable_scalp_mesh() = spec.scalp_mesh();
  *head.mutable_bodies() = spec.bodies();
  if (spec.header().has_ellipsoid()) {
    *head.mutable_header()->mutable_ellipsoid() = spec.header().ellipsoid();
  }
  const std::string bytes = head.SerializeAsString();
  std::lock_guard lock(mutex_);
  if (last_.head != bytes) return {bytes, nullptr};
  return {bytes, std::move(last_.stylist)};
}

void StyleJobs::Keep(LastHead head, size_t points) {
  if (points > kMostKeptPoints) head.stylist.reset();
  std::lock_guard lock(mutex_);
  last_ = std::move(head);
}

}  // namespace mane::rpc
