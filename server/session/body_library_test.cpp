// Bodies are made once while their groom is in memory; their fields stay within their bytes, and
// those that no head uses make room.

#include "session/body_library.h"

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <future>
#include <memory>
#include <thread>

#include "head/memory.h"
#include "session/test_heads.h"

namespace mane::session {
namespace {

using head::FieldOf;

// A tetrahedron of `size` as a body mesh.
std::shared_ptr<const groom::Body::Mesh> Tetrahedron(float size) {
  groom::Body::Mesh mesh{{{0, 0, 0}, {size, 0, 0}, {0, size, 0}, {0, 0, size}},
                         {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}}};
  return std::make_shared<const groom::Body::Mesh>(std::move(mesh));
}

std::shared_ptr<const groom::Groom> GroomWith(std::shared_ptr<const groom::Body::Mesh> mesh) {
  groom::Parts parts;
  parts.guides = head::SampleGroom(2, 3)->guides;
  parts.bodies = {{"prop", std::move(mesh), {}, false, {}}};
  return *groom::Assemble(std::move(parts), {}, nullptr);
}

TEST(BodyLibraryTest, BodiesAreMadeOnceAndSettledAmong) {
  BodyLibrary library({});
  const auto groom = GroomWith(Tetrahedron(0.1f)), other = GroomWith(Tetrahedron(0.1f));
  EXPECT_TRUE(library.Missing(groom));
  const auto bodies = library.FindOrMake(groom);
  ASSERT_TRUE(bodies);
  EXPECT_FALSE(library.Missing(groom));
  EXPECT_EQ(*library.FindOrMake(groom), *bodies);
  EXPECT_TRUE(library.Missing(other));
  const auto others = library.FindOrMake(other);
  ASSERT_TRUE(others);
  EXPECT_EQ(FieldOf((*others)->bodies[0]), FieldOf((*bodies)->bodies[0]));  // One mesh, one field.
  ASSERT_NE(FieldOf((*bodies)->bodies[0]), nullptr);
  EXPECT_FALSE((*bodies)->settled.empty());
  EXPECT_TRUE((*library.MakeShapes(*groom))->settled.empty());
}

TEST(BodyLibraryTest, AGroomWhoseHairMeetsNothingHasNone) {
  BodyLibrary library({});
  const auto groom = head::SampleGroom(2, 3);
  EXPECT_FALSE(library.Missing(groom));
  EXPECT_EQ(*library.FindOrMake(groom), nullptr);
}

TEST(BodyLibraryTest, FieldsInUseAreLimited) {
  BodyLibraryOptions options;
  const auto small = GroomWith(Tetrahedron(0.1f)), large = GroomWith(Tetrahedron(0.15f));
  {
    BodyLibrary measure({});
    const auto a = measure.FindOrMake(small), b = measure.FindOrMake(large);
    options.max_used_bytes =
        FieldOf((*a)->bodies[0])->bytes() + FieldOf((*b)->bodies[0])->bytes() - 1;
  }
  BodyLibrary library(options);
  auto held = *library.FindOrMake(small);
  const auto refused = library.FindOrMake(large);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, ErrorCode::kResourceExhausted);
  EXPECT_FALSE(library.Missing(small));
  held = nullptr;  // Its heads are closed.
  EXPECT_TRUE(library.FindOrMake(large));
  EXPECT_TRUE(library.Missing(small));
}

TEST(BodyLibraryTest, SettledHairIsCounted) {
  const auto groom = SampleGroomWithBodies(40, 6), other = SampleGroomWithBodies(40, 6);
  BodyLibraryOptions options;
  options.max_used_bytes = 3 * head::StateBytes(*groom) / 2;  // No fields: all of it hair.
  BodyLibrary library(options);
  auto held = *library.FindOrMake(groom);
  ASSERT_NE(held, nullptr);
  const auto refused = library.FindOrMake(other);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, ErrorCode::kResourceExhausted);
  held = nullptr;
  EXPECT_TRUE(library.FindOrMake(other));
}

TEST(BodyLibraryTest, WhatNobodyWaitsForIsNotMade) {
  BodyLibrary library({});
  const auto groom = SampleGroomWithBodies(1000, 20);  // Settles in seconds.
  int asked = 0;
  const auto stopped = library.FindOrMake(groom, [&] { return ++asked > 2; });
  ASSERT_FALSE(stopped);
  EXPECT_EQ(stopped.error().code, ErrorCode::kCancelled);
  EXPECT_LE(asked, 4);  // Each step of many asks.
  EXPECT_TRUE(library.Missing(groom));
}

TEST(BodyLibraryTest, WhoAskAtOnceShareWhatIsMade) {
  BodyLibrary library({});
  const auto groom = SampleGroomWithBodies(100, 8);
  BodyLibrary::BodiesPtr made[3];
  std::atomic<int> asked = 0;
  for (auto& bodies : made) {
    library.PoolFor(*groom).Post([&] {
      ++asked;
      while (asked < 3) std::this_thread::yield();  // They are made side by side.
      bodies = *library.FindOrMake(groom);
    });
  }
  library.WaitIdle();
  EXPECT_NE(made[0], nullptr);
  EXPECT_EQ(made[1], made[0]);
  EXPECT_EQ(made[2], made[0]);
}

TEST(BodyLibraryTest, QuickOnesDoNotWaitForSlowOnes) {
  BodyLibrary library({});
  const auto quick = SampleGroomWithBodies(20, 4), slow = SampleGroomWithBodies(1000, 20);
  auto& slow_ones = library.PoolFor(*slow);
  std::promise<void> gate;
  const std::shared_future<void> open = gate.get_future().share();
  for (int i = 0; i < 2 * BodyLibrary::kMakers; ++i) slow_ones.Post([open] { open.wait(); });
  std::promise<void> made;
  library.PoolFor(*quick).Post([&] {
    EXPECT_TRUE(library.FindOrMake(quick));
    made.set_value();
  });
  EXPECT_EQ(made.get_future().wait_for(std::chrono::seconds(60)), std::future_status::ready);
  gate.set_value();
  library.WaitIdle();
}

TEST(BodyLibraryTest, MeshesAndMuchHairMayTakeLong) {
  BodyLibrary library({});
  auto& quick = library.PoolFor(*SampleGroomWithBodies(20, 4));  // Capsules and ellipsoids.
  EXPECT_EQ(&library.PoolFor(*SampleGroomWithBodies(40, 6)), &quick);
  auto& slow = library.PoolFor(*GroomWith(Tetrahedron(0.1f)));
  EXPECT_NE(&slow, &quick);
  EXPECT_EQ(&library.PoolFor(*SampleGroomWithBodies(1000, 20)), &slow);
}

// A bake makes them on its own thread, while openings wait for that in every thread of the pool.
TEST(BodyLibraryTest, WaitingInAllOfThePoolStopsNobodyFromMaking) {
  BodyLibrary library({});
  const auto groom = SampleGroomWithBodies(400, 8);
  std::atomic<bool> makes = false;
  BodyLibrary::BodiesPtr made;
  std::jthread maker([&] {
    made = *library.FindOrMake(groom, [&] {
      makes = true;
      return false;
    });
  });
  while (!makes) std::this_thread::yield();
  BodyLibrary::BodiesPtr waited[BodyLibrary::kMakers];
  for (auto& bodies : waited) {
    library.PoolFor(*groom).Post([&] { bodies = *library.FindOrMake(groom); });
  }
  library.WaitIdle();
  maker.join();
  EXPECT_NE(made, nullptr);
  for (const auto& bodies : waited) EXPECT_EQ(bodies, made);
}

TEST(BodyLibraryTest, BadMeshesAreNamed) {
  BodyLibrary library({});
  auto open = *Tetrahedron(0.1f);
  open.triangles.pop_back();  // The largest side of four: too large a hole.
  const auto refused =
      library.FindOrMake(GroomWith(std::make_shared<const groom::Body::Mesh>(std::move(open))));
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, ErrorCode::kInvalidArgument);
  EXPECT_EQ(refused.error().field, "bodies[0].mesh.triangles");
  EXPECT_NE(refused.error().message.find("\"prop\""), std::string::npos);
}

}  // namespace
}  // namespace mane::session
