// What the store holds: grooms whose hair meets nothing are the bytes of earlier releases, and such
// bytes still load; bodies come back bit for bit.

#include "rpc/groom_library.h"

#include <gtest/gtest.h>

#include "groom/digest.h"
#include "groom/validate.h"
#include "groom/validate_body.h"
#include "rpc/convert_groom.h"
#include "rpc/test_server.h"
#include "storage/test_folder.h"

namespace mane::rpc {
namespace {

class GroomLibraryTest : public ::testing::Test {
 protected:
  static groom::Parts TwoGuides() {
    groom::Parts parts;
    for (int i = 0; i < 2; ++i) {
      parts.guides.push_back(*groom::MakeGuide(ToDescription(GoodGuide(3)), i));
    }
    parts.scalp = groom::Ellipsoid{{0, 0, 0}, {0.1, 0.1, 0.1}};
    return parts;
  }
  storage::GroomRecord Create(const std::string& id, const groom::Parts& parts) {
    auto contact = library_.PrepareContact(parts);
    EXPECT_TRUE(contact);
    const auto record = library_.Create({id, "", parts, {}, *std::move(contact)});
    EXPECT_TRUE(record) << record.error().message;
    return *record;
  }

  storage::TestFolder folder_;
  std::unique_ptr<storage::GroomStore> store_ = *storage::GroomStore::Open(folder_.DatabasePath());
  exec::WorkerPool pool_{2};
  session::BodyLibrary bodies_{{}};
  GroomLibrary library_{*store_, pool_, bodies_, {}};
};

TEST_F(GroomLibraryTest, GroomsWhoseHairMeetsNothingAreTheBytesOfEarlierReleases) {
  const storage::GroomRecord made = Create("new", TwoGuides());
  EXPECT_TRUE(made.contact.empty());
  StoredGroom old;  // As it was written before there were bodies: fields 1 to 4 only.
  for (int i = 0; i < 2; ++i) {
    FromDescription(groom::Describe(TwoGuides().guides[i]), old.add_guides());
  }
  FromEllipsoid(std::get<groom::Ellipsoid>(TwoGuides().scalp), old.mutable_ellipsoid());
  const auto content = store_->GetContent("new");
  ASSERT_TRUE(content);
  EXPECT_EQ(content->groom, old.SerializeAsString());

  storage::GroomRecord record = made;
  record.id = "old";
  ASSERT_TRUE(store_->Put(record, *content));
  const auto asset = library_.LoadAsset("grooms/old", "name");
  ASSERT_TRUE(asset);
  EXPECT_EQ(asset->bodies, nullptr);
  EXPECT_FALSE(asset->groom->has_contact);
  EXPECT_EQ(groom::Digest(*asset->groom), made.etag);
}

TEST_F(GroomLibraryTest, WhatHairMeetsComesBack) {
  groom::Parts parts = TwoGuides();
  parts.scalp_friction = groom::Friction{0.4, 0.2};
  parts.guides[1].wisp_radius = 0.01;
  groom::Body hand{"hand", groom::Body::Capsule{{0, 0, 0}, {0, 0.1, 0}, 0.03}, {1, 0.5}, true, {}};
  hand.pose.p = {1, 2, 3};
  hand.pose.q = Eigen::Quaterniond(0, 0, 1, 0);
  const groom::Body::Mesh mesh{{{0, 0, 0}, {.1f, 0, 0}, {0, .1f, 0}, {0, 0, .1f}},
                               {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}}};
  parts.bodies = {*groom::MakeBody(hand, 0),
                  {"hat", groom::Body::Ellipsoid{{0.1, 0.2, 0.1}}, {}, false, {}},
                  {"prop", std::make_shared<const groom::Body::Mesh>(mesh), {0.1, 0}, false, {}}};
  const storage::GroomRecord record = Create("met", parts);
  EXPECT_NE(library_.MakersOf("grooms/met"), nullptr);
  const auto asset = library_.LoadAsset("grooms/met", "name");
  ASSERT_TRUE(asset);
  EXPECT_EQ(groom::Digest(*asset->groom), record.etag);
  EXPECT_TRUE(asset->groom->has_contact);
  ASSERT_NE(asset->bodies, nullptr);
  EXPECT_EQ(asset->bodies->bodies.size(), 4u);  // With the scalp.
  EXPECT_EQ(asset->bodies->moving_count, 1);
  EXPECT_EQ(library_.MakersOf("grooms/met"), nullptr);
  EXPECT_EQ(library_.MakersOf("grooms/none"), nullptr);
}

}  // namespace
}  // namespace mane::rpc
