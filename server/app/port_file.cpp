#include "app/port_file.h"

#include <fstream>
#include <system_error>

namespace mane::app {

Result<void> WritePortFile(const std::filesystem::path& path, int port) {
  std::filesystem::path unfinished = path;
  unfinished += ".unfinished";
  std::ofstream file(unfinished);
  file << port << '\n';
  file.close();
  std::error_code error;
  if (file) std::filesystem::rename(unfinished, path, error);
  if (file && !error) return {};
  return Error{ErrorCode::kUnavailable,
               fmt::format("port-file {} cannot be written", path.string()), "port-file"};
}

}  // namespace mane::app
