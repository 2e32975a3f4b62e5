// Properties of MakeBody and ValidateBodies: every bad input is refused, and the error names the
// field and the value; limits are RESOURCE_EXHAUSTED; orientations come out of norm one.

#include "groom/validate_body.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>
#include <limits>
#include <ostream>
#include <string>

#include "groom/material.h"

namespace mane::groom {
namespace {

using ::testing::HasSubstr;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

Body Ball(const std::string& name = "hat") {
  Body body;
  body.name = name;
  body.shape = Body::Ellipsoid{{0.1, 0.12, 0.1}};
  return body;
}

Body Arm() {
  Body body = Ball("arm_l-1");
  body.shape = Body::Capsule{{0, 0, 0}, {0, -0.3, 0}, 0.04};
  return body;
}

Body MeshBody(const std::string& name, size_t vertices, size_t triangles) {
  Body body = Ball(name);
  Body::Mesh mesh{std::vector<Eigen::Vector3f>(vertices),
                  std::vector<std::array<uint32_t, 3>>(triangles)};
  body.shape = std::make_shared<const Body::Mesh>(std::move(mesh));
  return body;
}

Body::Ellipsoid& Ellipse(Body& b) { return std::get<Body::Ellipsoid>(b.shape); }
Body::Capsule& Segment(Body& b) { return std::get<Body::Capsule>(b.shape); }

// One thing wrong, the field that must be named and a part of the message.
struct BadBody {
  const char* name;
  Body good;
  std::function<void(Body&)> spoil;
  std::string field;
  std::string says;
  friend void PrintTo(const BadBody& bad, std::ostream* out) { *out << bad.name; }
};

class BadBodyTest : public ::testing::TestWithParam<BadBody> {};

TEST_P(BadBodyTest, IsRefusedByName) {
  Body body = GetParam().good;
  ASSERT_TRUE(MakeBody(body, 7));
  GetParam().spoil(body);
  const auto made = MakeBody(body, 7);
  ASSERT_FALSE(made);
  EXPECT_EQ(made.error().code, ErrorCode::kInvalidArgument);
  EXPECT_EQ(made.error().field, "bodies[7]." + GetParam().field);
  EXPECT_THAT(made.error().message, HasSubstr(GetParam().field));
  EXPECT_THAT(made.error().message, HasSubstr(GetParam().says));
}

INSTANTIATE_TEST_SUITE_P(
    Table, BadBodyTest,
    ::testing::Values(
        BadBody{"NoName", Ball(), [](Body& b) { b.name = ""; }, "name", "\"\""},
        BadBody{"LongName", Ball(), [](Body& b) { b.name.assign(64, 'a'); }, "name", "63"},
        BadBody{"CapitalName", Ball(), [](Body& b) { b.name = "Hat"; }, "name", "Hat"},
        BadBody{"NameEndsInDash", Ball(), [](Body& b) { b.name = "hat-"; }, "name", "hat-"},
        BadBody{"NameWithSlash", Ball(), [](Body& b) { b.name = "a/b"; }, "name", "a/b"},
        BadBody{"NoRadius", Ball(), [](Body& b) { Ellipse(b).radii.y() = 0; },
                "ellipsoid.radii_m.y", "is 0; it must lie in [0.0001, 100] m"},
        BadBody{"NanRadius", Ball(), [](Body& b) { Ellipse(b).radii.z() = kNan; },
                "ellipsoid.radii_m.z", "nan"},
        BadBody{"HugeRadius", Ball(), [](Body& b) { Ellipse(b).radii.x() = 101; },
                "ellipsoid.radii_m.x", "101"},
        BadBody{"Needle", Ball(), [](Body& b) { Ellipse(b).radii.x() = 1e-3; }, "ellipsoid.radii_m",
                "at most 100 times"},
        BadBody{"NanEnd", Arm(), [](Body& b) { Segment(b).a.x() = kNan; }, "capsule.a.x", "nan"},
        BadBody{"FarEnd", Arm(), [](Body& b) { Segment(b).b.z() = 1001; }, "capsule.b.z", "1001"},
        BadBody{"FlatCapsule", Arm(), [](Body& b) { Segment(b).radius = 0; }, "capsule.radius_m",
                "is 0;"},
        BadBody{"InfiniteCapsule", Arm(), [](Body& b) { Segment(b).radius = kInfinity; },
                "capsule.radius_m", "inf"},
        BadBody{"NegativeFriction", Ball(), [](Body& b) { b.friction.coefficient = -0.1; },
                "friction", "[0, 10]"},
        BadBody{"NanFriction", Ball(), [](Body& b) { b.friction.coefficient = kNan; }, "friction",
                "nan"},
        BadBody{"LargeAnisotropy", Ball(), [](Body& b) { b.friction.anisotropy = 1.1; },
                "friction_anisotropy", "[0, 1]"},
        BadBody{"NanPosition", Ball(), [](Body& b) { b.pose.p.y() = kNan; }, "pose.position.y",
                "nan"},
        BadBody{"LongOrientation", Ball(), [](Body& b) { b.pose.q.w() = 1.5; }, "pose.orientation",
                "1.5"}),
    [](const auto& bad) { return bad.param.name; });

TEST(MakeBody, NormalisesOrientations) {
  Body body = Arm();
  body.pose.q.coeffs() *= 1.005;
  EXPECT_NEAR(MakeBody(body, 0)->pose.q.norm(), 1, 1e-15);
}

TEST(ValidateBodies, NamesAreUnique) {
  const std::vector<Body> bodies{Ball("a"), Arm(), Ball("a")};
  const auto valid = ValidateBodies(bodies, {}, std::monostate(), {});
  ASSERT_FALSE(valid);
  EXPECT_EQ(valid.error().code, ErrorCode::kInvalidArgument);
  EXPECT_EQ(valid.error().field, "bodies[2].name");
}

TEST(ValidateBodies, SizesAreLimited) {
  Limits limits;
  const auto refused = [&](const std::vector<Body>& bodies) {
    const auto valid = ValidateBodies(bodies, {}, std::monostate(), limits);
    EXPECT_FALSE(valid);
    EXPECT_EQ(valid.error().code, ErrorCode::kResourceExhausted);
    return valid.error().field;
  };
  limits.max_bodies = 2;
  EXPECT_EQ(refused({Ball("a"), Ball("b"), Ball("c")}), "bodies");
  limits.max_body_vertices = 7;
  limits.max_body_triangles = 4;
  EXPECT_TRUE(
      ValidateBodies(std::vector{MeshBody("a", 4, 4), MeshBody("b", 3, 0)}, {}, {}, limits));
  EXPECT_EQ(refused({MeshBody("a", 4, 4), MeshBody("b", 4, 0)}), "bodies[1].mesh.vertices");
  EXPECT_EQ(refused({MeshBody("a", 4, 4), MeshBody("b", 3, 1)}), "bodies[1].mesh.triangles");
}

TEST(ValidateBodies, HairThatMeetsTheScalpNeedsOne) {
  const auto refused = [](const Friction& friction, const Scalp& scalp) {
    const auto valid = ValidateBodies({}, friction, scalp, {});
    EXPECT_FALSE(valid);
    return valid.error().field;
  };
  const Ellipsoid head{{0, 0, 0}, {0.08, 0.11, 0.1}};
  EXPECT_TRUE(ValidateBodies({}, Friction(), head, {}));
  EXPECT_EQ(refused({}, std::monostate()), "header.scalp_contact");
  EXPECT_EQ(refused({11, 0}, head), "header.scalp_contact.friction");
  EXPECT_EQ(refused({0.3, kNan}, head), "header.scalp_contact.friction_anisotropy");
  EXPECT_EQ(refused({}, Ellipsoid{{0, 0, 0}, {0.001, 0.11, 0.1}}), "header.ellipsoid.radii_m");
}

TEST(FrictionOf, EveryMaterialIsInRange) {
  for (int i = 0; i <= static_cast<int>(Material::kPolished); ++i) {
    EXPECT_TRUE(ValidateFriction("", FrictionOf(static_cast<Material>(i)))) << i;
  }
  EXPECT_GT(FrictionOf(Material::kWool).coefficient, FrictionOf(Material::kSilk).coefficient);
}

}  // namespace
}  // namespace mane::groom
