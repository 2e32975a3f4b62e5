#include "app/port_file.h"

#include <gtest/gtest.h>

#include <fstream>

namespace mane::app {
namespace {

std::string ReadAll(const std::filesystem::path& path) {
  std::ifstream file(path);
  return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

class PortFileTest : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_ = std::filesystem::path(::testing::TempDir()) / "mane_port_file_test";
    std::filesystem::remove_all(folder_);
    std::filesystem::create_directories(folder_);
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  std::filesystem::path folder_;
};

TEST_F(PortFileTest, HoldsOneLineAndLeavesNothingBeside) {
  ASSERT_TRUE(WritePortFile(folder_ / "port", 7420));
  EXPECT_EQ(ReadAll(folder_ / "port"), "7420\n");
  const auto entries = std::filesystem::directory_iterator(folder_);
  EXPECT_EQ(std::distance(begin(entries), end(entries)), 1);
}

TEST_F(PortFileTest, ReplacesAnOldOne) {
  std::ofstream(folder_ / "port") << "something much longer than a port\n";
  ASSERT_TRUE(WritePortFile(folder_ / "port", 1));
  EXPECT_EQ(ReadAll(folder_ / "port"), "1\n");
}

TEST_F(PortFileTest, ReportsAFolderThatIsNotThere) {
  const Result<void> written = WritePortFile(folder_ / "none" / "port", 1);
  ASSERT_FALSE(written);
  EXPECT_EQ(written.error().code, ErrorCode::kUnavailable);
  EXPECT_EQ(written.error().field, "port-file");
}

}  // namespace
}  // namespace mane::app
