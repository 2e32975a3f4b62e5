// Properties of ValidateScalp: every bad mesh or ellipsoid is refused, the error naming the field;
// limits are RESOURCE_EXHAUSTED; good scalps and none at all are accepted.

#include <gtest/gtest.h>

#include <functional>
#include <limits>
#include <ostream>
#include <string>

#include "groom/validate.h"

namespace mane::groom {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

// A unit square in the plane y = 0, as two triangles.
TriangleMesh Square() {
  return {{{0, 0, 0}, {1, 0, 0}, {1, 0, 1}, {0, 0, 1}}, {{0, 2, 1}, {0, 3, 2}}, {}};
}

struct BadMesh {
  const char* name;
  std::function<void(TriangleMesh&)> spoil;
  const char* field;
  friend void PrintTo(const BadMesh& bad, std::ostream* out) { *out << bad.name; }
};

class BadMeshTest : public ::testing::TestWithParam<BadMesh> {};

TEST_P(BadMeshTest, IsRefusedByName) {
  TriangleMesh mesh = Square();
  ASSERT_TRUE(ValidateScalp(mesh, {}));
  GetParam().spoil(mesh);
  const auto valid = ValidateScalp(mesh, {});
  ASSERT_FALSE(valid);
  EXPECT_EQ(valid.error().code, ErrorCode::kInvalidArgument);
  EXPECT_EQ(valid.error().field, GetParam().field);
  EXPECT_NE(valid.error().message, "");
}

using M = TriangleMesh;

INSTANTIATE_TEST_SUITE_P(
    Table, BadMeshTest,
    ::testing::Values(
        BadMesh{"NanVertex", [](M& m) { m.vertices[2].y() = float(kNan); },
                "scalp_mesh.vertices[2].y"},
        BadMesh{"InfiniteVertex",
                [](M& m) { m.vertices[3].x() = std::numeric_limits<float>::infinity(); },
                "scalp_mesh.vertices[3].x"},
        BadMesh{"FarVertex", [](M& m) { m.vertices[0].z() = 3e6f; }, "scalp_mesh.vertices[0].z"},
        BadMesh{"IndexOutOfRange", [](M& m) { m.triangles[1][2] = 4; }, "scalp_mesh.triangles[1]"},
        BadMesh{"HugeIndex", [](M& m) { m.triangles[0][0] = 0xffffffff; },
                "scalp_mesh.triangles[0]"},
        BadMesh{"NoTriangles", [](M& m) { m.triangles.clear(); }, "scalp_mesh.triangles"},
        BadMesh{"Nothing", [](M& m) { m = {}; }, "scalp_mesh.triangles"},
        BadMesh{"HairTriangleOutOfRange",
                [](M& m) {
                  m.hair_triangles = {0, 2};
                },
                "scalp_mesh.hair_triangles[1]"},
        BadMesh{"HairTriangleTwice",
                [](M& m) {
                  m.hair_triangles = {1, 0, 1};
                },
                "scalp_mesh.hair_triangles[2]"},
        BadMesh{"NoArea",
                [](M& m) {
                  for (auto& v : m.vertices) v.z() = v.x();
                },
                "scalp_mesh.triangles"},
        BadMesh{"NoHairArea",
                [](M& m) {
                  m.triangles[1] = {1, 1, 2};
                  m.hair_triangles = {1};
                },
                "scalp_mesh.hair_triangles"}),
    [](const auto& bad) { return bad.param.name; });

TEST(ValidateScalp, LimitsTheSizeOfMeshes) {
  Limits limits;
  limits.max_vertices = 3;
  auto valid = ValidateScalp(Square(), limits);
  ASSERT_FALSE(valid);
  EXPECT_EQ(valid.error().code, ErrorCode::kResourceExhausted);
  EXPECT_EQ(valid.error().field, "scalp_mesh.vertices");
  limits = {};
  limits.max_triangles = 1;
  valid = ValidateScalp(Square(), limits);
  ASSERT_FALSE(valid);
  EXPECT_EQ(valid.error().code, ErrorCode::kResourceExhausted);
  EXPECT_EQ(valid.error().field, "scalp_mesh.triangles");
}

TEST(ValidateScalp, AcceptsNoScalp) { EXPECT_TRUE(ValidateScalp(std::monostate(), {})); }

struct BadEllipsoid {
  const char* name;
  std::function<void(Ellipsoid&)> spoil;
  const char* field;
  friend void PrintTo(const BadEllipsoid& bad, std::ostream* out) { *out << bad.name; }
};

class BadEllipsoidTest : public ::testing::TestWithParam<BadEllipsoid> {};

TEST_P(BadEllipsoidTest, IsRefusedByName) {
  Ellipsoid ellipsoid{{0, 0, 0}, {0.08, 0.11, 0.1}, {0, 1, 0}, 1.2};
  ASSERT_TRUE(ValidateScalp(ellipsoid, {}));
  GetParam().spoil(ellipsoid);
  const auto valid = ValidateScalp(ellipsoid, {});
  ASSERT_FALSE(valid);
  EXPECT_EQ(valid.error().code, ErrorCode::kInvalidArgument);
  EXPECT_EQ(valid.error().field, std::string("header.ellipsoid.") + GetParam().field);
}

using E = Ellipsoid;

INSTANTIATE_TEST_SUITE_P(
    Table, BadEllipsoidTest,
    ::testing::Values(BadEllipsoid{"NanCenter", [](E& e) { e.center.x() = kNan; }, "center.x"},
                      BadEllipsoid{"ZeroRadius", [](E& e) { e.radii.y() = 0; }, "radii_m.y"},
                      BadEllipsoid{"NegativeRadius", [](E& e) { e.radii.z() = -0.1; }, "radii_m.z"},
                      BadEllipsoid{"HugeRadius", [](E& e) { e.radii.x() = 11; }, "radii_m.x"},
                      BadEllipsoid{"NanRadius", [](E& e) { e.radii.x() = kNan; }, "radii_m.x"},
                      BadEllipsoid{"ZeroAxis", [](E& e) { e.cap_axis.setZero(); }, "cap_axis"},
                      BadEllipsoid{"NanAxis", [](E& e) { e.cap_axis.y() = kNan; }, "cap_axis"},
                      BadEllipsoid{"ZeroAngle", [](E& e) { e.cap_angle = 0; }, "cap_angle"},
                      BadEllipsoid{"LargeAngle", [](E& e) { e.cap_angle = 3.2; }, "cap_angle"},
                      BadEllipsoid{"NanAngle", [](E& e) { e.cap_angle = kNan; }, "cap_angle"},
                      BadEllipsoid{"VanishingCap", [](E& e) { e.cap_angle = 1e-8; }, "cap_angle"}),
    [](const auto& bad) { return bad.param.name; });

}  // namespace
}  // namespace mane::groom
