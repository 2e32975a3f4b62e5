#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "groom/import.h"
#include "mane/v1/style.pb.h"
#include "styling/hairstyle.h"

namespace mane::rpc {

/// What a style makes of a head, before its guides are fitted.
struct StyledHair {
  std::vector<groom::ImportedStrand> guides;
  std::span<const uint32_t> first_member;  ///< Of each guide, and the total, (guides + 1).
  const styling::Members* members = nullptr;
  std::span<const styling::Hsv> colours;  ///< (members)
  v1::StyleReport report;                 ///< But what guides took, and the groom's name.
  std::shared_ptr<const void> owner;      ///< Of what the views see.
};

}  // namespace mane::rpc
