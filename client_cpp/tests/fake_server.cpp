#include "fake_server.h"

#include <chrono>
#include <stdexcept>
#include <thread>
#include <utility>

namespace mane::client_test {

FakeServer::FakeServer(Script script) : script_(std::move(script)) {
  grpc::ServerBuilder builder;
  builder.AddListeningPort("127.0.0.1:0", grpc::InsecureServerCredentials(), &port_);
  builder.RegisterService(this);
  server_ = builder.BuildAndStart();
}

FakeServer::~FakeServer() {
  server_->Shutdown(std::chrono::system_clock::now() + std::chrono::seconds(1));
  server_->Wait();
}

Client FakeServer::Connect() const {
  ClientOptions options;
  options.address = "127.0.0.1:" + std::to_string(port_);
  auto client = Client::Connect(options);
  if (!client) throw std::runtime_error(client.error().message);
  return *std::move(client);
}

grpc::Status FakeServer::Animate(grpc::ServerContext* context, Stream* stream) {
  return script_(calls_++, *context, *stream);
}

v1::AnimateResponse Opened(const std::string& token, std::uint64_t next_frame) {
  v1::AnimateResponse response;
  v1::Opened& opened = *response.mutable_opened();
  opened.set_resume_token(token);
  opened.set_guide_count(1);
  opened.set_element_count(1);
  opened.set_points_per_guide(2);
  opened.set_format(v1::FRAME_FORMAT_POSITIONS_FLOAT32);
  opened.set_space(v1::SPACE_WORLD);
  opened.set_next_frame(next_frame);
  return response;
}

v1::AnimateResponse HairFrame(std::uint64_t index, double time_s) {
  v1::AnimateResponse response;
  response.mutable_frame()->set_index(index);
  response.mutable_frame()->set_time_s(time_s);
  response.mutable_frame()->set_data(std::string(24, '\0'));
  return response;
}

bool Eventually(const std::function<bool()>& condition) {
  const auto deadline = std::chrono::steady_clock::now() + std::chrono::seconds(20);
  while (!condition()) {
    if (std::chrono::steady_clock::now() > deadline) return false;
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  return true;
}

}  // namespace mane::client_test
