#include "app/health_check.h"

#include <grpcpp/generic/generic_stub.h>
#include <grpcpp/grpcpp.h>
#include <grpcpp/security/tls_certificate_provider.h>
#include <grpcpp/security/tls_certificate_verifier.h>
#include <grpcpp/security/tls_credentials_options.h>

#include <chrono>
#include <memory>

#include "app/server_options.h"

namespace mane::app {
namespace {

// grpc.health.v1.HealthCheckResponse { status: SERVING } on the wire; the request for the server as
// a whole is an empty message.
constexpr std::string_view kServing = "\x08\x01";

// Trusts exactly the server's own certificate, under whatever name it is reached.
std::shared_ptr<grpc::ChannelCredentials> Credentials(const rpc::ServerOptions& server) {
  if (!server.tls) return grpc::InsecureChannelCredentials();
  grpc::experimental::TlsChannelCredentialsOptions options;
  options.set_certificate_provider(
      std::make_shared<grpc::experimental::StaticDataCertificateProvider>(server.tls->certificate));
  options.watch_root_certs();
  options.set_check_call_host(false);
  options.set_certificate_verifier(std::make_shared<grpc::experimental::NoOpCertificateVerifier>());
  return grpc::experimental::TlsCredentials(options);
}

// Where a client reaches a server that listens on `listen`.
std::string Reachable(const std::string& listen) {
  for (const std::string_view any : {"0.0.0.0:", "[::]:"}) {
    if (listen.starts_with(any)) return "127.0.0.1:" + listen.substr(any.size());
  }
  return listen;
}

}  // namespace

Result<void> CheckHealth(const Options& options) {
  const Result<rpc::ServerOptions> server = ToServerOptions(options);
  if (!server) return server.error();
  const std::string address = Reachable(options.listen);
  grpc::GenericStub stub(grpc::CreateChannel(address, Credentials(*server)));
  grpc::ClientContext context;
  context.set_deadline(std::chrono::system_clock::now() + std::chrono::seconds(5));
  if (!server->token.empty()) context.AddMetadata("authorization", "Bearer " + server->token);

  grpc::CompletionQueue queue;
  grpc::ByteBuffer response;
  grpc::Status status;
  const grpc::Slice nothing;
  const auto call = stub.PrepareUnaryCall(&context, "/grpc.health.v1.Health/Check",
                                          grpc::ByteBuffer(&nothing, 1), &queue);
  call->StartCall();
  call->Finish(&response, &status, nullptr);
  void* tag = nullptr;
  bool ok = false;
  queue.Next(&tag, &ok);

  grpc::Slice answer;
  if (status.ok() && response.DumpToSingleSlice(&answer).ok() &&
      std::string_view(reinterpret_cast<const char*>(answer.begin()), answer.size()) == kServing) {
    return {};
  }
  return Error{ErrorCode::kUnavailable,
               status.ok() ? fmt::format("{} does not serve", address)
                           : fmt::format("{}: {}", address, status.error_message()),
               "listen"};
}

}  // namespace mane::app
