#pragma once

#include <sys/types.h>

#include <filesystem>
#include <functional>
#include <string>

#include "mane/client.h"

namespace mane::client_test {

/// The real `maned` on loopback with a data folder of its own. Throws when it does not come up.
class Daemon {
 public:
  Daemon();   ///< Started on a free port.
  ~Daemon();  ///< SIGTERM, or kill -9 when that takes too long; the folder goes too.

  void Kill();      ///< kill -9, and waits until it is gone.
  void Start();     ///< Again, on the same folder and port.
  void Stop();      ///< SIGSTOP: it stays connected and says nothing more.
  void Continue();  ///< SIGCONT.

  int port() const { return port_; }
  Client Connect() const;

 private:
  bool Reap(double seconds);  // Waits for its end.
  void AwaitPort(const std::filesystem::path& port_file);

  std::filesystem::path folder_;
  int port_ = 0;
  pid_t pid_ = 0;
};

/// Polls until `condition` holds; false after 30 s.
bool Eventually(const std::function<bool()>& condition);

}  // namespace mane::client_test
