// Bodies through a real server over loopback: every bad one is refused by name and nothing is
// stored; good ones come back from an export and a restart; a stream places those that move.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>
#include <limits>

#include "rpc/test_server.h"

namespace mane::rpc {
namespace {

using ::testing::HasSubstr;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

template <typename Number>
std::string Bytes(std::initializer_list<Number> numbers) {
  return {reinterpret_cast<const char*>(numbers.begin()), numbers.size() * sizeof(Number)};
}

// A ball of 5 cm.
v1::Body Ball(const std::string& name, bool moving = false) {
  v1::Body body;
  body.set_name(name);
  body.mutable_capsule()->set_radius_m(0.05);
  body.set_moving(moving);
  return body;
}

// A tetrahedron with sides of 10 cm.
v1::Body Tetrahedron(const std::string& name) {
  v1::Body body;
  body.set_name(name);
  body.mutable_mesh()->set_vertices(Bytes<float>({0, 0, 0, .1f, 0, 0, 0, .1f, 0, 0, 0, .1f}));
  body.mutable_mesh()->set_triangles(Bytes<uint32_t>({0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3}));
  return body;
}

class BodiesTest : public ::testing::Test {
 protected:
  using Messages = std::vector<v1::CreateGroomRequest>;

  static Messages UploadWith(const std::vector<v1::Body>& bodies) {
    Messages messages = UploadOf({GoodGuide(3), GoodGuide(4)});
    for (const v1::Body& body : bodies) *messages.emplace_back().mutable_body() = body;
    return messages;
  }
  v1::Groom Create(const Messages& messages) {
    v1::Groom groom;
    const grpc::Status status = server_.Upload(messages, &groom);
    EXPECT_TRUE(status.ok()) << status.error_message();
    return groom;
  }
  Messages Export(const std::string& name) {
    grpc::ClientContext context;
    v1::ExportGroomRequest request;
    request.set_name(name);
    const auto reader =
        v1::GroomService::NewStub(server_.channel())->ExportGroom(&context, request);
    Messages copy(1);
    v1::ExportGroomResponse part;
    while (reader->Read(&part)) {
      if (part.has_groom() && part.groom().has_scalp_contact()) {
        *copy[0].mutable_header()->mutable_scalp_contact() = part.groom().scalp_contact();
      }
      if (part.has_groom()) copy[0].mutable_header()->set_display_name(part.groom().display_name());
      if (part.has_ellipsoid()) *copy[0].mutable_header()->mutable_ellipsoid() = part.ellipsoid();
      if (part.has_body()) *copy.emplace_back().mutable_body() = part.body();
      if (part.has_guides()) *copy.emplace_back().mutable_guides() = part.guides();
    }
    EXPECT_TRUE(reader->Finish().ok());
    return copy;
  }

  TestServer server_;
};

TEST_F(BodiesTest, EveryBadBodyIsRefusedByName) {
  struct Case {
    const char* field;
    std::function<void(v1::Body*)> spoil;
  };
  const std::vector<Case> cases = {
      {"bodies[1].name", [](auto* b) { b->set_name("no name"); }},
      {"bodies[1].name", [](auto* b) { b->set_name("first"); }},
      {"bodies[1].shape", [](auto* b) { b->clear_shape(); }},
      {"bodies[1].ellipsoid.radii_m.x", [](auto* b) { b->mutable_ellipsoid(); }},
      {"bodies[1].capsule.radius_m", [](auto* b) { b->mutable_capsule()->set_radius_m(0); }},
      {"bodies[1].capsule.a.y", [](auto* b) { b->mutable_capsule()->mutable_a()->set_y(kNan); }},
      {"bodies[1].material", [](auto* b) { b->set_material(v1::Material(17)); }},
      {"bodies[1].friction", [](auto* b) { b->set_friction(-1); }},
      {"bodies[1].friction_anisotropy", [](auto* b) { b->set_friction_anisotropy(kNan); }},
      {"bodies[1].pose.position.z",
       [](auto* b) { b->mutable_pose()->mutable_position()->set_z(1e7); }},
      {"bodies[1].pose.orientation",
       [](auto* b) { b->mutable_pose()->mutable_orientation()->set_w(2); }},
      {"bodies[1].mesh.vertices", [](auto* b) { b->mutable_mesh()->set_vertices("12345"); }},
      {"bodies[1].mesh.triangles", [](auto* b) { b->mutable_mesh()->set_triangles("12345"); }},
      {"bodies[1].mesh.hair_triangles",
       [](auto* b) { b->mutable_mesh()->set_hair_triangles("1234"); }},
  };
  for (const Case& bad : cases) {
    v1::Body body = std::string(bad.field).find("mesh") == std::string::npos
                        ? Ball("second")
                        : Tetrahedron("second");
    bad.spoil(&body);
    v1::Groom groom;
    const grpc::Status status = server_.Upload(UploadWith({Ball("first"), body}), &groom);
    EXPECT_EQ(status.error_code(), grpc::StatusCode::INVALID_ARGUMENT) << bad.field;
    EXPECT_EQ(NamedField(status), bad.field) << status.error_message();
  }
}

TEST_F(BodiesTest, AMeshThatBoundsNoSolidIsRefusedByItsBodysName) {
  const struct {
    const char* field;
    std::function<void(v1::TriangleMesh*)> spoil;
  } cases[] = {
      {"bodies[0].mesh.vertices", [](auto* m) { m->Clear(); }},
      {"bodies[0].mesh.triangles", [](auto* m) { m->clear_triangles(); }},
      {"bodies[0].mesh.triangles[0]",
       [](auto* m) {
         m->set_triangles(Bytes<uint32_t>({0, 2, 4}));
       }},
      {"bodies[0].mesh.vertices[1]",
       [](auto* m) {
         m->set_vertices(Bytes<float>({0, 0, 0, float(kNan), 0, 0, 0, .1f, 0, 0, 0, .1f}));
       }},
      // The large side of four is missing.
      {"bodies[0].mesh.triangles",
       [](auto* m) {
         m->set_triangles(Bytes<uint32_t>({0, 2, 1, 0, 1, 3, 0, 3, 2}));
       }},
  };
  for (const auto& bad : cases) {
    v1::Body body = Tetrahedron("collar");
    bad.spoil(body.mutable_mesh());
    v1::Groom groom;
    const grpc::Status status = server_.Upload(UploadWith({body}), &groom);
    EXPECT_EQ(status.error_code(), grpc::StatusCode::INVALID_ARGUMENT);
    EXPECT_EQ(NamedField(status), bad.field) << status.error_message();
    EXPECT_THAT(status.error_message(), HasSubstr("\"collar\""));
  }
}

TEST_F(BodiesTest, HairThatMeetsTheScalpNeedsOne) {
  Messages messages = UploadOf({GoodGuide()});
  messages[0].mutable_header()->mutable_scalp_contact();
  v1::Groom groom;
  EXPECT_EQ(NamedField(server_.Upload(messages, &groom)), "header.scalp_contact");
  messages[0].mutable_header()->mutable_scalp_contact()->set_friction(11);
  EXPECT_EQ(NamedField(server_.Upload(messages, &groom)), "header.scalp_contact.friction");
}

TEST_F(BodiesTest, AnExportUploadsToAnEqualGroomAndSurvivesARestart) {
  v1::Body hand = Ball("hand", true);
  hand.set_material(v1::MATERIAL_SILK);
  hand.mutable_pose()->mutable_position()->set_x(0.3);
  v1::Body prop = Tetrahedron("prop");
  prop.mutable_mesh()->set_vertices(prop.mesh().vertices().substr(0, 24));
  v1::Body more;  // The last two vertices.
  more.set_name("prop");
  more.mutable_mesh()->set_vertices(Tetrahedron("").mesh().vertices().substr(24));
  Messages messages = UploadWith({hand, prop, more});
  v1::CreateGroomHeader* header = messages[0].mutable_header();
  for (auto set : {&v1::Vector3::set_x, &v1::Vector3::set_y, &v1::Vector3::set_z}) {
    (header->mutable_ellipsoid()->mutable_radii_m()->*set)(0.1);
  }
  header->mutable_scalp_contact()->set_material(v1::MATERIAL_SKIN);
  messages[1].mutable_guides()->mutable_guides(0)->set_wisp_radius_m(0.01);

  const v1::Groom first = Create(messages);
  EXPECT_EQ(first.body_count(), 2u);
  ASSERT_EQ(first.bodies_size(), 2);
  EXPECT_EQ(first.bodies(0).name(), "hand");
  EXPECT_EQ(first.bodies(0).shape(), v1::BodySummary::SHAPE_CAPSULE);
  EXPECT_TRUE(first.bodies(0).moving());
  EXPECT_EQ(first.bodies(1).shape(), v1::BodySummary::SHAPE_MESH);
  EXPECT_EQ(first.bodies(1).mesh().triangles(), 4u);
  EXPECT_GT(first.bodies(1).mesh().bytes(), 0u);
  EXPECT_LT(first.bodies(1).mesh().max_error_m(), 1e-3);
  EXPECT_EQ(first.scalp_contact().friction(), 0.4);

  server_.Restart();
  const Messages copy = Export(first.name());
  EXPECT_EQ(copy[1].body().friction(), 0.2);
  const v1::Groom second = Create(copy);
  EXPECT_EQ(second.etag(), first.etag());
  EXPECT_EQ(second.bodies(1).SerializeAsString(), first.bodies(1).SerializeAsString());
  messages[1].mutable_guides()->mutable_guides(0)->set_wisp_radius_m(0);
  EXPECT_NE(Create(messages).etag(), first.etag());
}

TEST_F(BodiesTest, AStreamPlacesMovingBodiesOnly) {
  const std::string name = Create(UploadWith({Ball("hat"), Ball("hand", true)})).name();
  const auto refused = [&](const std::string& first, const std::string& second, double x) {
    TestStream stream(server_, LockstepOf(name));
    v1::AnimateRequest request;
    request.mutable_pose()->mutable_pose();
    request.mutable_pose()->add_bodies()->set_name(first);
    v1::BodyPose* body = request.mutable_pose()->add_bodies();
    body->set_name(second);
    body->mutable_pose()->mutable_position()->set_x(x);
    stream.Write(request);
    return NamedField(stream.Finish());
  };
  EXPECT_EQ(refused("hand", "hat", 0), "pose.bodies[1].name");
  EXPECT_EQ(refused("hand", "hnad", 0), "pose.bodies[1].name");
  EXPECT_EQ(refused("hand", "hand", 0), "pose.bodies[1].name");
  EXPECT_EQ(refused("hat", "hand", 0), "pose.bodies[0].name");
  EXPECT_EQ(refused("", "hand", 0), "pose.bodies[0].name");

  TestStream stream(server_, LockstepOf(name));
  v1::AnimateRequest request;
  v1::BodyPose* hand = request.mutable_teleport()->add_bodies();
  hand->set_name("hand");
  hand->mutable_pose()->mutable_position()->set_y(kNan);
  stream.Write(request);
  EXPECT_EQ(NamedField(stream.Finish()), "teleport.bodies[0].pose.position.y");
}

// One LOCKSTEP run with a hand that passes by.
std::vector<std::string> Play(TestServer& server, const std::string& groom) {
  TestStream stream(server, LockstepOf(groom));
  std::vector<std::string> frames;
  for (int i = 0; i < 10; ++i) {
    v1::AnimateRequest request;
    request.mutable_pose()->set_time_s(i / 60.0);
    request.mutable_pose()->mutable_pose()->mutable_position()->set_x(0.01 * i * (i % 3));
    if (i % 2 == 0) {
      v1::BodyPose* hand = request.mutable_pose()->add_bodies();
      hand->set_name("hand");
      hand->mutable_pose()->mutable_position()->set_x(0.2 - 0.02 * i);
    }
    EXPECT_TRUE(stream.Write(request));
    frames.push_back(stream.NextFrame());
    EXPECT_FALSE(frames.back().empty());
  }
  return frames;
}

TEST_F(BodiesTest, LockstepWithMovingBodiesIsTheSameBitsEveryTimeAlsoAfterARestart) {
  const std::string name = Create(UploadWith({Tetrahedron("prop"), Ball("hand", true)})).name();
  const auto frames = Play(server_, name);
  EXPECT_EQ(frames, Play(server_, name));
  server_.Restart();  // The field of the prop is made anew.
  EXPECT_EQ(frames, Play(server_, name));
}

}  // namespace
}  // namespace mane::rpc
