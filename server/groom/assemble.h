#pragma once

#include <Eigen/Core>

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "base/result.h"
#include "exec/worker_pool.h"
#include "groom/groom.h"
#include "groom/limits.h"

namespace mane::groom {

/// What a groom is made of.
struct Parts {
  std::string display_name;  ///< At most 200 bytes.
  HairType hair_type = HairType::kCustom;
  uint64_t seed = 0;
  Scalp scalp;
  std::vector<Guide> guides;  ///< Made by MakeGuide or Generate.
  std::vector<Body> bodies;   ///< Made by MakeBody.
  std::optional<Friction> scalp_friction;
  std::shared_ptr<const Hairs> hairs;  ///< Null, or without any, for none.
  /// Groom::rest as an earlier Assemble of the same guides found it, (coordinates of all guides);
  /// empty to solve it.
  std::vector<double> rest;
};

/// Builds the immutable groom: counts elements and, unless `parts` has it, finds the rest shape of
/// every guide by rod::SolveRestShape from its natural shape, under (0, -9.81, 0) m/s^2 and with
/// the clamp at the guide's root.
///
/// @param pool  shares out the guides; null solves on the calling thread. The bits do not depend on
///              it.
/// @return RESOURCE_EXHAUSTED above `limits`; INVALID_ARGUMENT naming `guides` when there is none,
///         `header.display_name`, a field of the scalp (ValidateScalp), of what hair meets
///         (ValidateBodies) or of hairs (ValidateHairs), or `rest` when it does not fit the guides
///         or is not finite.
///
/// A guide for which the search stops short of equilibrium keeps the shape of least energy that it
/// found: they are where a head starts, and the motion settles from there.
[[nodiscard]] Result<std::shared_ptr<const Groom>> Assemble(Parts parts, const Limits& limits,
                                                            exec::WorkerPool* pool);

}  // namespace mane::groom
