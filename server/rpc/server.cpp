#include "rpc/server.h"

#include <grpcpp/ext/proto_server_reflection_plugin.h>
#include <grpcpp/grpcpp.h>
#include <grpcpp/health_check_service_interface.h>
#include <spdlog/spdlog.h>

#include <chrono>
#include <condition_variable>
#include <mutex>

#include "jobs/queue.h"
#include "rpc/animation_service.h"
#include "rpc/bake_service.h"
#include "rpc/credentials.h"
#include "rpc/groom_service.h"
#include "rpc/job_service.h"
#include "rpc/styling_service.h"
#include "rpc/uploads.h"
#include "session/registry.h"
#include "storage/data_folder.h"

namespace mane::rpc {
namespace {

// Threads for requests that read the disk, and for those that compute for long: neither may hold up
// the animation, nor the second the first.
constexpr int kRequestWorkers = 2;
constexpr int kSolvingWorkers = 2;
// Element-steps a second of real-time heads that one worker is trusted with: about a quarter of
// what a core steps with vector kernels (session/admission.h), which leaves room for streaming, for
// heads that fall due at once and for estimates that are wrong.
constexpr double kElementStepsPerWorker = 5e6;
// How often a draining server looks whether the clients have gone.
constexpr auto kDrainPoll = std::chrono::milliseconds(50);
// How long streams get to end once they were told to.
constexpr auto kShutdownGrace = std::chrono::seconds(2);

// Everything behind the port. Members die in reverse order: the port first, the disk last.
class RunningServer final : public Server {
 public:
  RunningServer(const ServerOptions& options, storage::DataFolder folder,
                std::unique_ptr<storage::GroomStore> groom_store,
                std::unique_ptr<storage::JobStore> job_store)
      : folder_(std::move(folder)),
        groom_store_(std::move(groom_store)),
        job_store_(std::move(job_store)),
        realtime_(options.workers),
        lockstep_(options.workers),
        requests_(kRequestWorkers),
        solving_(kSolvingWorkers),
        bodies_(BodyOptions(options)),
        grooms_(*groom_store_, solving_, bodies_, GroomLimits(options)),
        queue_(*job_store_, {}),
        registry_(
            {options.max_heads, options.resume_grace_s, kElementStepsPerWorker * options.workers},
            realtime_, lockstep_),
        uploads_(solving_, {options.max_uploads, options.max_upload_idle_s}),
        groom_service_(grooms_, requests_, solving_, uploads_),
        animation_service_(grooms_, registry_, requests_, options.resume_grace_s),
        job_service_(queue_, requests_),
        bake_service_(grooms_, queue_, *job_store_, solving_, requests_),
        styling_service_(grooms_, queue_, *job_store_, solving_, requests_, uploads_) {}

  ~RunningServer() override { Drain(0); }

  Result<void> Serve(const ServerOptions& options) {
    if (const auto ok = queue_.Start(); !ok) return ok;
    grpc::EnableDefaultHealthCheckService(true);
    grpc::reflection::InitProtoReflectionServerBuilderPlugin();
    grpc::ServerBuilder builder;
    Configure(options, &builder);
    builder.AddListeningPort(options.listen, MakeCredentials(options), &port_);
    builder.RegisterService(&groom_service_);
    builder.RegisterService(&animation_service_);
    builder.RegisterService(&job_service_);
    builder.RegisterService(&bake_service_);
    builder.RegisterService(&styling_service_);
    server_ = builder.BuildAndStart();
    if (server_ == nullptr || port_ == 0) {
      return Error{ErrorCode::kUnavailable,
                   fmt::format("cannot listen on {}: is the address right and the port free?",
                               options.listen),
                   "listen"};
    }
    return {};
  }

  [[nodiscard]] int port() const override { return port_; }

  void Drain(double grace_s) override {
    if (server_ == nullptr) return;
    server_->GetHealthCheckService()->SetServingStatus(false);
    registry_.StopAdmitting();
    registry_.Notify({session::Notice::Code::kDraining, 0});
    WaitForStreams(grace_s);
    queue_.Stop();
    registry_.EndAll({ErrorCode::kUnavailable, "the server is stopping", ""});
    server_->Shutdown(std::chrono::system_clock::now() + kShutdownGrace);
    server_->Wait();
    server_.reset();
    requests_.WaitIdle();
    solving_.WaitIdle();
    bodies_.WaitIdle();
  }

 private:
  static groom::Limits GroomLimits(const ServerOptions& options) {
    groom::Limits limits;
    limits.max_guides = options.max_groom_guides;
    return limits;
  }

  static session::BodyLibraryOptions BodyOptions(const ServerOptions& options) {
    session::BodyLibraryOptions bodies;
    bodies.workers = options.workers;
    return bodies;
  }

  // Reasons in server/ARCHITECTURE.md, Transport.
  static void Configure(const ServerOptions& options, grpc::ServerBuilder* builder) {
    builder->SetMaxReceiveMessageSize(options.max_message_bytes);
    builder->AddChannelArgument(GRPC_ARG_ALLOW_REUSEPORT, 0);
    builder->AddChannelArgument(GRPC_ARG_KEEPALIVE_TIME_MS, 10'000);
    builder->AddChannelArgument(GRPC_ARG_KEEPALIVE_TIMEOUT_MS, 5'000);
    builder->AddChannelArgument(GRPC_ARG_KEEPALIVE_PERMIT_WITHOUT_CALLS, 1);
    builder->AddChannelArgument(GRPC_ARG_HTTP2_MIN_RECV_PING_INTERVAL_WITHOUT_DATA_MS, 5'000);
    builder->AddChannelArgument(GRPC_ARG_SERVER_HANDSHAKE_TIMEOUT_MS, 5'000);
    builder->AddChannelArgument(GRPC_ARG_MAX_CONCURRENT_STREAMS, 128);
  }

  void WaitForStreams(double grace_s) {
    const auto deadline = std::chrono::steady_clock::now() + std::chrono::duration<double>(grace_s);
    std::mutex mutex;
    std::condition_variable never;
    std::unique_lock lock(mutex);
    while (registry_.attached_count() > 0 && std::chrono::steady_clock::now() < deadline) {
      never.wait_for(lock, kDrainPoll);
    }
  }

  storage::DataFolder folder_;
  std::unique_ptr<storage::GroomStore> groom_store_;
  std::unique_ptr<storage::JobStore> job_store_;
  exec::WorkerPool realtime_;
  exec::WorkerPool lockstep_;
  exec::WorkerPool requests_;
  exec::WorkerPool solving_;
  session::BodyLibrary bodies_;
  GroomLibrary grooms_;
  jobs::Queue queue_;
  session::Registry registry_;
  Uploads uploads_;
  GroomService groom_service_;
  AnimationService animation_service_;
  JobService job_service_;
  BakeService bake_service_;
  StylingService styling_service_;
  std::unique_ptr<grpc::Server> server_;
  int port_ = 0;
};

}  // namespace

Result<std::unique_ptr<Server>> Server::Start(const ServerOptions& options) {
  auto folder = storage::DataFolder::Open(options.data_dir);
  if (!folder) return folder.error();
  auto grooms = storage::GroomStore::Open(folder->DatabasePath());
  if (!grooms) return grooms.error();
  auto jobs = storage::JobStore::Open(folder->DatabasePath());
  if (!jobs) return jobs.error();
  auto server = std::make_unique<RunningServer>(options, *std::move(folder), *std::move(grooms),
                                                *std::move(jobs));
  if (const auto ok = server->Serve(options); !ok) return ok.error();
  return std::unique_ptr<Server>(std::move(server));
}

}  // namespace mane::rpc
