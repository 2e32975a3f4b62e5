#pragma once

#include <filesystem>
#include <utility>

#include "base/result.h"

namespace mane::storage {

/// The folder in which one server keeps its data, locked against a second server for as long as
/// this object lives. Two servers on one folder would each take the other's running jobs for
/// interrupted ones. The system drops the lock when the process dies, however it dies.
class DataFolder {
 public:
  /// Creates `path` with its parents if need be. kFailedPrecondition when another server has it;
  /// kUnavailable when it cannot be created or written.
  static Result<DataFolder> Open(const std::filesystem::path& path);

  DataFolder(DataFolder&& other) noexcept
      : path_(std::move(other.path_)), lock_(std::exchange(other.lock_, -1)) {}
  DataFolder& operator=(DataFolder&&) = delete;
  ~DataFolder();

  /// The file that all stores share.
  [[nodiscard]] std::filesystem::path DatabasePath() const { return path_ / "mane.db"; }

 private:
  DataFolder(std::filesystem::path path, int lock) : path_(std::move(path)), lock_(lock) {}

  std::filesystem::path path_;
  int lock_;  // Descriptor of the locked file; -1 when moved from.
};

}  // namespace mane::storage
