#include "rpc/credentials.h"

#include <grpcpp/security/auth_metadata_processor.h>

#include <string>

#include "base/check.h"

namespace mane::rpc {
namespace {

// Compares in a time that depends on lengths only.
bool SameSecret(const std::string& a, const grpc::string_ref& b) {
  if (a.size() != b.size()) return false;
  unsigned difference = 0;
  for (size_t i = 0; i < a.size(); ++i) {
    difference |= static_cast<unsigned char>(a[i]) ^ static_cast<unsigned char>(b.data()[i]);
  }
  return difference == 0;
}

class TokenProcessor final : public grpc::AuthMetadataProcessor {
 public:
  explicit TokenProcessor(const std::string& token) : expected_("Bearer " + token) {}

  [[nodiscard]] bool IsBlocking() const override { return false; }

  grpc::Status Process(const InputMetadata& metadata, grpc::AuthContext* /*context*/,
                       OutputMetadata* consumed, OutputMetadata* /*response*/) override {
    const auto sent = metadata.find("authorization");
    if (sent == metadata.end() || !SameSecret(expected_, sent->second)) {
      return {grpc::StatusCode::UNAUTHENTICATED,
              "this server wants metadata `authorization: Bearer <token>`"};
    }
    consumed->emplace("authorization", std::string(sent->second.data(), sent->second.size()));
    return grpc::Status::OK;
  }

 private:
  const std::string expected_;
};

}  // namespace

std::shared_ptr<grpc::ServerCredentials> MakeCredentials(const ServerOptions& options) {
  MANE_CHECK(options.token.empty() || options.tls);
  if (!options.tls) return grpc::InsecureServerCredentials();
  grpc::SslServerCredentialsOptions tls;
  tls.pem_key_cert_pairs.push_back({options.tls->key, options.tls->certificate});
  auto credentials = grpc::SslServerCredentials(tls);
  if (!options.token.empty()) {
    credentials->SetAuthMetadataProcessor(std::make_shared<TokenProcessor>(options.token));
  }
  return credentials;
}

}  // namespace mane::rpc
