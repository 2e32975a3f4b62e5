#pragma once

#include <stdlib.h>

#include <cstdio>
#include <filesystem>
#include <string>

namespace mane::storage {

/// A folder of its own for a test, deleted with all it holds at the end.
class TestFolder {
 public:
  TestFolder() {
    std::string name = (std::filesystem::temp_directory_path() / "mane_test_XXXXXX").string();
    if (!mkdtemp(name.data())) {
      std::perror("mkdtemp");
      std::abort();
    }
    path_ = name;
  }
  TestFolder(const TestFolder&) = delete;
  TestFolder& operator=(const TestFolder&) = delete;
  ~TestFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }

  [[nodiscard]] const std::filesystem::path& path() const { return path_; }
  [[nodiscard]] std::filesystem::path DatabasePath() const { return path_ / "mane.db"; }

 private:
  std::filesystem::path path_;
};

}  // namespace mane::storage

/// Requires that a Result holds a value; shows the error if not.
#define MANE_ASSERT_OK(result) ASSERT_TRUE(result) << (result).error().message
#define MANE_EXPECT_OK(result) EXPECT_TRUE(result) << (result).error().message
