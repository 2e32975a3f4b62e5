#include "daemon.h"

#include <fcntl.h>
#include <signal.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <fstream>
#include <stdexcept>
#include <system_error>
#include <thread>
#include <vector>

extern char** environ;

namespace mane::client_test {
namespace {

namespace fs = std::filesystem;

fs::path NewFolder() {
  std::string name = (fs::temp_directory_path() / "mane-client-XXXXXX").string();
  if (!mkdtemp(name.data())) throw std::system_error(errno, std::generic_category(), name);
  return name;
}

pid_t Spawn(std::vector<std::string> arguments) {
  std::vector<char*> argv;
  for (std::string& argument : arguments) argv.push_back(argument.data());
  argv.push_back(nullptr);
  pid_t pid = 0;
  const int failure = posix_spawn(&pid, argv[0], nullptr, nullptr, argv.data(), environ);
  if (failure) throw std::system_error(failure, std::generic_category(), arguments[0]);
  return pid;
}

}  // namespace

Daemon::Daemon() : folder_(NewFolder()) { Start(); }

Daemon::~Daemon() {
  if (pid_) {
    kill(pid_, SIGCONT);
    kill(pid_, SIGTERM);
    if (!Reap(20)) {
      kill(pid_, SIGKILL);
      Reap(30);
    }
  }
  std::error_code ignored;
  fs::remove_all(folder_, ignored);
}

void Daemon::Start() {
  const fs::path port_file = folder_ / "port";
  fs::remove(port_file);
  pid_ = Spawn({MANED_PATH, "--listen", "127.0.0.1:" + std::to_string(port_), "--data-dir",
                (folder_ / "data").string(), "--port-file", port_file.string(), "--drain-grace-s",
                "0", "--log-level", "warning"});
  AwaitPort(port_file);
}

void Daemon::AwaitPort(const fs::path& port_file) {
  const bool up = Eventually([&] {
    if (Reap(0)) throw std::runtime_error("maned ended while it was starting");
    return static_cast<bool>(std::ifstream(port_file) >> port_);
  });
  if (up) return;
  Kill();
  throw std::runtime_error("maned wrote no port file");
}

void Daemon::Kill() {
  kill(pid_, SIGKILL);
  if (!Reap(30)) throw std::runtime_error("maned survived SIGKILL");
}

void Daemon::Stop() { kill(pid_, SIGSTOP); }

void Daemon::Continue() { kill(pid_, SIGCONT); }

bool Daemon::Reap(double seconds) {
  const auto deadline = std::chrono::steady_clock::now() + std::chrono::duration<double>(seconds);
  while (waitpid(pid_, nullptr, WNOHANG) == 0) {
    if (std::chrono::steady_clock::now() >= deadline) return false;
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  pid_ = 0;
  return true;
}

Client Daemon::Connect() const {
  ClientOptions options;
  options.address = "127.0.0.1:" + std::to_string(port_);
  options.connect_timeout = std::chrono::seconds(20);
  auto client = Client::Connect(options);
  if (!client) throw std::runtime_error(client.error().message);
  return *std::move(client);
}

bool Eventually(const std::function<bool()>& condition) {
  const auto deadline = std::chrono::steady_clock::now() + std::chrono::seconds(30);
  while (!condition()) {
    if (std::chrono::steady_clock::now() > deadline) return false;
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  return true;
}

}  // namespace mane::client_test
