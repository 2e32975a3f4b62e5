// What a server is given: secrets come from files, and never show in a message.

#include "app/server_options.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

namespace mane::app {
namespace {

class ServerOptionsTest : public ::testing::Test {
 protected:
  void SetUp() override { std::filesystem::create_directories(folder_); }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  std::string File(const std::string& name, const std::string& text) {
    std::ofstream(folder_ / name) << text;
    return folder_ / name;
  }

  const std::filesystem::path folder_ =
      std::filesystem::path(::testing::TempDir()) /
      ::testing::UnitTest::GetInstance()->current_test_info()->name();
};

TEST_F(ServerOptionsTest, WorkersDefaultToTheCores) {
  Options options;
  EXPECT_GE(ToServerOptions(options)->workers, 1);
  options.workers = 3;
  EXPECT_EQ(ToServerOptions(options)->workers, 3);
}

TEST_F(ServerOptionsTest, SecretsAreRead) {
  Options options;
  options.tls_cert = File("cert", "CERT");
  options.tls_key = File("key", "KEY");
  options.token_file = File("token", "0123456789abcdef\n");
  const Result<rpc::ServerOptions> result = ToServerOptions(options);
  ASSERT_TRUE(result) << result.error().message;
  ASSERT_TRUE(result->tls);
  EXPECT_EQ(result->tls->certificate, "CERT");
  EXPECT_EQ(result->tls->key, "KEY");
  EXPECT_EQ(result->token, "0123456789abcdef");
}

TEST_F(ServerOptionsTest, AWeakTokenIsRefusedWithoutBeingShown) {
  for (const std::string token : {"hunter2", "0123456789abcdef second", "0123456789abcd\n\nef"}) {
    Options options;
    options.token_file = File("token", token);
    const Result<rpc::ServerOptions> result = ToServerOptions(options);
    ASSERT_FALSE(result) << token;
    EXPECT_EQ(result.error().field, "token-file");
    EXPECT_EQ(result.error().message.find(token), std::string::npos);
  }
}

TEST_F(ServerOptionsTest, AMissingOrEmptyFileIsNamed) {
  Options options;
  options.tls_cert = File("cert", "CERT");
  options.tls_key = folder_ / "none";
  EXPECT_EQ(ToServerOptions(options).error().field, "tls-key");
  options.tls_key = File("key", "");
  EXPECT_EQ(ToServerOptions(options).error().field, "tls-key");
}

}  // namespace
}  // namespace mane::app
