#pragma once

#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <condition_variable>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "groom/assemble.h"
#include "head/sample_groom.h"
#include "session/registry.h"

/// Heads and their clients that the tests of this folder share.
namespace mane::session {

/// How long a test waits for what must happen.
inline constexpr std::chrono::seconds kPatience{20};

/// Whether `done` came true in time.
[[nodiscard]] inline bool WaitUntil(const std::function<bool()>& done) {
  const auto deadline = std::chrono::steady_clock::now() + kPatience;
  while (!done()) {
    if (std::chrono::steady_clock::now() > deadline) return false;
    std::this_thread::yield();
  }
  return true;
}

/// A stream that takes all frames as they come, and lets a test wait for what it wants to see.
class TestStream final : public FrameSink {
 public:
  void Follow(std::shared_ptr<HeadSession> head) {
    std::lock_guard lock(mutex_);
    head_ = std::move(head);
  }
  void OnProgress() override {
    std::lock_guard lock(mutex_);
    if (head_ == nullptr || paused_) return;
    for (OutgoingFrame out = head_->TakeFrame(); out.frame; out = head_->TakeFrame()) {
      frames_.push_back(out.frame);
      skipped_ += out.skipped;
    }
    changed_.notify_all();
  }
  void OnNotice(const Notice& notice) override {
    std::lock_guard lock(mutex_);
    notices_.push_back(notice);
    changed_.notify_all();
  }
  void OnEnd(const Error& error) override {
    std::lock_guard lock(mutex_);
    end_ = error;
    changed_.notify_all();
  }

  [[nodiscard]] bool WaitFor(const std::function<bool(const TestStream&)>& done) {
    std::unique_lock lock(mutex_);
    return changed_.wait_for(lock, kPatience, [&] { return done(*this); });
  }
  [[nodiscard]] bool WaitForFrames(size_t count) {
    return WaitFor([count](const TestStream& s) { return s.frames_.size() >= count; });
  }
  [[nodiscard]] std::vector<FramePtr> frames() {
    std::lock_guard lock(mutex_);
    return frames_;
  }

  /// Guarded by mutex_; read by conditions, or when the head is quiet.
  std::vector<FramePtr> frames_;
  std::vector<Notice> notices_;
  std::optional<Error> end_;
  uint32_t skipped_ = 0;
  bool paused_ = false;

 private:
  std::mutex mutex_;
  std::condition_variable changed_;
  std::shared_ptr<HeadSession> head_;
};

/// head::SampleGroom with a shoulder, fixed to the head, and two hands that move.
[[nodiscard]] inline std::shared_ptr<const groom::Groom> SampleGroomWithBodies(int guides,
                                                                               int elements) {
  groom::Parts parts;
  parts.guides = head::SampleGroom(guides, elements)->guides;
  const groom::Body::Ellipsoid ball{{0.05, 0.06, 0.05}};
  parts.bodies = {{"hand-l", ball, {}, true, {{-0.3, 0, 0}, Eigen::Quaterniond::Identity()}},
                  {"shoulder", ball, {}, false, {{0, -0.3, 0}, Eigen::Quaterniond::Identity()}},
                  {"hand-r", ball, {}, true, {{0.3, 0, 0}, Eigen::Quaterniond::Identity()}}};
  return *groom::Assemble(std::move(parts), {}, nullptr);
}

/// A groom of twelve guides of four elements, and workers for its heads.
class RegistryTest : public ::testing::Test {
 protected:
  std::shared_ptr<HeadSession> Open(Registry& registry, TestStream& stream, Pacing pacing,
                                    const std::string& request_id = "") {
    HeadOptions options;
    options.pacing = pacing;
    options.rate_hz = 120;
    const auto opened = registry.Open({groom_}, options, request_id, &stream);
    EXPECT_TRUE(opened) << (opened ? "" : opened.error().message);
    if (!opened) return nullptr;
    token_ = opened->resume_token;
    stream.Follow(opened->head);
    return opened->head;
  }

  static PoseCommand Pose(int i) {
    return {i / 60.0, {{0.05 * std::sin(0.3 * i), 0, 0}, Eigen::Quaterniond::Identity()}};
  }

  exec::WorkerPool pool_{2};
  std::shared_ptr<const groom::Groom> groom_ = head::SampleGroom(12, 4, head::SampleHair::kPlain);
  std::string token_;
};

}  // namespace mane::session
