#pragma once

/// What the parts of the benchmark of beams share.

#include <cmath>
#include <string>
#include <vector>

#include "beam/style.h"
#include "exec/worker_pool.h"

namespace mane {

/// A part of the report: a name and a number as JSON, to be joined by commas.
using Report = std::vector<std::string>;

/// Pieces of a loop on a pool.
inline beam::Loop LoopOn(exec::WorkerPool& pool) {
  return [&pool](int count, const std::function<void(int, int)>& work) {
    pool.ParallelFor(count, 16, work);
  };
}

/// The power of a number's growth by which a time grows.
inline double Exponent(double ratio, double times) { return std::log(ratio) / std::log(times); }

/// Times styling: appends "style_20k_ms" to `numbers` and exponents over hairs and segments to
/// `exponents`.
void TimeStyling(Report* numbers, Report* exponents);

}  // namespace mane
