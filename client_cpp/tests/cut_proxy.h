#pragma once

#include <atomic>
#include <mutex>
#include <thread>
#include <utility>
#include <vector>

namespace mane::client_test {

/// Forwards TCP on loopback to a port, and can cut what it forwards: to the server, that is a
/// client whose network broke.
class CutProxy {
 public:
  explicit CutProxy(int target_port);
  ~CutProxy();

  int port() const { return port_; }
  void Cut();  ///< Closes every connection; new ones are accepted.

 private:
  void Accept();
  void Forward(int from, int to);
  void CutLocked();

  const int target_port_;
  int port_ = 0;
  int listener_ = -1;
  std::atomic<bool> stopping_ = false;
  std::mutex mutex_;
  std::vector<int> sockets_;  // Guarded by mutex_; shut down by Cut(), closed at the end.
  std::vector<std::thread> forwarders_;  // Guarded by mutex_.
  std::thread acceptor_;
};

}  // namespace mane::client_test
