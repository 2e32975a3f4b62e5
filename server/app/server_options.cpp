#include "app/server_options.h"

#include <algorithm>
#include <fstream>
#include <iterator>
#include <thread>
#include <utility>

namespace mane::app {
namespace {

constexpr size_t kShortestToken = 16;

// Cores of this machine; 1 when the system does not say.
int CoreCount() { return std::max(1, static_cast<int>(std::thread::hardware_concurrency())); }

Result<std::string> ReadSecret(const std::string& setting, const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  std::string text((std::istreambuf_iterator<char>(file)), std::istreambuf_iterator<char>());
  if (!file || text.empty()) {
    return Error{ErrorCode::kUnavailable,
                 fmt::format("{} {} cannot be read or is empty", setting, path), setting};
  }
  return text;
}

Result<std::string> ReadToken(const std::string& path) {
  Result<std::string> token = ReadSecret("token-file", path);
  if (!token) return token;
  while (!token->empty() && (token->back() == '\n' || token->back() == '\r')) token->pop_back();
  const bool printable =
      std::all_of(token->begin(), token->end(), [](char c) { return c > ' ' && c < '\x7f'; });
  if (token->size() >= kShortestToken && printable) return token;
  return InvalidArgument(
      "token-file",
      fmt::format("token-file {} holds {} bytes; it must hold one line of at least {} printable "
                  "ASCII characters without spaces",
                  path, token->size(), kShortestToken));
}

}  // namespace

Result<rpc::ServerOptions> ToServerOptions(const Options& options) {
  rpc::ServerOptions result;
  result.listen = options.listen;
  result.data_dir = options.data_dir;
  result.workers = options.workers > 0 ? options.workers : CoreCount();
  result.max_heads = options.max_heads;
  result.max_groom_guides = options.max_groom_guides;
  result.resume_grace_s = options.resume_grace_s;
  result.max_message_bytes = options.max_message_bytes;
  if (!options.tls_cert.empty()) {
    Result<std::string> cert = ReadSecret("tls-cert", options.tls_cert);
    if (!cert) return cert.error();
    Result<std::string> key = ReadSecret("tls-key", options.tls_key);
    if (!key) return key.error();
    result.tls = rpc::Tls{*std::move(cert), *std::move(key)};
  }
  if (!options.token_file.empty()) {
    Result<std::string> token = ReadToken(options.token_file);
    if (!token) return token.error();
    result.token = *std::move(token);
  }
  return result;
}

}  // namespace mane::app
