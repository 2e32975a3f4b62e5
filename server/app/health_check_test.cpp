// The health check tells a serving server from one that drains and from none at all.

#include "app/health_check.h"

#include <grpcpp/generic/async_generic_service.h>
#include <grpcpp/grpcpp.h>
#include <grpcpp/health_check_service_interface.h>
#include <gtest/gtest.h>

namespace mane::app {
namespace {

class HealthCheckTest : public ::testing::Test {
 protected:
  void SetUp() override {
    grpc::EnableDefaultHealthCheckService(true);
    grpc::ServerBuilder builder;
    builder.RegisterCallbackGenericService(&anything_);
    builder.AddListeningPort("127.0.0.1:0", grpc::InsecureServerCredentials(), &port_);
    server_ = builder.BuildAndStart();
    ASSERT_NE(server_, nullptr);
    options_.listen = fmt::format("127.0.0.1:{}", port_);
  }

  int port_ = 0;
  grpc::CallbackGenericService anything_;  // A server without a service does not start.
  std::unique_ptr<grpc::Server> server_;
  Options options_;
};

TEST_F(HealthCheckTest, AServingServerIsHealthy) {
  const Result<void> healthy = CheckHealth(options_);
  EXPECT_TRUE(healthy) << healthy.error().message;
}

TEST_F(HealthCheckTest, AnUnspecifiedAddressIsAskedOnLoopback) {
  options_.listen = fmt::format("0.0.0.0:{}", port_);
  EXPECT_TRUE(CheckHealth(options_));
}

TEST_F(HealthCheckTest, ADrainingServerIsNot) {
  server_->GetHealthCheckService()->SetServingStatus(false);
  const Result<void> healthy = CheckHealth(options_);
  ASSERT_FALSE(healthy);
  EXPECT_NE(healthy.error().message.find("does not serve"), std::string::npos);
}

TEST_F(HealthCheckTest, NoServerIsNot) {
  server_->Shutdown();
  const Result<void> healthy = CheckHealth(options_);
  ASSERT_FALSE(healthy);
  EXPECT_EQ(healthy.error().code, ErrorCode::kUnavailable);
}

}  // namespace
}  // namespace mane::app
