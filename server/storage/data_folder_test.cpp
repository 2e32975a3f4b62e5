// Properties of the data folder: it is made when missing, and one server at a time has it.

#include "storage/data_folder.h"

#include <gtest/gtest.h>

#include <fstream>
#include <optional>

#include "storage/test_folder.h"

namespace mane::storage {
namespace {

TEST(DataFolderTest, IsMadeWithItsParents) {
  TestFolder test;
  const auto folder = DataFolder::Open(test.path() / "a" / "b");
  MANE_ASSERT_OK(folder);
  EXPECT_EQ(folder->DatabasePath(), test.path() / "a" / "b" / "mane.db");
  EXPECT_TRUE(std::filesystem::is_directory(test.path() / "a" / "b"));
}

TEST(DataFolderTest, IsRefusedWhileAnotherOneHasIt) {
  TestFolder test;
  auto first = DataFolder::Open(test.path());
  MANE_ASSERT_OK(first);
  const auto second = DataFolder::Open(test.path());
  ASSERT_FALSE(second);
  EXPECT_EQ(second.error().code, ErrorCode::kFailedPrecondition);
  EXPECT_NE(second.error().message.find(test.path().string()), std::string::npos);

  { const DataFolder moved = std::move(*first); }
  MANE_EXPECT_OK(DataFolder::Open(test.path()));
}

TEST(DataFolderTest, CannotBeAFile) {
  TestFolder test;
  const auto file = test.path() / "file";
  std::ofstream(file) << "x";
  for (const auto& path : {file, file / "below"}) {
    const auto folder = DataFolder::Open(path);
    ASSERT_FALSE(folder);
    EXPECT_EQ(folder.error().code, ErrorCode::kUnavailable);
    EXPECT_NE(folder.error().message.find(path.string()), std::string::npos);
  }
}

}  // namespace
}  // namespace mane::storage
