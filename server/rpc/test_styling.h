#pragma once

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "mane/v1/groom.grpc.pb.h"
#include "mane/v1/style.grpc.pb.h"
#include "rpc/test_server.h"

namespace mane::rpc {

/// A server, and calls of its StylingService and of the jobs that it makes.
class StylingFixture : public ::testing::Test {
 protected:
  grpc::Status Apply(const v1::ApplyStyleHeader& header, v1::Job* job,
                     const std::vector<v1::ApplyStyleRequest>& more = {}) {
    const auto stub = v1::StylingService::NewStub(server_.channel());
    grpc::ClientContext context;
    const auto writer = stub->ApplyStyle(&context, job);
    v1::ApplyStyleRequest request;
    *request.mutable_header() = header;
    writer->Write(request);
    for (const auto& message : more) writer->Write(message);
    request.mutable_commit();
    writer->Write(request);
    writer->WritesDone();
    return writer->Finish();
  }

  // Follows a job to its end.
  v1::Job Watch(const std::string& name) {
    const auto stub = v1::JobService::NewStub(server_.channel());
    grpc::ClientContext context;
    v1::WatchJobRequest request;
    request.set_name(name);
    const auto reader = stub->WatchJob(&context, request);
    v1::Job job;
    while (reader->Read(&job)) {
    }
    EXPECT_TRUE(reader->Finish().ok());
    return job;
  }

  std::vector<v1::HairstylePart> Read(const std::string& job, grpc::Status* status) {
    const auto stub = v1::StylingService::NewStub(server_.channel());
    grpc::ClientContext context;
    v1::ReadHairstyleRequest request;
    request.set_name(job);
    const auto reader = stub->ReadHairstyle(&context, request);
    std::vector<v1::HairstylePart> parts;
    v1::HairstylePart part;
    while (reader->Read(&part)) parts.push_back(part);
    *status = reader->Finish();
    return parts;
  }

  // Whether a style's groom has so many guides, imported, and hairs.
  void ExpectGroom(const std::string& name, uint32_t guides, uint64_t hairs) {
    const auto stub = v1::GroomService::NewStub(server_.channel());
    grpc::ClientContext context;
    v1::GetGroomRequest request;
    request.set_name(name);
    v1::Groom groom;
    ASSERT_TRUE(stub->GetGroom(&context, request, &groom).ok());
    EXPECT_EQ(groom.guide_count(), guides);
    EXPECT_EQ(groom.hair_count(), hairs);
    EXPECT_TRUE(groom.has_import_summary());
  }

  // Whether a request that is sent again once it is done finds its job.
  void ExpectOneJob(v1::ApplyStyleHeader header) {
    header.set_request_id("once");
    header.set_groom_id("once");
    v1::Job first, second;
    ASSERT_TRUE(Apply(header, &first).ok());
    EXPECT_EQ(Watch(first.name()).state(), v1::Job::STATE_SUCCEEDED);
    ASSERT_TRUE(Apply(header, &second).ok());
    EXPECT_EQ(first.name(), second.name());
  }

  TestServer server_;
};

}  // namespace mane::rpc
