#include "mane/hairs.h"

#include <fmt/format.h>

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cstddef>
#include <cstring>
#include <numeric>

#include "wire/assemble_hair.h"

namespace mane::inline client {
namespace {

constexpr std::size_t kMaxPoints = 256;  // Of a guide.
constexpr std::size_t kBlock = 64;       // Points of hairs.

Eigen::Quaternionf ToEigen(const Quaternion& q) {
  return Eigen::Quaterniond(q.w, q.x, q.y, q.z).normalized().cast<float>();
}

Result<void> Check(const GroomHairs& groom, std::span<const float> positions,
                   std::uint32_t points_per_guide, std::span<float> out) {
  const auto misfit = [](const char* field, std::size_t is, std::size_t expected) {
    return Error{ErrorCode::kInvalidArgument,
                 fmt::format("{} is of size {}; it must be {}", field, is, expected), field};
  };
  const Hairs& hairs = groom.hairs;
  if (points_per_guide < 2 || points_per_guide > kMaxPoints) {
    return Error{ErrorCode::kInvalidArgument,
                 fmt::format("points_per_guide is {}; it must be 2 to 256", points_per_guide),
                 "points_per_guide"};
  }
  const std::size_t numbers = 3 * groom.root_frames.size() * points_per_guide;
  if (positions.size() != numbers) return misfit("positions", positions.size(), numbers);
  const std::size_t points =
      std::accumulate(hairs.point_counts.begin(), hairs.point_counts.end(), std::size_t{0});
  if (hairs.guides.size() != hairs.point_counts.size() || hairs.places.size() != points ||
      std::ranges::any_of(hairs.guides, [&](auto g) { return g >= groom.root_frames.size(); })) {
    return Error{ErrorCode::kInvalidArgument, "the lists of hairs do not fit each other", "hairs"};
  }
  if (out.size() != 3 * points) return misfit("out", out.size(), 3 * points);
  return {};
}

// The points of hairs on one guide.
void Assemble(const wire::CarriedGuide& guide, std::span<const HairPlace> places, float unit,
              float* out) {
  static_assert(sizeof(HairPlace) == sizeof(wire::HairPlace));
  std::array<wire::HairPlace, kBlock> block;
  std::array<Eigen::Vector3f, kBlock> points;
  for (std::size_t begin = 0; begin < places.size(); begin += kBlock) {
    const std::size_t count = std::min(kBlock, places.size() - begin);
    std::memcpy(static_cast<void*>(block.data()), places.data() + begin, count * sizeof(HairPlace));
    wire::AssembleHair(guide, std::span(block).first(count), unit, std::span(points).first(count));
    std::memcpy(out + 3 * begin, points.data()->data(), 12 * count);
  }
}

}  // namespace

Result<void> AssembleHairs(const GroomHairs& groom, std::span<const float> positions,
                           std::uint32_t points_per_guide, const Quaternion& head_orientation,
                           std::span<float> out) {
  if (auto ok = Check(groom, positions, points_per_guide, out); !ok) return ok;
  const Hairs& hairs = groom.hairs;
  const Eigen::Quaternionf head = ToEigen(head_orientation);
  std::array<Eigen::Vector3f, kMaxPoints> points;
  std::array<Eigen::Quaternionf, kMaxPoints> frames;
  const wire::CarriedGuide carried{std::span(points).first(points_per_guide),
                                   std::span(frames).first(points_per_guide)};
  std::size_t place = 0;
  for (std::size_t hair = 0; hair < hairs.guides.size();) {
    const std::uint32_t guide = hairs.guides[hair];
    std::size_t count = 0;
    for (; hair < hairs.guides.size() && hairs.guides[hair] == guide; ++hair) {
      count += hairs.point_counts[hair];
    }
    std::memcpy(points.data()->data(), &positions[std::size_t{3} * guide * points_per_guide],
                std::size_t{12} * points_per_guide);
    wire::CarryFrames(head * ToEigen(groom.root_frames[guide]), carried.points,
                      std::span(frames).first(points_per_guide));
    Assemble(carried, std::span(hairs.places).subspan(place, count),
             static_cast<float>(hairs.offset_unit_m), out.data() + 3 * place);
    place += count;
  }
  return {};
}

}  // namespace mane::inline client
