// maned: reads its configuration, starts the server, and drains it when told to stop.

#include <pthread.h>
#include <signal.h>
#include <spdlog/spdlog.h>
#include <sys/resource.h>
#include <unistd.h>

#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <string>

#include "app/config.h"
#include "app/health_check.h"
#include "app/logging.h"
#include "app/port_file.h"
#include "app/server_options.h"
#include "app/settings.h"
#include "rpc/server.h"
#include "simd/isa.h"

namespace mane::app {
namespace {

constexpr int kUsageError = 2;
constexpr unsigned kLastResortSeconds = 10;

std::optional<std::string> FromEnvironment(const std::string& name) {
  const char* value = std::getenv(name.c_str());  // NOLINT(concurrency-mt-unsafe)
  return value == nullptr ? std::nullopt : std::optional<std::string>(value);
}

// SIGTERM and SIGINT, held back from every thread that starts after the constructor.
class StopSignals {
 public:
  StopSignals() {
    sigemptyset(&set_);
    sigaddset(&set_, SIGTERM);
    sigaddset(&set_, SIGINT);
    pthread_sigmask(SIG_BLOCK, &set_, nullptr);
  }

  // Waits for the first one. A second one ends the process at once, as it does by default.
  int Wait() {
    int signal = 0;
    sigwait(&set_, &signal);
    pthread_sigmask(SIG_UNBLOCK, &set_, nullptr);
    return signal;
  }

 private:
  sigset_t set_;
};

// A connection takes a descriptor, and a listener that runs out of them never recovers.
void RaiseDescriptorLimit() {
  rlimit limit{};
  if (getrlimit(RLIMIT_NOFILE, &limit) != 0) return;
  limit.rlim_cur = limit.rlim_max;
  if (setrlimit(RLIMIT_NOFILE, &limit) != 0) {
    spdlog::warn("event=descriptor_limit_kept limit={}", limit.rlim_cur);
  }
}

int Fail(const Error& error) {
  spdlog::error("event=start_failed field={} message=\"{}\"", error.field, error.message);
  return EXIT_FAILURE;
}

int Serve(const Options& options) {
  StopSignals signals;
  SetUpLogging(options.log_level);
  const Result<simd::Isa> isa = simd::Choose(FromEnvironment("MANE_ISA").value_or(""));
  if (!isa) return Fail(isa.error());
  spdlog::info("event=configuration version=" MANE_VERSION " isa={} {}", simd::Name(*isa),
               Describe(options));
  if (!IsLoopback(options.listen) && options.insecure_non_loopback) {
    spdlog::warn(
        "event=insecure_listener listen={} tls={} token={} message=\"anyone who reaches this "
        "address "
        "can use the server; allowed by insecure-non-loopback\"",
        options.listen, !options.tls_cert.empty(), !options.token_file.empty());
  }
  RaiseDescriptorLimit();
  std::signal(SIGXFSZ, SIG_IGN);  // A file at its size limit is an error of the write, not the end.

  const Result<rpc::ServerOptions> server_options = ToServerOptions(options);
  if (!server_options) return Fail(server_options.error());
  const Result<std::unique_ptr<rpc::Server>> server = rpc::Server::Start(*server_options);
  if (!server) return Fail(server.error());
  if (!options.port_file.empty()) {
    const Result<void> written = WritePortFile(options.port_file, (*server)->port());
    if (!written) return Fail(written.error());
  }
  spdlog::info("event=listening port={}", (*server)->port());

  const int signal = signals.Wait();
  spdlog::info("event=draining signal={} grace_s={}", signal, options.drain_grace_s);
  // What is computed for long, such as a huge groom's rest shape, is not waited for: everything
  // acknowledged is on disk, so dying by SIGALRM loses nothing.
  alarm(static_cast<unsigned>(options.drain_grace_s) + kLastResortSeconds);
  (*server)->Drain(options.drain_grace_s);
  spdlog::info("event=stopped");
  return EXIT_SUCCESS;
}

int Run(std::span<const char* const> arguments) {
  const Result<Invocation> invocation = ReadInvocation(arguments, FromEnvironment);
  if (!invocation) {
    std::fprintf(stderr, "maned: %s\n", invocation.error().message.c_str());
    return kUsageError;
  }
  switch (invocation->action) {
    case Invocation::Action::kPrint:
      std::fputs(invocation->text.c_str(), stdout);
      return EXIT_SUCCESS;
    case Invocation::Action::kCheckHealth: {
      const Result<void> healthy = CheckHealth(invocation->options);
      if (healthy) return EXIT_SUCCESS;
      std::fprintf(stderr, "maned: %s\n", healthy.error().message.c_str());
      return EXIT_FAILURE;
    }
    case Invocation::Action::kServe:
      return Serve(invocation->options);
  }
  return EXIT_FAILURE;
}

}  // namespace
}  // namespace mane::app

int main(int argc, char** argv) {
  try {
    return mane::app::Run({argv, static_cast<size_t>(argc)});
  } catch (const std::exception& error) {
    std::fprintf(stderr, "maned: %s\n", error.what());
    return EXIT_FAILURE;
  }
}
