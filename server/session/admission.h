#pragma once

#include "base/result.h"
#include "head/head.h"
#include "session/command.h"

namespace mane::session {

/// What one head may cost, so that it cannot hold up the others: a frame, once begun, is computed
/// to its end. Costs count in element-steps, one time step of one element: some 40 ns of one core
/// with vector kernels, up to a microsecond without. What else a frame costs counts as the
/// element-steps that take about as long. All are estimates, made to tell what fits easily from
/// what cannot; the notices of late frames tell the truth.

/// Element-steps that a time step of one element counts as where hair meets bodies or the scalp:
/// distances, forces and friction at several points of it, of wavy hair, which has most
/// (`tests/bench/run contact`), and some finer steps where it turns fast (head::kFinest).
inline constexpr int kContactSteps = 8;
/// What it counts as on top for every group of bodies that moves on its own beyond the first, and
/// for every body beyond the first of a group: measured with up to 62 capsules near all hair.
inline constexpr double kGroupSteps = 0.5;
inline constexpr double kBodySteps = 0.15;
/// What it counts as on top for every guide of a groom whose wisps meet, as each meets more of the
/// others where there are more; and the most of it, as none meets more than so many (likewise, 50
/// to 5000 guides: the most is two to three times what hair that walks takes, a third of what hair
/// takes that is shaken hard).
inline constexpr double kWispSteps = 0.7;
inline constexpr double kMostWispSteps = 150;
/// What a segment of a beam counts as: a seventh to a fifth of an element's time, as measured side
/// by side with AVX-512, in hundreds and in thousands of guides.
inline constexpr double kBeamSteps = 0.2;
/// Element-steps that the diagnostics of one element count as, as measured against AVX-512's
/// (`tests/bench/run rod`); they take some 430 ns.
inline constexpr int kDiagnosticsSteps = 16;
/// Element-steps that any frame counts as, however small: its task, message and system calls.
inline constexpr double kFrameSteps = 2000;
/// Element-steps that one point of a frame counts as, or one element in generalized coordinates.
inline constexpr double kPointSteps = 0.5;

/// Element-steps of one frame in lockstep or of a bake: half a second of work with vector kernels,
/// seconds at most. Hair that turns fast among bodies takes up to seven times that, as blocks step
/// up to head::kFinest times finer; where wisps meet, up to twice that again in frames that come
/// unexpectedly (head::kFinestOfWisps).
inline constexpr double kMaxFrameWork = 1e7;
/// Bytes of what one head's hair remembers (HeadBytes).
inline constexpr size_t kMaxStateBytes = size_t{512} << 20;
/// Bytes of one frame.
inline constexpr size_t kMaxFrameBytes = 16 << 20;
/// Bytes of frames that one head may have waiting or under way.
inline constexpr size_t kMaxBacklogBytes = 32 << 20;

/// Element-steps of `steps` time steps of all guides.
[[nodiscard]] double StepWork(const groom::Groom& groom, int steps,
                              const head::ModelOptions& model = {});

/// Bytes of what the hair of a head of `options` remembers (head::StateBytes), with its beams
/// (head::BeamBytes) where it is or may be shed to some, as though no other head shared them.
[[nodiscard]] size_t HeadBytes(const groom::Groom& groom, const HeadOptions& options);

/// kResourceExhausted when a frame of `view` is larger than kMaxFrameBytes; the error names
/// `field`'s points_per_guide, `field` being empty or ending in a dot.
Result<void> AdmitView(const groom::Groom& groom, const head::View& view, const std::string& field);

/// kResourceExhausted naming `field` when the hair of a head remembers more than kMaxStateBytes.
Result<void> AdmitState(const groom::Groom& groom, const std::string& field);

/// kResourceExhausted when a head remembers too much, a frame of `options` is too large, or even
/// its shortest one too much work.
Result<void> AdmitHead(const groom::Groom& groom, const HeadOptions& options);

/// Frames that a head may have waiting or under way: `most`, or the fewer that kMaxBacklogBytes
/// hold, but at least one.
[[nodiscard]] int FrameWindow(const groom::Groom& groom, const head::View& view, int most);

/// kResourceExhausted naming `pose.time_s` when `movement` is too much work for one frame.
Result<void> AdmitFrame(const groom::Groom& groom, const head::Movement& movement,
                        const head::ModelOptions& model = {});

/// The same for the movement that leads to frame `frame` of a bake: names `substeps` where fewer
/// would do, `motion.times_s[frame]` where shorter ways from pose to pose would, else `groom`.
Result<void> AdmitBakedFrame(const groom::Groom& groom, const head::Movement& movement, int frame,
                             const head::ModelOptions& model = {});

/// Element-steps a second of a real-time head, its frames included; 0 in lockstep.
[[nodiscard]] double RealtimeLoad(const groom::Groom& groom, const HeadOptions& options);

}  // namespace mane::session
