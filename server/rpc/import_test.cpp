// Imported strands against a real server over loopback: the summary in the answer, the report
// strand by strand, both after a restart; what is refused, and by which name; a cancelled import.

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstring>
#include <functional>
#include <limits>
#include <thread>

#include "groom/resolution.h"
#include "rpc/test_server.h"

namespace mane::rpc {
namespace {

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

v1::ImportedStrand StrandOf(const std::vector<float>& numbers) {
  v1::ImportedStrand strand;
  strand.set_points(
      std::string(reinterpret_cast<const char*>(numbers.data()), numbers.size() * sizeof(float)));
  return strand;
}

v1::ImportedStrand Straight() { return StrandOf({0, 0.09f, 0, 0, 0, 0, 0, -0.09f, 0}); }

// A coil of `points` points that fall by 15 cm in four turns, whose radius doubles.
v1::ImportedStrand Coil(int points) {
  std::vector<float> numbers;
  for (int i = 0; i < points; ++i) {
    const double t = static_cast<double>(i) / (points - 1), a = 8 * M_PI * t;
    for (const double x : {0.01 * (1 + t) * std::cos(a), -0.15 * t, 0.01 * (1 + t) * std::sin(a)}) {
      numbers.push_back(static_cast<float>(x));
    }
  }
  return StrandOf(numbers);
}

std::vector<v1::CreateGroomRequest> UploadOfStrands(
    const std::vector<v1::ImportedStrand>& strands) {
  std::vector<v1::CreateGroomRequest> messages(2);
  v1::ImportOptions* options = messages[0].mutable_header()->mutable_import_options();
  options->set_hair_type(v1::HAIR_TYPE_CAUCASIAN_WAVY);
  options->set_element_count(12);
  for (const v1::ImportedStrand& strand : strands) {
    *messages[1].mutable_strands()->add_strands() = strand;
  }
  return messages;
}

template <typename Number>
std::vector<Number> Numbers(const std::string& bytes) {
  EXPECT_EQ(bytes.size() % sizeof(Number), 0u);
  std::vector<Number> numbers(bytes.size() / sizeof(Number));
  std::memcpy(numbers.data(), bytes.data(), bytes.size());
  return numbers;
}

class ImportRpcTest : public ::testing::Test {
 protected:
  std::unique_ptr<v1::GroomService::Stub> stub() {
    return v1::GroomService::NewStub(server_.channel());
  }
  std::vector<v1::Groom> Grooms() {
    grpc::ClientContext context;
    v1::ListGroomsResponse response;
    EXPECT_TRUE(stub()->ListGrooms(&context, {}, &response).ok());
    return {response.grooms().begin(), response.grooms().end()};
  }
  grpc::Status Report(const std::string& name, v1::ImportReport* report) {
    grpc::ClientContext context;
    v1::GetImportReportRequest request;
    request.set_name(name);
    return stub()->GetImportReport(&context, request, report);
  }

  TestServer server_;
};

TEST_F(ImportRpcTest, SummaryAndReportAgreeAndSurviveARestart) {
  auto messages = UploadOfStrands({Straight(), Coil(40), Straight()});
  *messages.emplace_back().mutable_strands()->add_strands() = Coil(60);
  messages[0].mutable_header()->mutable_import_options()->set_error_bound_m(1e-5);
  v1::Groom groom;
  const grpc::Status status = server_.Upload(messages, &groom);
  ASSERT_TRUE(status.ok()) << status.error_message();
  EXPECT_EQ(groom.guide_count(), 4u);
  EXPECT_EQ(groom.hair_type(), v1::HAIR_TYPE_UNSPECIFIED);
  const v1::ImportSummary summary = groom.import_summary();
  EXPECT_EQ(summary.strand_count(), 4u);
  EXPECT_EQ(summary.point_count(), 106u);

  v1::ImportReport before, after;
  ASSERT_TRUE(Report(groom.name(), &before).ok());
  server_.Restart();
  ASSERT_TRUE(Report(groom.name(), &after).ok());
  EXPECT_EQ(after.SerializeAsString(), before.SerializeAsString());
  EXPECT_EQ(Grooms()[0].SerializeAsString(), groom.SerializeAsString());

  EXPECT_EQ(after.summary().SerializeAsString(), summary.SerializeAsString());
  EXPECT_TRUE(after.options().hold());
  EXPECT_EQ(after.options().max_stiffness_factor(), 4);
  const auto elements = Numbers<uint32_t>(after.element_counts());
  const auto largest = Numbers<float>(after.largest_fit_distances());
  const auto rms = Numbers<float>(after.rms_fit_distances());
  const auto met = Numbers<uint8_t>(after.bounds_met());
  const auto held = Numbers<uint8_t>(after.held());
  const auto tips = Numbers<float>(after.tip_deviations());
  const auto factors = Numbers<float>(after.stiffness_factors());
  for (const size_t size :
       {elements.size(), largest.size(), rms.size(), met.size(), held.size(), tips.size(),
        factors.size(), Numbers<float>(after.needed_stiffness_factors()).size(),
        Numbers<float>(after.largest_deviations()).size()}) {
    EXPECT_EQ(size, 4u);
  }
  EXPECT_EQ(elements[0] + elements[1] + elements[2] + elements[3], groom.element_count());
  EXPECT_EQ(static_cast<int>(elements[0]),
            groom::ElementCountFor(groom::HairType::kAsianSmooth, 0.15, groom::kDefaultErrorTarget,
                                   false));
  EXPECT_EQ(elements[1], 12u);  // All that it may have; they miss the bound.
  EXPECT_EQ(summary.bound_missed_count(), std::ranges::count(met, 0));
  EXPECT_EQ(summary.not_held_count(), std::ranges::count(held, 0));
  EXPECT_EQ(summary.largest_fit_distance_m(), std::ranges::max(largest));
  EXPECT_EQ(summary.largest_tip_deviation_m(), std::ranges::max(tips));
  EXPECT_EQ(summary.largest_stiffness_factor(), std::ranges::max(factors));
  const double squares = 3 * std::pow(rms[0], 2) + 40 * std::pow(rms[1], 2) +
                         3 * std::pow(rms[2], 2) + 60 * std::pow(rms[3], 2);
  EXPECT_NEAR(summary.rms_fit_distance_m(), std::sqrt(squares / 106), 1e-9);
}

TEST_F(ImportRpcTest, OnlyImportedGroomsHaveAReport) {
  v1::ImportReport report;
  const std::string plain = server_.MakeGroom();
  EXPECT_EQ(Report(plain, &report).error_code(), grpc::StatusCode::FAILED_PRECONDITION);
  EXPECT_EQ(NamedField(Report(plain, &report)), "name");
  EXPECT_EQ(Report("grooms/none", &report).error_code(), grpc::StatusCode::NOT_FOUND);
  EXPECT_EQ(Report("none", &report).error_code(), grpc::StatusCode::INVALID_ARGUMENT);
  EXPECT_FALSE(Grooms()[0].has_import_summary());
}

TEST_F(ImportRpcTest, WhatIsWrongIsNamedAndNothingIsStored) {
  using Messages = std::vector<v1::CreateGroomRequest>;
  const auto options = [](Messages* m) {
    return (*m)[0].mutable_header()->mutable_import_options();
  };
  const auto strand = [](Messages* m) { return (*m)[1].mutable_strands()->mutable_strands(1); };
  const struct {
    const char* field;
    std::function<void(Messages*)> spoil;
  } cases[] = {
      {"strands[1].points", [&](auto* m) { strand(m)->set_points("1234567890123"); }},
      {"strands[1].points", [&](auto* m) { strand(m)->clear_points(); }},
      {"strands[1].points[2].x",
       [&](auto* m) {
         *strand(m) = StrandOf({0, 0, 0, 0, 1, 0, kNan, 0, 0});
       }},
      {"strands[1].root_frame", [&](auto* m) { strand(m)->mutable_root_frame()->set_w(2); }},
      {"strands[1].properties.air_drag",
       [&](auto* m) { strand(m)->mutable_properties()->set_air_drag(-1); }},
      {"header.import_options.hair_type", [&](auto* m) { options(m)->clear_hair_type(); }},
      {"header.import_options.element_count", [&](auto* m) { options(m)->set_element_count(65); }},
      {"header.import_options.max_stiffness_factor",
       [&](auto* m) { options(m)->set_max_stiffness_factor(0); }},
      {"header.import_options.properties.radius_2_m",
       [&](auto* m) { options(m)->mutable_properties()->set_radius_2_m(1); }},
      {"header.import_options",
       [&](auto* m) {
         (*m)[0].mutable_header()->mutable_generate()->set_hair_type(v1::HAIR_TYPE_ASIAN_SMOOTH);
       }},
      {"strands", [&](auto* m) { (*m)[0].mutable_header()->clear_import_options(); }},
      {"strands", [&](auto* m) { m->pop_back(); }},
      {"guides", [&](auto* m) { *(*m)[1].mutable_guides()->add_guides() = GoodGuide(); }},
  };
  for (const auto& bad : cases) {
    auto messages = UploadOfStrands({Straight(), Straight()});
    bad.spoil(&messages);
    v1::Groom groom;
    const grpc::Status status = server_.Upload(messages, &groom);
    EXPECT_EQ(status.error_code(), grpc::StatusCode::INVALID_ARGUMENT) << bad.field;
    EXPECT_EQ(NamedField(status), bad.field) << status.error_message();
  }
  EXPECT_TRUE(Grooms().empty());
}

TEST_F(ImportRpcTest, ARepeatedRequestIsImportedOnce) {
  auto messages = UploadOfStrands({Straight()});
  messages[0].mutable_header()->set_request_id("once");
  v1::Groom first, second;
  ASSERT_TRUE(server_.Upload(messages, &first).ok());
  ASSERT_TRUE(server_.Upload(messages, &second).ok());
  EXPECT_EQ(first.name(), second.name());
  EXPECT_EQ(Grooms().size(), 1u);
}

TEST(ImportLimitTest, TooManyStrandsAreRefused) {
  TestServer server({.max_groom_guides = 3});
  v1::Groom groom;
  const grpc::Status status = server.Upload(UploadOfStrands(std::vector(4, Straight())), &groom);
  EXPECT_EQ(status.error_code(), grpc::StatusCode::RESOURCE_EXHAUSTED);
  EXPECT_EQ(NamedField(status), "strands");
}

TEST_F(ImportRpcTest, WorkThatWouldTakeTooLongIsRefusedBeforeItBegins) {
  auto messages = UploadOfStrands({});
  messages.pop_back();
  v1::ImportOptions* options = messages[0].mutable_header()->mutable_import_options();
  options->set_element_count(64);
  options->set_error_bound_m(1e-4);
  const v1::ImportedStrand strand = Coil(1000);
  while (messages.size() < 10) {
    v1::StrandBatch* batch = messages.emplace_back().mutable_strands();
    for (int i = 0; i < 80; ++i) *batch->add_strands() = strand;
  }
  v1::Groom groom;
  const grpc::Status status = server_.Upload(messages, &groom);
  EXPECT_EQ(status.error_code(), grpc::StatusCode::RESOURCE_EXHAUSTED) << status.error_message();
  EXPECT_EQ(NamedField(status), "strands");
  EXPECT_NE(status.error_message().find("1800 s"), std::string::npos) << status.error_message();
}

TEST_F(ImportRpcTest, ACancelledImportStopsAndStoresNothing) {
  // A minute of work and more, of which a second is done.
  auto messages = UploadOfStrands(std::vector<v1::ImportedStrand>(400, Coil(100)));
  messages[0].mutable_header()->mutable_import_options()->set_element_count(40);
  grpc::ClientContext context;
  v1::Groom groom;
  const auto writer = stub()->CreateGroom(&context, &groom);
  for (const auto& message : messages) ASSERT_TRUE(writer->Write(message));
  v1::CreateGroomRequest commit;
  commit.mutable_commit();
  ASSERT_TRUE(writer->Write(commit));
  std::this_thread::sleep_for(std::chrono::seconds(1));
  context.TryCancel();
  EXPECT_EQ(writer->Finish().error_code(), grpc::StatusCode::CANCELLED);
  server_.Restart();  // Waits for all work.
  EXPECT_TRUE(Grooms().empty());
}

}  // namespace
}  // namespace mane::rpc
