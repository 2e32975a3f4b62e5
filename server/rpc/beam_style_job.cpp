#include "rpc/beam_style_job.h"

#include <utility>

#include "base/clock.h"
#include "rpc/convert_beam_style.h"
#include "rpc/style_admission.h"
#include "rpc/style_result.h"
#include "styling/beam_hairstyle.h"

namespace mane::rpc {

Result<StyledHair> StyleByBeams(const v1::BeamStyle& message, const groom::Scalp& scalp,
                                const groom::ImportOptions& guides, const groom::Limits& limits,
                                exec::WorkerPool& pool, jobs::JobContext& context) {
  const auto style = ToBeamStyle(message, "header.beam_style");
  if (!style) return style.error();
  const double begin = base::SteadySeconds();
  auto made =
      styling::MakeBeamHairstyle(style->style, style->guide_count, scalp, "header.beam_style", pool,
                                 [&context] { return context.Cancelled(); });
  if (context.Cancelled()) return jobs::JobContext::StoppedError();
  if (!made) return made.error();
  const double seconds = base::SteadySeconds() - begin;
  const auto admitted = AdmitGuides(made->guides, guides, limits, "header.beam_style.guide_count");
  if (!admitted) return admitted.error();

  const auto owner = std::make_shared<styling::BeamHairstyle>(*std::move(made));
  StyledHair hair;
  hair.report.set_wisp_count(static_cast<uint32_t>(owner->guides.size()));
  hair.report.set_strand_count(static_cast<uint32_t>(owner->members.strands()));
  hair.report.set_control_point_count(owner->members.points.size());
  hair.report.set_seconds_members(seconds);
  if (const auto ok = WriteBeams(*owner, context); !ok) return ok.error();
  hair.guides = std::move(owner->guides);
  hair.first_member = owner->first_member;
  hair.members = &owner->members;
  hair.colours = owner->colours;
  hair.owner = owner;
  return hair;
}

}  // namespace mane::rpc
