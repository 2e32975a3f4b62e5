#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "base/result.h"
#include "rpc/limits.h"

namespace mane::rpc {

/// Certificates as PEM text.
struct Tls {
  std::string certificate;  ///< Chain, leaf first.
  std::string key;
};

struct ServerOptions {
  std::string listen = "127.0.0.1:7420";  ///< host:port; port 0 takes a free one.
  std::string data_dir = {};              ///< Created when missing; one server at a time.
  int workers = 2;                        ///< Threads that animate, 1 to 1024.
  int max_heads = 1000;                   ///< See session::RegistryOptions.
  int max_groom_guides = 20000;           ///< Per groom.
  double resume_grace_s = 10;             ///< See session::RegistryOptions.
  int max_uploads = kMaxUploads;          ///< See UploadLimits.
  double max_upload_idle_s = kMaxUploadIdle;
  int max_message_bytes = 1 << 20;  ///< Received messages; more is RESOURCE_EXHAUSTED.
  std::optional<Tls> tls = {};      ///< Plain text without.
  std::string token = {};  ///< Clients must send `authorization: Bearer <token>`; needs TLS.
};

/// The whole daemon behind its port: stores, jobs, heads, services.
///
/// Threads: Start and Drain from one thread; what runs inside has its own.
class Server {
 public:
  /// Serves when it returns. kUnavailable or kFailedPrecondition when the port or the data folder
  /// cannot be had.
  static Result<std::unique_ptr<Server>> Start(const ServerOptions& options);
  /// Stops at once.
  virtual ~Server() = default;

  [[nodiscard]] virtual int port() const = 0;

  /// Stops gently: health says NOT_SERVING, clients are told to reconnect, and after `grace_s` [s],
  /// or when no head is left, every stream ends. Running jobs go back to the queue. Returns when
  /// nothing runs.
  virtual void Drain(double grace_s) = 0;
};

}  // namespace mane::rpc
