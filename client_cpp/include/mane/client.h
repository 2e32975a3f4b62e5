#pragma once

#include <chrono>
#include <memory>
#include <string>
#include <vector>

#include "mane/error.h"
#include "mane/geometry.h"
#include "mane/groom.h"
#include "mane/head.h"

namespace mane::inline client {

struct ClientOptions {
  std::string address = "127.0.0.1:7420";  ///< host:port
  /// PEM file with the certificates that may sign the server's; empty for a plain connection.
  std::string tls_ca_file = {};
  /// Sent with every call as `authorization: Bearer {token}`; empty for none. Needs TLS or loopback
  /// to stay secret.
  std::string token = {};
  std::chrono::milliseconds connect_timeout{5'000};
  std::chrono::milliseconds call_timeout{60'000};  ///< For each groom call.
  /// A silent connection is probed after the interval and given up after the timeout.
  std::chrono::milliseconds keepalive_interval{10'000};
  std::chrono::milliseconds keepalive_timeout{5'000};
};

/// A connection to one `maned`. Thread-safe; movable. Heads outlive it. Groom calls wait for their
/// answer; one Client is one TCP connection, so use several for more than a hundred heads.
class Client {
 public:
  /// Connects, waiting at most `connect_timeout`. kUnavailable when the server does not answer,
  /// kInvalidArgument when `tls_ca_file` cannot be read.
  static Result<Client> Connect(const ClientOptions& options);

  Client(Client&&) noexcept;
  Client& operator=(Client&&) noexcept;
  ~Client();

  /// Uploads, imports or generates a groom; when it returns, the groom is validated and on the
  /// server's disk. kInvalidArgument names the field (`guides[12].length_m`). An import takes 10 to
  /// 100 ms a strand, some times that with an error bound; `call_timeout` is to allow for it.
  Result<GroomInfo> CreateGroom(const GroomUpload& upload);
  /// @param name  `grooms/{groom}`, here and below.
  Result<GroomInfo> GetGroom(const std::string& name);
  /// All grooms, by name.
  Result<std::vector<GroomInfo>> ListGrooms();
  /// Heads that animate the groom go on with their copy.
  Result<void> DeleteGroom(const std::string& name);
  /// The hairs that ride on the guides; none for a groom without.
  Result<GroomHairs> GetHairs(const std::string& name);
  /// kFailedPrecondition if the groom was not made from strands.
  Result<ImportReport> GetImportReport(const std::string& name);
  Result<RestShape> ComputeRestShape(const std::string& name, const RestShapeOptions& options = {});

  /// Starts to animate a head and returns at once, in HeadState::kConnecting.
  Head OpenHead(const HeadOptions& options);

 private:
  class Impl;
  explicit Client(std::unique_ptr<Impl> impl);

  std::unique_ptr<Impl> impl_;
};

}  // namespace mane::inline client
