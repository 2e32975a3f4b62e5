#pragma once

#include <gtest/gtest.h>

#include <string>
#include <vector>

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

  TestServer server_;
};

}  // namespace mane::rpc
