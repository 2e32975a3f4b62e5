#pragma once

#include "groom/groom.h"
#include "rod/graded_lengths.h"
#include "rod/strand.h"

namespace mane::groom {

/// How near wound hair comes to the converged strand with the elements that ElementCountFor takes;
/// more of them bring it no nearer (coil.md).
inline constexpr double kWoundError = 0.02;

/// How far from the converged strand generated hair may be where the author does not say: 2 % of
/// its length.
inline constexpr double kDefaultErrorTarget = 0.02;
/// Elements that ElementCountFor chooses from. The upper bound keeps a head in real time.
inline constexpr int kFewestElements = 3, kMostElements = 20;

/// What decides the element lengths of a preset's guides of `length` [m] > 0.
[[nodiscard]] rod::Grading GradingOf(HairType type, double length, bool wound);

/// A preset's strand of N elements of GradedLengths, with the mean natural curvature.
[[nodiscard]] rod::Strand PresetStrand(HairType type, double length, int N);

/// Whether plain elements, kMostElements of them at most, follow the turns of a preset's hair of
/// `length` [m].
[[nodiscard]] bool IsResolved(HairType type, double length);

/// The fewest elements, from kFewestElements to kMostElements, with which the tip of a preset's
/// guide of `length` [m] > 0 is within `target` > 0, relative to its length, of where a converged
/// strand has it: the rms over root directions at rest, and over two seconds of a moderate shake of
/// the head (rod.md, Number of elements). kMostElements where they do not suffice, as for hair that
/// coils more than that resolves. Some ten milliseconds for curled hair. Wound hair takes 5, or 10
/// where it is long or less than kWoundError is asked for, which it does not reach.
[[nodiscard]] int ElementCountFor(HairType type, double length, double target, bool wound);

}  // namespace mane::groom
