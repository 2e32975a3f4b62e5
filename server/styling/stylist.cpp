#include "styling/stylist.h"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <optional>
#include <tuple>
#include <utility>

#include "base/clock.h"
#include "groom/hairs.h"
#include "groom/range.h"
#include "math/random.h"
#include "styling/colour.h"
#include "styling/constraint.h"
#include "styling/distribution.h"
#include "styling/equal.h"
#include "styling/force_field.h"
#include "styling/map.h"
#include "styling/masters.h"
#include "styling/members.h"
#include "styling/region.h"
#include "styling/roots.h"
#include "styling/selection.h"

namespace mane::styling {
namespace {

// Streams of a style's seed that stages draw from; strands and wisps count on from them.
enum SeedOf : uint64_t { kRootSeed = 1, kMasterSeed, kMemberSeed, kColourSeed };

uint64_t StageSeed(uint64_t seed, SeedOf stage) { return math::RandomStream(seed, stage).Bits(); }

// What a stage was made of, the stages that it builds on among them by their version.
using RootsKey = std::tuple<uint64_t, ScalpMap, ScalpMap, std::vector<Cut>, int, int>;
using MastersKey =
    std::tuple<int, uint64_t, double, Synthesis, std::vector<Style::RegionalSynthesis>,
               Distribution, std::vector<double>>;
using DeformationKey = std::tuple<int, ScalpMap, std::vector<FieldTerm>, std::vector<double>,
                                  std::vector<ConstraintQueue>, std::vector<Cut>>;
using MembersKey = std::tuple<int, uint64_t, Distribution, std::vector<double>, double>;
using ColoursKey = std::tuple<int, uint64_t, Colouring>;

// A stage's outcome with what it was made of. Who needs it anew gets a higher version.
template <typename Key>
struct Stage {
  std::optional<Key> key;
  int version = 0;

  // Whether it must be made; then it counts as made of `wanted`, unless Fail follows.
  bool Renew(Key wanted) {
    if (key && *key == wanted) return false;
    key = std::move(wanted);
    ++version;
    return true;
  }
  void Fail() { key.reset(); }
};

std::vector<Cut> LengthCuts(const std::vector<Cut>& cuts) {
  std::vector<Cut> found;
  std::ranges::copy_if(cuts, std::back_inserter(found),
                       [](const Cut& cut) { return cut.length.has_value(); });
  return found;
}

std::vector<Cut> PlaneCuts(const std::vector<Cut>& cuts) {
  std::vector<Cut> found;
  std::ranges::copy_if(cuts, std::back_inserter(found),
                       [](const Cut& cut) { return cut.plane.has_value(); });
  return found;
}

// RESOURCE_EXHAUSTED where members could have more control points than that.
Result<void> CheckPoints(const Roots& roots, const Masters& masters, long max_points,
                         const std::string& field) {
  long points = 0;
  for (int wisp = 0; wisp < roots.wisps(); ++wisp) {
    const long joints = masters.first_joint[wisp + 1] - masters.first_joint[wisp];
    points += long{roots.first_member[wisp + 1] - roots.first_member[wisp]} * joints;
    if (joints <= groom::kMaxHairPoints) continue;
    return Error{ErrorCode::kResourceExhausted,
                 fmt::format("{}.segment_length_m is {} m, which gives the longest hair {} control "
                             "points; at most {} are allowed: use longer segments, or shorter hair",
                             field, masters.segment_length, joints, groom::kMaxHairPoints),
                 field + ".segment_length_m"};
  }
  if (points <= max_points) return {};
  return Error{ErrorCode::kResourceExhausted,
               fmt::format("{}.strand_count strands have {} control points together; at most {} "
                           "are allowed: use longer segments, or fewer strands",
                           field, points, max_points),
               field + ".strand_count"};
}

// Direction in which a master leaves its root: along the normal where the protrusion is 1, along
// the surface with the field where it is 0.
Eigen::Vector3d FirstDirection(double protrusion, const groom::ScalpPoint& root,
                               const ForceField& field) {
  const Eigen::Vector3d& n = root.normal;
  const Eigen::Vector3d phi = field.At(root.position);
  const Eigen::Vector3d along = phi - phi.dot(n) * n;
  // Where the field has no direction along the surface, hair stands up.
  if (along.norm() < 1e-6 * std::max(phi.norm(), 1e-6)) return n;
  return (protrusion * n + (1 - protrusion) * along.normalized()).normalized();
}

SolverInput MakeSolverInput(const Style& style, const Roots& roots, const Masters& masters,
                            const ScalpChart& chart, std::vector<std::vector<uint32_t>> selected,
                            const Obstacles& obstacles) {
  SolverInput input;
  input.roots = roots.masters;
  input.field = style.field;
  input.bending_stiffness = style.bending_stiffness;
  input.density_threshold = style.density_threshold;
  input.strand_cross_section = style.strand_cross_section;
  input.cell = style.cell;
  input.queues = style.queues;
  input.selected = std::move(selected);
  input.obstacles = obstacles;
  const ForceField field(style.field);
  const Quantile lengths(style.member_length);
  for (int wisp = 0; wisp < roots.wisps(); ++wisp) {
    const groom::ScalpPoint& root = roots.masters[wisp];
    const double protrusion = ValueAt(style.protrusion, chart.At(root.position));
    input.first_directions.push_back(FirstDirection(protrusion, root, field));
    const auto members = roots.first_member[wisp + 1] - roots.first_member[wisp];
    const uint32_t joints = masters.first_joint[wisp + 1] - masters.first_joint[wisp];
    for (uint32_t i = 0; i < joints; ++i) {
      const double s = i * masters.segment_length / masters.length[wisp];
      // Members that reach so far, on the average, and the master.
      const double strands = members * (1 - lengths.Cdf(s)) + (s < 1 ? 1 : 0);
      input.strands.push_back(static_cast<float>(strands));
      input.radii.push_back(RadiusAt(style.radii, static_cast<float>(s)));
    }
  }
  return input;
}

// Of an error about a queue that an operation made, the operation.
Error NameSource(Error error, const Style& style, const std::string& field) {
  for (size_t i = 0; i < style.queues.size(); ++i) {
    const std::string queue = fmt::format("{}.queues[{}]", field, i);
    const std::string& source = style.queues[i].source;
    if (source.empty() || !error.field.starts_with(queue)) continue;
    error.field = source;
    const size_t at = error.message.find(queue);
    if (at != std::string::npos) error.message.replace(at, queue.size(), source);
    break;
  }
  return error;
}

// Measures a stage.
class Watch {
 public:
  explicit Watch(double* seconds) : seconds_(seconds), begin_(base::SteadySeconds()) {}
  ~Watch() { *seconds_ = base::SteadySeconds() - begin_; }
  Watch(const Watch&) = delete;
  Watch& operator=(const Watch&) = delete;

 private:
  double* seconds_;
  const double begin_;
};

}  // namespace

struct Stylist::Kept {
  std::shared_ptr<Hairstyle> style = std::make_shared<Hairstyle>();
  std::vector<double> lengths;  // Of masters [m], (wisps).
  Masters undeformed;
  Stage<RootsKey> roots;
  Stage<MastersKey> masters;
  Stage<DeformationKey> deformation;
  Stage<MembersKey> members;
  Stage<ColoursKey> colours;
};

Stylist::Stylist(groom::Scalp scalp, Obstacles obstacles, const StyleLimits& limits)
    : scalp_(std::move(scalp)),
      obstacles_(std::move(obstacles)),
      limits_(limits),
      chart_(scalp_),
      kept_(std::make_unique<Kept>()) {}

Stylist::~Stylist() = default;

Result<std::shared_ptr<const Hairstyle>> Stylist::Apply(const Style& style,
                                                        const std::string& field,
                                                        exec::WorkerPool& pool,
                                                        const base::Cancelled& cancelled,
                                                        const Progress& progress) {
  auto made = Make(style, field, pool, cancelled, progress);
  return made ? made : NameSource(made.error(), style, field);
}

Result<std::shared_ptr<const Hairstyle>> Stylist::Make(const Style& style, const std::string& field,
                                                       exec::WorkerPool& pool,
                                                       const base::Cancelled& cancelled,
                                                       const Progress& progress) {
  // Of a run on two cores: where a stage ends.
  constexpr double kRootsDone = 0.2, kMastersDone = 0.25, kDeformed = 0.7, kMembersDone = 0.95;
  const auto tell = [&progress](double done) {
    if (progress) progress(done);
  };
  times_ = {};
  // What was given away stays as it is.
  if (kept_->style.use_count() > 1) kept_->style = std::make_shared<Hairstyle>(*kept_->style);
  Hairstyle& made = *kept_->style;

  if (const auto ok = MakeRoots(style, field, pool); !ok) return ok.error();
  tell(kRootsDone);
  if (base::IsCancelled(cancelled)) return base::CancelledError();
  if (const auto ok = MakeMasters(style, field, pool); !ok) return ok.error();
  tell(kMastersDone);
  const auto deformed = Deform(style, field, pool, cancelled, [&](double done) {
    tell(kMastersDone + (kDeformed - kMastersDone) * done);
  });
  if (!deformed) return deformed.error();
  tell(kDeformed);
  if (base::IsCancelled(cancelled)) return base::CancelledError();
  if (kept_->members.Renew({kept_->deformation.version, style.seed, style.member_length,
                            style.radii, style.fuzziness})) {
    const Watch watch(&times_.members);
    made.members =
        MakeMembers(made.roots, made.masters, obstacles_, style.member_length, style.radii,
                    style.fuzziness, StageSeed(style.seed, kMemberSeed), pool, cancelled);
    if (base::IsCancelled(cancelled)) {
      kept_->members.Fail();
      return base::CancelledError();
    }
  }
  tell(kMembersDone);
  if (kept_->colours.Renew({kept_->roots.version, style.seed, style.colour})) {
    made.colours = Colour(made.roots, style.colour, StageSeed(style.seed, kColourSeed), pool);
  }
  tell(1);
  return std::shared_ptr<const Hairstyle>(kept_->style);
}

Result<void> Stylist::MakeRoots(const Style& style, const std::string& field,
                                exec::WorkerPool& pool) {
  // Lengths are among what they are made of: where hair has none, nothing grows.
  if (!kept_->roots.Renew({style.seed, style.density, style.length, LengthCuts(style.cuts),
                           style.wisp_count, style.strand_count})) {
    return {};
  }
  const Watch watch(&times_.roots);
  auto roots = PlaceRoots(scalp_, chart_, style.density, style.wisp_count, style.strand_count,
                          StageSeed(style.seed, kRootSeed), pool);
  if (!roots) {
    kept_->roots.Fail();
    return Error{roots.error().code, roots.error().message, field + "." + roots.error().field};
  }
  kept_->lengths = LengthsOf(style.length, *roots, chart_);
  LeaveOutBald(&*roots, &kept_->lengths);
  // After it, so that the numbers of wisps in regions mean the same everywhere.
  CutByLength(style.cuts, *roots, chart_, &kept_->lengths);
  if (roots->wisps() == 0) {
    kept_->roots.Fail();
    return InvalidArgument(field + ".length",
                           field + ".length is 0 wherever hair grows on this scalp");
  }
  kept_->style->roots = *std::move(roots);
  return {};
}

Result<void> Stylist::MakeMasters(const Style& style, const std::string& field,
                                  exec::WorkerPool& pool) {
  if (!kept_->masters.Renew({kept_->roots.version, style.seed, style.segment_length,
                             style.synthesis, style.regional, style.member_length, style.radii})) {
    return {};
  }
  const Watch watch(&times_.masters);
  const Roots& roots = kept_->style->roots;
  auto masters = styling::MakeMasters(style, roots, chart_, kept_->lengths, limits_.max_joints,
                                      StageSeed(style.seed, kMasterSeed), field, pool);
  Result<void> fits;
  if (masters) fits = CheckPoints(roots, *masters, limits_.max_points, field);
  if (!masters || !fits) {
    kept_->masters.Fail();
    return masters ? fits : Result<void>(masters.error());
  }
  kept_->undeformed = *std::move(masters);
  return {};
}

Result<void> Stylist::Deform(const Style& style, const std::string& field, exec::WorkerPool& pool,
                             const base::Cancelled& cancelled, const Progress& progress) {
  if (!kept_->deformation.Renew({kept_->masters.version,
                                 style.protrusion,
                                 style.field,
                                 {style.bending_stiffness, style.density_threshold,
                                  style.strand_cross_section, style.cell},
                                 style.queues,
                                 PlaneCuts(style.cuts)})) {
    return {};
  }
  const Watch watch(&times_.deformation);
  Hairstyle& made = *kept_->style;
  made.masters = kept_->undeformed;
  const auto ok = [&]() -> Result<void> {
    if (auto valid = Validate(style.queues, obstacles_, field + ".queues"); !valid) return valid;
    auto selected = SelectWisps(style.queues, made.roots, chart_, field);
    if (!selected) return selected.error();
    const SolverInput input =
        MakeSolverInput(style, made.roots, made.masters, chart_, *std::move(selected), obstacles_);
    auto deformed = styling::Deform(input, &made.masters, cancelled, progress, &pool);
    if (!deformed) return deformed.error();
    made.density = std::move(deformed->density);
    made.solved = std::move(deformed->report);
    return {};
  }();
  if (!ok) {
    kept_->deformation.Fail();
    return ok;
  }
  CutByPlanes(style.cuts, made.roots, chart_, &made.masters);
  return {};
}

}  // namespace mane::styling
