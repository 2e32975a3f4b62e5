#include "transport.h"

#include <fmt/format.h>

#include <fstream>
#include <iterator>
#include <utility>

namespace mane::inline client {
namespace {

// Largest answer: a rest shape or a frame of ten thousand guides at 256 points.
constexpr int kMaxReceiveBytes = 256 << 20;
constexpr int kMinReconnectMs = 100;
constexpr int kMaxReconnectMs = 2000;

grpc::ChannelArguments Arguments(const ClientOptions& options) {
  grpc::ChannelArguments arguments;
  arguments.SetInt(GRPC_ARG_KEEPALIVE_TIME_MS,
                   static_cast<int>(options.keepalive_interval.count()));
  arguments.SetInt(GRPC_ARG_KEEPALIVE_TIMEOUT_MS,
                   static_cast<int>(options.keepalive_timeout.count()));
  // A LOCKSTEP head may be silent for as long as its user thinks.
  arguments.SetInt(GRPC_ARG_HTTP2_MAX_PINGS_WITHOUT_DATA, 0);
  arguments.SetInt(GRPC_ARG_INITIAL_RECONNECT_BACKOFF_MS, kMinReconnectMs);
  arguments.SetInt(GRPC_ARG_MIN_RECONNECT_BACKOFF_MS,
                   static_cast<int>(options.connect_timeout.count()));
  arguments.SetInt(GRPC_ARG_MAX_RECONNECT_BACKOFF_MS, kMaxReconnectMs);
  arguments.SetInt(GRPC_ARG_USE_LOCAL_SUBCHANNEL_POOL, 1);  // Each Client has its own connection.
  arguments.SetMaxReceiveMessageSize(kMaxReceiveBytes);
  return arguments;
}

Result<std::shared_ptr<grpc::ChannelCredentials>> Credentials(const std::string& ca_file) {
  if (ca_file.empty()) return grpc::InsecureChannelCredentials();
  std::ifstream file(ca_file, std::ios::binary);
  grpc::SslCredentialsOptions options;
  options.pem_root_certs.assign(std::istreambuf_iterator<char>(file), {});
  if (!file || options.pem_root_certs.empty()) {
    return Error{ErrorCode::kInvalidArgument,
                 fmt::format("tls_ca_file '{}' cannot be read or is empty", ca_file),
                 "tls_ca_file"};
  }
  return grpc::SslCredentials(options);
}

}  // namespace

Result<std::shared_ptr<Transport>> Transport::Connect(const ClientOptions& options) {
  auto credentials = Credentials(options.tls_ca_file);
  if (!credentials) return credentials.error();
  auto channel = grpc::CreateCustomChannel(options.address, *credentials, Arguments(options));
  if (!channel->WaitForConnected(std::chrono::system_clock::now() + options.connect_timeout)) {
    return Error{ErrorCode::kUnavailable,
                 fmt::format("no answer from '{}' within {} ms", options.address,
                             options.connect_timeout.count()),
                 "address"};
  }
  return std::shared_ptr<Transport>(new Transport(channel, options.token, options.call_timeout));
}

Transport::Transport(const std::shared_ptr<grpc::Channel>& channel, std::string token,
                     std::chrono::milliseconds call_timeout)
    : grooms_(v1::GroomService::NewStub(channel)),
      animation_(v1::AnimationService::NewStub(channel)),
      token_(std::move(token)),
      call_timeout_(call_timeout) {}

void Transport::Authorize(grpc::ClientContext& context) const {
  if (!token_.empty()) context.AddMetadata("authorization", "Bearer " + token_);
}

void Transport::PrepareCall(grpc::ClientContext& context) const {
  Authorize(context);
  context.set_deadline(std::chrono::system_clock::now() + call_timeout_);
}

}  // namespace mane::inline client
