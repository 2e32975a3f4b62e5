#pragma once

#include <memory>

#include "groom/groom.h"
#include "head/bodies.h"

namespace mane::session {

/// What heads animate, shared by all heads of a groom.
struct Asset {
  std::shared_ptr<const groom::Groom> groom;
  std::shared_ptr<const head::Bodies> bodies = nullptr;  ///< Of the groom; null for none.
};

}  // namespace mane::session
