// Hairs through the client and the real daemon: kept as they were sent, carried by every frame, in
// either space the same; what does not fit is refused by its name.

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <vector>

#include "daemon.h"
#include "test_hair.h"

namespace mane::client_test {
namespace {

constexpr std::uint16_t kParts[] = {0, 20'000, 40'000, 65'535};

// `per_guide` hairs on each of `guides` guides; the first one of each is the guide itself.
Hairs Wisps(std::uint32_t guides, int per_guide) {
  Hairs hairs;
  hairs.offset_unit_m = 1e-6;
  for (std::uint32_t g = 0; g < guides; ++g) {
    for (int i = 0; i < per_guide; ++i) {
      hairs.guides.push_back(g);
      hairs.point_counts.push_back(4);
      const auto offset = static_cast<std::int16_t>(300 * i);
      for (const std::uint16_t part : kParts) {
        hairs.places.push_back({part, {0, offset, static_cast<std::int16_t>(-2 * offset)}});
      }
      for (const int colour : {i, 7, 255}) {
        hairs.colours.push_back(static_cast<std::uint8_t>(colour));
      }
    }
  }
  return hairs;
}

TEST(E2eHairs, AreKeptAsTheyWereSent) {
  Daemon daemon;
  Client client = daemon.Connect();
  GroomUpload upload = WavyGroom(3);
  upload.hairs = Wisps(3, 10'000);  // Some messages of them.
  const std::string name = Create(client, upload);
  EXPECT_EQ(client.GetGroom(name)->hair_count, 30'000u);
  EXPECT_EQ(client.GetGroom(name)->hair_point_count, 120'000u);
  const auto groom = client.GetHairs(name);
  ASSERT_TRUE(groom) << groom.error().message;
  const Hairs& hairs = groom->hairs;
  EXPECT_EQ(groom->root_frames.size(), 3u);
  EXPECT_EQ(hairs.offset_unit_m, 1e-6);
  EXPECT_EQ(hairs.guides, upload.hairs.guides);
  EXPECT_EQ(hairs.point_counts, upload.hairs.point_counts);
  EXPECT_EQ(hairs.colours, upload.hairs.colours);
  ASSERT_EQ(hairs.places.size(), upload.hairs.places.size());
  EXPECT_EQ(std::memcmp(hairs.places.data(), upload.hairs.places.data(), 8 * 120'000), 0);
  EXPECT_EQ(client.GetHairs("grooms/none").error().code, ErrorCode::kNotFound);
  EXPECT_TRUE(client.GetHairs(Create(client, WavyGroom(2)))->hairs.guides.empty());
}

TEST(E2eHairs, GoWithEveryFrame) {
  Daemon daemon;
  Client client = daemon.Connect();
  GroomUpload upload = WavyGroom(3);
  upload.hairs = Wisps(3, 5);
  const std::string name = Create(client, upload);
  const GroomHairs groom = *client.GetHairs(name);
  HeadOptions options{.groom = name, .pacing = Pacing::kLockstep, .points_per_guide = 24};
  Head world = client.OpenHead(options);
  options.space = Space::kHead;
  Head inside = client.OpenHead(options);
  for (int step = 0; step < 30; ++step) {
    const double t = step / 60.0;
    const auto there = world.Step(t, MotionAt(t)), here = inside.Step(t, MotionAt(t));
    ASSERT_TRUE(there && here);
    const Frame& frame = **there;
    std::vector<float> out(3 * groom.hairs.places.size()), in_head = out;
    ASSERT_TRUE(AssembleHairs(groom, frame.positions, 24, frame.head_pose.orientation, out));
    ASSERT_TRUE(AssembleHairs(groom, (*here)->positions, 24, {}, in_head));
    const auto at = [](const std::vector<float>& points, std::size_t i) {
      return Vector3{points[3 * i], points[3 * i + 1], points[3 * i + 2]};
    };
    for (std::size_t i = 0; i < groom.hairs.places.size(); ++i) {
      EXPECT_LT(Distance(at(out, i), Apply(frame.head_pose, at(in_head, i))), 2e-5);
      const std::size_t hair = i / 4;
      const std::size_t own = hair / 5 * 20 + i % 4;  // The same point of the guide itself.
      EXPECT_NEAR(Distance(at(out, i), at(out, own)), 3e-4 * (hair % 5) * std::sqrt(5.0), 2e-6);
    }
    for (std::uint32_t g = 0; g < 3; ++g) {
      EXPECT_LT(Distance(at(out, 20 * g), PointOf(frame, g, 0)), 1e-6);
      EXPECT_LT(Distance(at(out, 20 * g + 3), PointOf(frame, g, 23)), 1e-6);
    }
  }
}

TEST(E2eHairs, WhatDoesNotFitIsNamed) {
  Daemon daemon;
  Client client = daemon.Connect();
  const auto refused = [&](auto spoil) {
    GroomUpload upload = WavyGroom(2);
    upload.hairs = Wisps(2, 2);
    spoil(upload.hairs);
    const auto groom = client.CreateGroom(upload);
    return groom ? "" : groom.error().field;
  };
  EXPECT_EQ(refused([](Hairs&) {}), "");
  EXPECT_EQ(refused([](Hairs& h) { h.guides[1] = 2; }), "hairs[1].guide");
  EXPECT_EQ(refused([](Hairs& h) { h.point_counts.pop_back(); }), "hairs.point_counts");
  EXPECT_EQ(refused([](Hairs& h) { h.places.emplace_back(); }), "hairs.places");
  EXPECT_EQ(refused([](Hairs& h) { h.colours.pop_back(); }), "hairs.colours");
  EXPECT_EQ(refused([](Hairs& h) { h.offset_unit_m = 0; }), "header.hair_offset_unit_m");

  const GroomHairs groom{Wisps(2, 2), std::vector<Quaternion>(2)};
  const std::vector<float> positions(2 * 16 * 3);
  std::vector<float> out(3 * groom.hairs.places.size());
  EXPECT_TRUE(AssembleHairs(groom, positions, 16, {}, out));
  EXPECT_EQ(AssembleHairs(groom, positions, 17, {}, out).error().field, "positions");
  EXPECT_EQ(AssembleHairs(groom, positions, 257, {}, out).error().field, "points_per_guide");
  out.pop_back();
  EXPECT_EQ(AssembleHairs(groom, positions, 16, {}, out).error().field, "out");
  GroomHairs wrong = groom;
  wrong.hairs.guides[3] = 2;
  EXPECT_EQ(AssembleHairs(wrong, positions, 16, {}, out).error().field, "hairs");
}

}  // namespace
}  // namespace mane::client_test
