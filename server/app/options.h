#pragma once

#include <string>
#include <string_view>

#include "base/result.h"

namespace mane::app {

/// Everything an operator can set, with its default. settings.h lists the names under which flags,
/// the environment and the configuration file set each field, and the allowed ranges.
struct Options {
  /// `host:port`; port 0 takes any free port (see `port_file`). Off loopback the server wants
  /// `tls_cert`, `tls_key` and `token_file`, or `insecure_non_loopback`.
  std::string listen = "127.0.0.1:7420";
  /// Folder of grooms, jobs and results; made if missing, locked against a second server.
  std::string data_dir = "mane-data";
  /// File that receives the port once the server listens; empty for none.
  std::string port_file;

  /// Threads that compute hair; 0 is one per core. More than there are cores only adds latency.
  int workers = 0;
  /// Heads open at once, those that wait for their client included. Another one is refused with
  /// RESOURCE_EXHAUSTED; each takes about 350 bytes an element.
  int max_heads = 1000;
  /// Guides of one groom; bounds the memory and the time that one client can take.
  int max_groom_guides = 20'000;
  /// How long a head waits for its broken stream to come back [s]. Longer rides over longer
  /// outages, and keeps the memory of vanished clients longer.
  double resume_grace_s = 10;
  /// Largest message that a client may send [bytes]. A bake of 16,000 poses takes just under 1 MiB;
  /// grooms travel in pieces.
  int max_message_bytes = 1 << 20;

  /// PEM files; both or none. With them the server speaks TLS only.
  std::string tls_cert;
  std::string tls_key;
  /// File with the token that every call must carry (`authorization: Bearer ...`); empty for none.
  /// Needs TLS.
  std::string token_file;
  /// Allows listening off loopback without TLS or without a token, where the network itself is
  /// private, such as behind a proxy in one pod.
  bool insecure_non_loopback = false;

  /// Time that running streams get to end after SIGTERM [s].
  double drain_grace_s = 10;
  /// `debug`, `info`, `warning` or `error`.
  std::string log_level = "info";

  /// kInvalidArgument naming the setting, its value and what is allowed.
  [[nodiscard]] Result<void> Validate() const;
};

/// Whether only this machine can reach `listen`: localhost, 127.0.0.0/8 or [::1]. False for any
/// other name, for it may resolve to anything.
[[nodiscard]] bool IsLoopback(std::string_view listen);

}  // namespace mane::app
