#include "storage/data_folder.h"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <cerrno>
#include <system_error>

namespace mane::storage {

namespace {

Error Unusable(const std::filesystem::path& path, int error_number) {
  return {ErrorCode::kUnavailable,
          fmt::format("cannot use data folder {}: {}", path.string(),
                      std::generic_category().message(error_number)),
          ""};
}

}  // namespace

Result<DataFolder> DataFolder::Open(const std::filesystem::path& path) {
  std::error_code failure;
  std::filesystem::create_directories(path, failure);
  if (failure) return Unusable(path, failure.value());

  const int file = open((path / "lock").c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0644);
  if (file < 0) return Unusable(path, errno);
  DataFolder folder(path, file);
  if (flock(file, LOCK_EX | LOCK_NB) == 0) return folder;
  if (errno != EWOULDBLOCK) return Unusable(path, errno);
  return Error{ErrorCode::kFailedPrecondition,
               fmt::format("data folder {} is in use by another server", path.string()), ""};
}

DataFolder::~DataFolder() {
  if (lock_ >= 0) close(lock_);
}

}  // namespace mane::storage
