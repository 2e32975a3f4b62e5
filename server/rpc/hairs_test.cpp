// Hairs through CreateGroom and ExportGroom of a real server: they come back byte for byte after a
// restart, for guides of any making; what is wrong is refused by its name.

#include <gtest/gtest.h>

#include <cstring>
#include <functional>
#include <string>
#include <vector>

#include "rpc/test_server.h"

namespace mane::rpc {
namespace {

template <typename Number>
std::string Bytes(const std::vector<Number>& numbers) {
  return {reinterpret_cast<const char*>(numbers.data()), numbers.size() * sizeof(Number)};
}

// `count` hairs of three points, the same number on each of `guides` guides.
v1::HairBatch BatchOf(uint32_t count, uint32_t guides) {
  std::vector<uint32_t> on;
  std::vector<uint16_t> places;
  std::vector<uint8_t> colours;
  for (uint32_t i = 0; i < count; ++i) {
    on.push_back(i * guides / count);
    for (const uint32_t part : {0, 30'000, 65'535}) {
      for (const uint32_t number : {part, i, 3 * i, part + i}) {
        places.push_back(static_cast<uint16_t>(number));
      }
    }
    for (const uint32_t colour : {i, i / 7, 200U}) colours.push_back(static_cast<uint8_t>(colour));
  }
  v1::HairBatch batch;
  batch.set_guides(Bytes(on));
  batch.set_point_counts(Bytes(std::vector<uint16_t>(count, 3)));
  batch.set_places(Bytes(places));
  batch.set_colours(Bytes(colours));
  return batch;
}

void Append(const v1::HairBatch& from, v1::HairBatch* to) {
  to->set_guides(to->guides() + from.guides());
  to->set_point_counts(to->point_counts() + from.point_counts());
  to->set_places(to->places() + from.places());
  to->set_colours(to->colours() + from.colours());
}

class HairsTest : public ::testing::Test {
 protected:
  // The hairs of an export, whose messages are within the limit on received ones.
  v1::HairBatch Export(const std::string& name, v1::Groom* groom, bool omit_hairs = false) {
    const auto stub = v1::GroomService::NewStub(server_.channel());
    grpc::ClientContext context;
    v1::ExportGroomRequest request;
    request.set_name(name);
    request.set_omit_hairs(omit_hairs);
    const auto reader = stub->ExportGroom(&context, request);
    v1::HairBatch hairs;
    v1::ExportGroomResponse part;
    while (reader->Read(&part)) {
      EXPECT_LT(part.ByteSizeLong(), 1U << 20);
      if (part.has_groom()) *groom = part.groom();
      if (part.has_hairs()) Append(part.hairs(), &hairs);
    }
    EXPECT_TRUE(reader->Finish().ok());
    return hairs;
  }

  static std::vector<v1::CreateGroomRequest> HairyUpload(const v1::HairBatch& batch) {
    auto messages = UploadOf({GoodGuide(), GoodGuide()});
    messages[0].mutable_header()->set_hair_offset_unit_m(1e-6);
    *messages.emplace_back().mutable_hairs() = batch;
    return messages;
  }

  TestServer server_;
};

TEST_F(HairsTest, ComeBackByteForByteAfterARestart) {
  const v1::HairBatch batch = BatchOf(20'000, 2);  // 660 kB.
  auto messages = HairyUpload(batch);
  v1::HairBatch more = BatchOf(5, 1);
  more.set_guides(Bytes(std::vector<uint32_t>(5, 1)));
  *messages.emplace_back().mutable_hairs() = more;
  v1::HairBatch whole = batch;
  Append(more, &whole);
  v1::Groom made, told, again;
  ASSERT_TRUE(server_.Upload(messages, &made).ok());
  EXPECT_EQ(made.hair_count(), 20'005u);
  EXPECT_EQ(made.hair_point_count(), 60'015u);
  EXPECT_EQ(made.hair_offset_unit_m(), 1e-6);
  server_.Restart();
  const v1::HairBatch exported = Export(made.name(), &told);
  EXPECT_EQ(exported.SerializeAsString(), whole.SerializeAsString());
  EXPECT_EQ(told.SerializeAsString(), made.SerializeAsString());
  EXPECT_TRUE(Export(made.name(), &told, true).guides().empty());

  auto equal = HairyUpload(exported);
  ASSERT_TRUE(server_.Upload(equal, &again).ok());
  EXPECT_EQ(again.etag(), made.etag());
  equal.pop_back();
  ASSERT_TRUE(server_.Upload(equal, &again).ok());
  EXPECT_EQ(again.hair_count(), 0u);
  EXPECT_EQ(again.hair_offset_unit_m(), 0);
  const std::string with_unit = again.etag();
  ASSERT_TRUE(server_.Upload(UploadOf({GoodGuide(), GoodGuide()}), &again).ok());
  EXPECT_EQ(again.etag(), with_unit);
}

TEST_F(HairsTest, RideOnGuidesThatTheServerMakes) {
  std::vector<v1::CreateGroomRequest> messages(2);
  v1::CreateGroomHeader& header = *messages[0].mutable_header();
  header.set_hair_offset_unit_m(1e-6);
  for (auto set : {&v1::Vector3::set_x, &v1::Vector3::set_y, &v1::Vector3::set_z}) {
    (header.mutable_ellipsoid()->mutable_radii_m()->*set)(0.1);
  }
  header.mutable_generate()->set_hair_type(v1::HAIR_TYPE_ASIAN_SMOOTH);
  header.mutable_generate()->set_guide_count(3);
  header.mutable_generate()->set_length_m(0.1);
  *messages[1].mutable_hairs() = BatchOf(9, 3);
  v1::Groom groom;
  ASSERT_TRUE(server_.Upload(messages, &groom).ok());
  EXPECT_EQ(Export(groom.name(), &groom).SerializeAsString(), BatchOf(9, 3).SerializeAsString());
  *messages[1].mutable_hairs() = BatchOf(9, 4);
  EXPECT_EQ(NamedField(server_.Upload(messages, &groom)), "hairs[7].guide");

  header.clear_generate();
  header.mutable_import_options()->set_hair_type(v1::HAIR_TYPE_ASIAN_SMOOTH);
  *messages[1].mutable_hairs() = BatchOf(4, 1);
  messages.emplace_back().mutable_strands()->add_strands()->set_points(
      Bytes(std::vector<float>{0, 0.1f, 0, 0, 0.05f, 0.01f, 0, 0, 0.02f}));
  const grpc::Status status = server_.Upload(messages, &groom);
  ASSERT_TRUE(status.ok()) << status.error_message();
  EXPECT_EQ(groom.hair_count(), 4u);
}

TEST_F(HairsTest, EveryBadBatchIsRefused) {
  struct Case {
    const char* field;
    std::function<void(v1::HairBatch*)> spoil;
  };
  const auto patched = [](std::string bytes, size_t at, uint16_t number) {
    std::memcpy(bytes.data() + at, &number, sizeof number);
    return bytes;
  };
  const std::vector<Case> cases = {
      {"hairs.guides", [](auto* b) { b->set_guides("12345"); }},
      {"hairs.point_counts", [](auto* b) { b->set_point_counts("12345"); }},
      {"hairs.point_counts", [](auto* b) { b->clear_point_counts(); }},
      {"hairs.point_counts", [](auto* b) { b->clear_guides(); }},
      {"hairs.places", [](auto* b) { b->set_places(b->places() + std::string(8, 0)); }},
      {"hairs.places", [](auto* b) { b->set_places(b->places() + "1"); }},
      {"hairs.places", [](auto* b) { b->clear_places(); }},
      {"hairs.places",
       [&](auto* b) { b->set_point_counts(patched(b->point_counts(), 4, 65'535)); }},
      {"hairs.colours", [](auto* b) { b->set_colours("12345"); }},
      {"hairs.colours", [](auto* b) { b->set_colours("123456"); }},
      {"hairs[2].guide", [&](auto* b) { b->set_guides(patched(b->guides(), 8, 2)); }},
      {"hairs[1].guide", [&](auto* b) { b->set_guides(patched(b->guides(), 0, 1)); }},
      {"hairs[2].places[2]", [&](auto* b) { b->set_places(patched(b->places(), 64, 7)); }},
      {"hairs[0].point_count",
       [&](auto* b) { b->set_point_counts(patched(patched(b->point_counts(), 0, 1), 2, 5)); }},
  };
  for (const Case& bad : cases) {
    v1::HairBatch batch = BatchOf(4, 2);
    bad.spoil(&batch);
    v1::Groom groom;
    const grpc::Status status = server_.Upload(HairyUpload(batch), &groom);
    EXPECT_EQ(status.error_code(), grpc::StatusCode::INVALID_ARGUMENT) << bad.field;
    EXPECT_EQ(NamedField(status), bad.field) << status.error_message();
  }
  v1::Groom groom;
  auto messages = HairyUpload(BatchOf(4, 2));
  messages.push_back(messages.back());
  messages.back().mutable_hairs()->clear_colours();
  EXPECT_EQ(NamedField(server_.Upload(messages, &groom)), "hairs.colours");
  messages.pop_back();
  messages[0].mutable_header()->clear_hair_offset_unit_m();
  EXPECT_EQ(NamedField(server_.Upload(messages, &groom)), "header.hair_offset_unit_m");
}

}  // namespace
}  // namespace mane::rpc
