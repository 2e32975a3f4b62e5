#include "groom/digest.h"

#include <fmt/format.h>
#include <xxhash.h>

#include <algorithm>
#include <bit>
#include <memory>
#include <string_view>
#include <type_traits>

#include "base/check.h"
#include "groom/hairs.h"

namespace mane::groom {
namespace {

static_assert(std::endian::native == std::endian::little);

class Hasher {
 public:
  Hasher() : state_(XXH3_createState(), XXH3_freeState) {
    MANE_CHECK(state_ != nullptr && XXH3_128bits_reset(state_.get()) == XXH_OK);
  }

  template <typename T>
  requires std::is_arithmetic_v<T>
  void Add(T value) { AddBytes(&value, sizeof value); }
  template <typename Scalar>
  void Add(const Eigen::Vector3<Scalar>& v) {
    AddBytes(v.data(), 3 * sizeof(Scalar));
  }
  // A list of numbers or of triples, which are dense in memory.
  template <typename List>
  void AddList(const List& list) {
    Add(uint64_t{list.size()});
    AddBytes(list.data(), list.size() * sizeof(typename List::value_type));
  }

  [[nodiscard]] std::string Hex() const {
    XXH128_canonical_t digest;
    XXH128_canonicalFromHash(&digest, XXH3_128bits_digest(state_.get()));
    std::string hex;
    for (const unsigned char byte : digest.digest) hex += fmt::format("{:02x}", byte);
    return hex;
  }

 private:
  void AddBytes(const void* bytes, size_t count) {
    MANE_CHECK(XXH3_128bits_update(state_.get(), bytes, count) == XXH_OK);
  }

  std::unique_ptr<XXH3_state_t, decltype(&XXH3_freeState)> state_;
};

void AddScalp(const Scalp& scalp, Hasher* hasher) {
  hasher->Add(uint32_t(scalp.index()));
  if (const auto* mesh = std::get_if<TriangleMesh>(&scalp)) {
    static_assert(sizeof(Eigen::Vector3f) == 12);
    hasher->AddList(mesh->vertices);
    hasher->AddList(mesh->triangles);
    hasher->AddList(mesh->hair_triangles);
  } else if (const auto* ellipsoid = std::get_if<Ellipsoid>(&scalp)) {
    hasher->Add(ellipsoid->center);
    hasher->Add(ellipsoid->radii);
    hasher->Add(ellipsoid->cap_axis);
    hasher->Add(ellipsoid->cap_angle);
  }
}

// Stiffness and linear density follow from the rest.
void AddGuide(const Guide& guide, Hasher* hasher) {
  static_assert(sizeof(Eigen::Vector3d) == 24);
  hasher->Add(guide.root.p);
  for (const double component : guide.root.q.coeffs()) hasher->Add(component);
  hasher->Add(guide.section.radius_1);
  hasher->Add(guide.section.radius_2);
  hasher->Add(guide.material.young_modulus);
  hasher->Add(guide.material.poisson_ratio);
  hasher->Add(guide.material.density);
  hasher->AddList(guide.strand.length);
  hasher->AddList(guide.strand.natural);
  if (guide.wound) hasher->Add(uint32_t{1});  // Nothing else, so that older grooms keep their etag.
  hasher->Add(guide.strand.internal_friction);
  hasher->Add(guide.strand.air_drag);
}

struct AddShape {
  Hasher* hasher;

  void operator()(const Body::Ellipsoid& ellipsoid) const { hasher->Add(ellipsoid.radii); }
  void operator()(const Body::Capsule& capsule) const {
    hasher->Add(capsule.a);
    hasher->Add(capsule.b);
    hasher->Add(capsule.radius);
  }
  void operator()(const std::shared_ptr<const Body::Mesh>& mesh) const {
    hasher->AddList(mesh->vertices);
    hasher->AddList(mesh->triangles);
  }
};

void AddFriction(const Friction& friction, Hasher* hasher) {
  hasher->Add(friction.coefficient);
  hasher->Add(friction.anisotropy);
}

void AddBody(const Body& body, Hasher* hasher) {
  hasher->AddList(body.name);
  hasher->Add(uint32_t(body.shape.index()));
  std::visit(AddShape{hasher}, body.shape);
  AddFriction(body.friction, hasher);
  hasher->Add(uint32_t{body.moving});
  hasher->Add(body.pose.p);
  for (const double component : body.pose.q.coeffs()) hasher->Add(component);
}

// What hair meets. Nothing where it meets nothing, so that older grooms keep their etag.
void AddContact(const Groom& groom, Hasher* hasher) {
  if (std::ranges::any_of(groom.guides, [](const Guide& g) { return g.wisp_radius != 0; })) {
    hasher->AddList(std::string_view("wisps"));
    for (const Guide& guide : groom.guides) hasher->Add(guide.wisp_radius);
  }
  if (groom.scalp_friction) {
    hasher->AddList(std::string_view("scalp"));
    AddFriction(*groom.scalp_friction, hasher);
  }
  if (groom.bodies.empty()) return;
  hasher->AddList(std::string_view("bodies"));
  hasher->Add(uint64_t{groom.bodies.size()});
  for (const Body& body : groom.bodies) AddBody(body, hasher);
}

// Nothing where there are none, as above.
void AddHairs(const Groom& groom, Hasher* hasher) {
  if (groom.hairs == nullptr) return;
  static_assert(sizeof(wire::HairPlace) == 8 && sizeof(std::array<uint8_t, 3>) == 3);
  hasher->AddList(std::string_view("hairs"));
  hasher->Add(groom.hairs->offset_unit);
  hasher->AddList(groom.hairs->guides);
  hasher->AddList(groom.hairs->first_point);
  hasher->AddList(groom.hairs->places);
  hasher->AddList(groom.hairs->colours);
}

}  // namespace

std::string Digest(const Groom& groom) {
  Hasher hasher;
  hasher.AddList(groom.display_name);
  hasher.Add(static_cast<uint32_t>(groom.hair_type));
  hasher.Add(groom.seed);
  AddScalp(groom.scalp, &hasher);
  hasher.Add(uint64_t{groom.guides.size()});
  for (const Guide& guide : groom.guides) AddGuide(guide, &hasher);
  AddContact(groom, &hasher);
  AddHairs(groom, &hasher);
  return hasher.Hex();
}

}  // namespace mane::groom
