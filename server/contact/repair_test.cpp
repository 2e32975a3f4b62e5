// What is done about meshes that are not as they should be: mended and reported, or refused with
// an error that says which field, which number and which range.

#include "contact/repair.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "contact/boundary.h"
#include "contact/test_meshes.h"
#include "contact/winding.h"

namespace mane::contact {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3f;

class RepairTest : public ::testing::Test {
 protected:
  SolidMesh Mend(const TriangleMesh& mesh) {
    auto solid = Repair(mesh, {}, &report_);
    EXPECT_TRUE(solid) << (solid ? "" : solid.error().message);
    return solid ? *solid : SolidMesh{};
  }
  Error Refuse(const TriangleMesh& mesh, const MeshLimits& limits = {}) {
    auto solid = Repair(mesh, limits, &report_);
    EXPECT_FALSE(solid);
    return solid ? Error{} : solid.error();
  }
  // The winding number is an integer all over: nothing is open.
  static void ExpectClosed(const SolidMesh& solid) {
    EXPECT_TRUE(BoundaryLoops(solid.triangles).empty());
  }

  MeshReport report_;
  const TriangleMesh ball_ = fixtures::Sphere(3, 0.1);
};

TEST_F(RepairTest, LeavesAGoodMeshAsItIs) {
  const SolidMesh solid = Mend(ball_);
  EXPECT_EQ(solid.vertices.size(), ball_.vertices.size());
  EXPECT_EQ(solid.triangles, ball_.triangles);
  EXPECT_EQ(report_.vertices, 642);
  EXPECT_EQ(report_.triangles, 1280);
  EXPECT_EQ(report_.welded_vertices + report_.degenerate_triangles + report_.duplicate_triangles +
                report_.holes + report_.inverted,
            0);
  EXPECT_NEAR(report_.surface_area, 4 * std::numbers::pi * 0.01, 1e-3);
  EXPECT_NEAR(report_.volume, 4 / 3. * std::numbers::pi * 0.001, 1e-4);
}

TEST_F(RepairTest, WeldsVerticesThatAreDoubled) {
  const TriangleMesh box = fixtures::Box({0, 0, 0}, {1, 2, 3}, 4);
  EXPECT_EQ(box.vertices.size(), 6 * 25U);
  const SolidMesh solid = Mend(box);
  EXPECT_EQ(solid.vertices.size(), 98U);  // 6 * 9 within sides, 12 * 3 on edges, 8 corners.
  EXPECT_EQ(report_.welded_vertices, 6 * 25 - 98);
  EXPECT_EQ(report_.holes, 0);
  EXPECT_NEAR(report_.volume, 6, 1e-9);

  TriangleMesh soup;  // Every triangle with vertices of its own, moved by a rounding error.
  for (const Triangle& t : ball_.triangles) {
    const auto first = static_cast<uint32_t>(soup.vertices.size());
    for (const uint32_t v : t) soup.vertices.push_back(ball_.vertices[v] * (1 + 1e-7F * (v % 2)));
    soup.triangles.push_back({first, first + 1, first + 2});
  }
  EXPECT_EQ(Mend(soup).vertices.size(), ball_.vertices.size());
  EXPECT_EQ(report_.holes, 0);
}

TEST_F(RepairTest, VerticesOfNoTriangleCountForNothing) {
  const SolidMesh plain = Mend(ball_);
  const auto close = static_cast<uint32_t>(ball_.vertices.size());
  TriangleMesh mesh = ball_;  // And two vertices 2e-6 of the extent apart, which stay two.
  mesh.vertices.push_back(ball_.vertices[5] * (1 + 4e-6F));
  for (Triangle& t : mesh.triangles) {
    if (t[0] == 5) t[0] = close;
  }
  const size_t apart = Mend(mesh).vertices.size();
  for (const Vector3f& stray : {Vector3f(300, 0, 0), Vector3f(0, -1e30F, 0),
                                Vector3f(0, 0, std::numeric_limits<float>::quiet_NaN())}) {
    TriangleMesh other = mesh;
    other.vertices.push_back(stray);
    EXPECT_EQ(Mend(other).vertices.size(), apart);
  }
  TriangleMesh far = ball_;
  far.vertices.push_back({300, 0, 0});
  EXPECT_EQ(Mend(far).vertices, plain.vertices);
  far.triangles[0][0] = close;
  EXPECT_EQ(Refuse(far).field, "vertices");
}

TEST_F(RepairTest, DropsTrianglesWithoutAreaAndDuplicates) {
  TriangleMesh mesh = ball_;
  mesh.triangles.push_back({5, 5, 7});
  mesh.vertices.push_back((ball_.vertices[0] + ball_.vertices[12]) / 2);
  mesh.triangles.push_back({0, 12, static_cast<uint32_t>(mesh.vertices.size() - 1)});
  mesh.triangles.push_back(ball_.triangles[10]);
  mesh.triangles.push_back(ball_.triangles[10]);
  const Triangle& t = ball_.triangles[20];
  mesh.triangles.push_back({t[1], t[2], t[0]});
  mesh.triangles.push_back({40, 500, 300});  // A sheet of two sides.
  mesh.triangles.push_back({500, 40, 300});
  const SolidMesh solid = Mend(mesh);
  EXPECT_EQ(report_.degenerate_triangles, 2);
  EXPECT_EQ(report_.duplicate_triangles, 5);
  EXPECT_EQ(solid.triangles.size(), ball_.triangles.size());
  ExpectClosed(solid);
}

TEST_F(RepairTest, TurnsAMeshThatFacesInwards) {
  const SolidMesh solid = Mend(fixtures::Inverted(ball_));
  EXPECT_TRUE(report_.inverted);
  EXPECT_GT(report_.volume, 0);
  EXPECT_EQ(WindingTree(solid).Inside(Vector3d::Zero()), true);
}

TEST_F(RepairTest, MendsSingleTrianglesThatFaceTheWrongWay) {
  TriangleMesh mesh = ball_;
  for (const int t : {3, 600, 1200}) std::swap(mesh.triangles[t][1], mesh.triangles[t][2]);
  const SolidMesh solid = Mend(mesh);
  ExpectClosed(solid);
  EXPECT_NEAR(WindingTree(solid).Number(Vector3d::Zero()), 1, 0.04);
  EXPECT_NEAR(WindingTree(solid).Number(Vector3d(0.2, 0, 0)), 0, 0.04);
}

TEST_F(RepairTest, ClosesSmallHoles) {
  const auto open =
      fixtures::Part(ball_, [](const Vector3f& c) { return c.y() < 0.09F && c.x() > -0.095F; });
  const SolidMesh solid = Mend(open);
  ExpectClosed(solid);
  EXPECT_EQ(report_.holes, 2);
  EXPECT_GT(report_.hole_area, 0);
  EXPECT_LT(report_.hole_area, 0.2 * report_.surface_area);
  const WindingTree winding(solid);
  for (const double y : {-0.08, 0.0, 0.08}) EXPECT_NEAR(winding.Number({0, y, 0}), 1, 0.04) << y;
}

TEST_F(RepairTest, RefusesAHemisphereWithNumbers) {
  const Error error = Refuse(fixtures::Part(ball_, [](const Vector3f& c) { return c.y() > 0; }));
  EXPECT_EQ(error.code, ErrorCode::kInvalidArgument);
  EXPECT_EQ(error.field, "triangles");
  EXPECT_NEAR(report_.hole_area / report_.surface_area, 0.5, 0.1);
  EXPECT_NE(error.message.find("1 holes"), std::string::npos) << error.message;
  EXPECT_NE(error.message.find("[0, 0.2]"), std::string::npos) << error.message;
}

TEST_F(RepairTest, RefusesAMeshThatFacesBothWays) {
  TriangleMesh mesh = ball_;
  for (size_t t = 0; t < mesh.triangles.size(); t += 2) {
    std::swap(mesh.triangles[t][1], mesh.triangles[t][2]);
  }
  EXPECT_NE(Refuse(mesh).message.find("both ways"), std::string::npos);
}

TEST_F(RepairTest, RefusesWhatIsEmptyOrNoSolid) {
  EXPECT_EQ(Refuse({}).field, "vertices");
  EXPECT_EQ(Refuse({ball_.vertices, {}}).field, "triangles");
  EXPECT_EQ(Refuse({ball_.vertices, {{1, 1, 2}}}).field, "triangles");
  TriangleMesh sheet{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}, {0, 2, 1}}};
  EXPECT_NE(Refuse(sheet).message.find("back to back"), std::string::npos);
  const TriangleMesh plate = fixtures::Box({0, 0, 0}, {1, 1, 2e-6});
  EXPECT_NE(Refuse(plate).message.find("m^3"), std::string::npos);
}

TEST_F(RepairTest, RefusesNumbersOutOfRange) {
  for (const float bad :
       {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity(), 1001.0F}) {
    TriangleMesh mesh = ball_;
    mesh.vertices[7].y() = bad;
    const Error error = Refuse(mesh);
    EXPECT_EQ(error.field, "vertices[7]");
    EXPECT_NE(error.message.find("1000"), std::string::npos) << error.message;
  }
  TriangleMesh mesh = ball_;
  mesh.triangles[9][2] = 642;
  EXPECT_EQ(Refuse(mesh).field, "triangles[9]");
  const Error huge = Refuse(fixtures::Sphere(2, 51));
  EXPECT_EQ(huge.field, "vertices");
  EXPECT_NE(huge.message.find("(0, 100] m"), std::string::npos) << huge.message;
  const TriangleMesh point{std::vector<Vector3f>(3, Vector3f(1, 1, 1)), {{0, 1, 2}}};
  EXPECT_EQ(Refuse(point).field, "vertices");
}

TEST_F(RepairTest, RefusesMoreThanTheLimits) {
  MeshLimits limits;
  limits.max_vertices = 641;
  EXPECT_EQ(Refuse(ball_, limits).code, ErrorCode::kResourceExhausted);
  limits = {};
  limits.max_triangles = 1279;
  const Error error = Refuse(ball_, limits);
  EXPECT_EQ(error.code, ErrorCode::kResourceExhausted);
  EXPECT_EQ(error.field, "triangles");
  EXPECT_NE(error.message.find("1279"), std::string::npos) << error.message;
}

}  // namespace
}  // namespace mane::contact
