// Properties of the digest: equal content gives equal digests, whatever the copy and the rest
// shape; any single change of the content gives another one.

#include "groom/digest.h"

#include <gtest/gtest.h>

#include <functional>
#include <set>

#include "groom/validate.h"

namespace mane::groom {
namespace {

Groom MakeGroom() {
  GuideDescription d;
  d.length_m = 0.2;
  d.element_count = 3;
  d.radius_1_m = d.radius_2_m = 50e-6;
  d.young_modulus_pa = 1e9;
  d.poisson_ratio = 0.48;
  d.density_kg_m3 = 1300;
  Groom groom;
  groom.display_name = "name";
  groom.scalp = TriangleMesh{{{0, 0, 0}, {1, 0, 0}, {0, 0, 1}}, {{0, 2, 1}}, {0}};
  groom.guides = {*MakeGuide(d, 0), *MakeGuide(d, 1)};
  return groom;
}

TEST(DigestTest, IsThirtyTwoHexadecimalDigitsOfTheContentOnly) {
  const Groom groom = MakeGroom();
  Groom copy = MakeGroom();
  copy.rest.assign(18, 1);
  copy.first_element = {0, 3, 6};
  copy.first_coordinate = {0, 9, 18};
  EXPECT_EQ(Digest(groom), Digest(copy));
  EXPECT_EQ(Digest(groom).size(), 32u);
  EXPECT_EQ(Digest(groom).find_first_not_of("0123456789abcdef"), std::string::npos);
}

Body Ball() { return {"hat", Body::Ellipsoid{{1, 1, 1}}, {}, false, {}}; }

std::shared_ptr<const Body::Mesh> MeshOf(const Body::Mesh& mesh) {
  return std::make_shared<const Body::Mesh>(mesh);
}

TEST(DigestTest, OfAGroomWhoseHairMeetsNothingIsThatOfEarlierReleases) {
  EXPECT_EQ(Digest(MakeGroom()), "7f4aa6eecbebb095f59b8db48c51a33e");
}

TEST(DigestTest, ChangesWithEveryField) {
  const auto mesh = [](Groom& g) -> TriangleMesh& { return std::get<TriangleMesh>(g.scalp); };
  const std::function<void(Groom&)> changes[] = {
      [](Groom&) {},
      [](Groom& g) { g.display_name = "mane"; },
      [](Groom& g) { g.hair_type = HairType::kAfricanFuzzy; },
      [](Groom& g) { g.seed = 1; },
      [](Groom& g) {
        g.guides[1].strand.natural.assign(g.guides[1].strand.elements(), {1, 2, 0});
        g.guides[1].wound = rod::MakeWound(g.guides[1].strand);
      },
      [](Groom& g) {
        g.guides[1].strand.natural.assign(g.guides[1].strand.elements(), {1, 2, 0});
      },
      [](Groom& g) { g.scalp = std::monostate(); },
      [](Groom& g) { g.scalp = Ellipsoid(); },
      [](Groom& g) {
        g.scalp = Ellipsoid{{1, 0, 0}, {1, 1, 1}};
      },
      [](Groom& g) {
        g.scalp = Ellipsoid{{0, 0, 0}, {1, 2, 1}};
      },
      [](Groom& g) {
        g.scalp = Ellipsoid{{0, 0, 0}, {1, 1, 1}, {1, 0, 0}};
      },
      [](Groom& g) {
        g.scalp = Ellipsoid{{0, 0, 0}, {1, 1, 1}, {0, 1, 0}, 1};
      },
      [&](Groom& g) { mesh(g).vertices[1].x() = 2; },
      [&](Groom& g) {
        mesh(g).triangles[0] = {0, 1, 2};
      },
      [&](Groom& g) { mesh(g).hair_triangles.clear(); },
      [](Groom& g) { g.guides.pop_back(); },
      [](Groom& g) { g.guides[1].root.p.z() = 1e-300; },
      [](Groom& g) { g.guides[1].root.q = Eigen::Quaterniond(0, 1, 0, 0); },
      [](Groom& g) { g.guides[0].section.radius_1 *= 1 + 1e-15; },
      [](Groom& g) { g.guides[0].section.radius_2 *= 2; },
      [](Groom& g) { g.guides[0].material.young_modulus *= 2; },
      [](Groom& g) { g.guides[0].material.poisson_ratio = 0.3; },
      [](Groom& g) { g.guides[0].material.density = 1; },
      [](Groom& g) { g.guides[0].strand.length[2] *= 2; },
      [](Groom& g) { g.guides[0].strand.natural[2].x() = 1; },
      [](Groom& g) { g.guides[0].strand.internal_friction = 1; },
      [](Groom& g) { g.guides[0].strand.air_drag = 1; },
      [](Groom& g) { g.guides[0].wisp_radius = 0.01; },
      [](Groom& g) { g.guides[1].wisp_radius = 0.01; },
      [](Groom& g) { g.scalp_friction = Friction(); },
      [](Groom& g) {
        g.scalp_friction = Friction{0.3, 0};
      },
      [](Groom& g) { g.bodies = {Ball()}; },
      [](Groom& g) {
        g.bodies = {Ball(), Ball()};
      },
      [](Groom& g) { (g.bodies = {Ball()})[0].name = "cap"; },
      [](Groom& g) { (g.bodies = {Ball()})[0].friction.coefficient = 0.4; },
      [](Groom& g) { (g.bodies = {Ball()})[0].friction.anisotropy = 0; },
      [](Groom& g) { (g.bodies = {Ball()})[0].moving = true; },
      [](Groom& g) { (g.bodies = {Ball()})[0].pose.p.x() = 1; },
      [](Groom& g) { (g.bodies = {Ball()})[0].pose.q = Eigen::Quaterniond(0, 1, 0, 0); },
      [](Groom& g) {
        (g.bodies = {Ball()})[0].shape = Body::Ellipsoid{{1, 1, 2}};
      },
      [](Groom& g) {
        (g.bodies = {Ball()})[0].shape = Body::Capsule{{1, 1, 1}, {0, 0, 0}, 1};
      },
      [](Groom& g) {
        (g.bodies = {Ball()})[0].shape = Body::Capsule{{1, 1, 1}, {0, 0, 0}, 2};
      },
      [](Groom& g) {
        (g.bodies = {Ball()})[0].shape = MeshOf({{{0, 0, 1}}, {}});
      },
      [](Groom& g) {
        (g.bodies = {Ball()})[0].shape = MeshOf({{{0, 0, 1}}, {{0, 0, 0}}});
      },
  };
  std::set<std::string> digests;
  for (const auto& change : changes) {
    Groom groom = MakeGroom();
    change(groom);
    digests.insert(Digest(groom));
  }
  EXPECT_EQ(digests.size(), std::size(changes));
}

}  // namespace
}  // namespace mane::groom
