// What a head does when things go wrong on the way, against a scripted server.

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <future>
#include <limits>
#include <mutex>
#include <thread>
#include <vector>

#include "fake_server.h"

namespace mane::client_test {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

constexpr seconds kLong{20};

const grpc::Status kBroken(grpc::StatusCode::UNAVAILABLE, "broken on purpose");

HeadOptions Realtime() {
  HeadOptions options;
  options.groom = "grooms/test";
  return options;
}

HeadOptions Lockstep() {
  HeadOptions options = Realtime();
  options.pacing = Pacing::kLockstep;
  return options;
}

// Answers the opening message, which it returns.
v1::AnimateRequest AnswerOpen(FakeServer::Stream& stream, const std::string& token,
                              std::uint64_t next_frame = 1) {
  v1::AnimateRequest open;
  EXPECT_TRUE(stream.Read(&open));
  EXPECT_EQ(open.kind_case(), v1::AnimateRequest::kOpen);
  stream.Write(Opened(token, next_frame));
  return open;
}

// Reads until the client half-closes or leaves.
grpc::Status Drain(FakeServer::Stream& stream) {
  v1::AnimateRequest request;
  while (stream.Read(&request)) {
  }
  return grpc::Status::OK;
}

TEST(HeadStream, AcknowledgesAPolledFrameByItselfWhenNoPoseFollows) {
  std::promise<v1::AnimateRequest> answer;
  FakeServer server([&](int, grpc::ServerContext&, FakeServer::Stream& stream) {
    AnswerOpen(stream, "t");
    stream.Write(HairFrame(5));
    v1::AnimateRequest request;
    stream.Read(&request);
    answer.set_value(request);
    return Drain(stream);
  });
  Client client = server.Connect();
  Head head = client.OpenHead(Realtime());
  ASSERT_TRUE(Eventually([&] { return head.NewestFrame() != nullptr; }));
  auto received = answer.get_future();
  ASSERT_EQ(received.wait_for(kLong), std::future_status::ready);
  const v1::AnimateRequest request = received.get();
  EXPECT_EQ(request.kind_case(), v1::AnimateRequest::kAcknowledge);
  EXPECT_EQ(request.acked_frame(), 5u);
}

TEST(HeadStream, PosesCarryTheAcknowledgement) {
  std::atomic<std::uint64_t> acked = 0, poses = 0;
  FakeServer server([&](int, grpc::ServerContext&, FakeServer::Stream& stream) {
    AnswerOpen(stream, "t");
    stream.Write(HairFrame(3));
    v1::AnimateRequest request;
    while (stream.Read(&request)) {
      if (request.has_pose()) ++poses;
      if (request.has_pose()) acked = request.acked_frame();
    }
    return grpc::Status::OK;
  });
  Client client = server.Connect();
  Head head = client.OpenHead(Realtime());
  double time = 0;
  EXPECT_TRUE(Eventually([&] {
    head.NewestFrame();
    EXPECT_TRUE(head.PushPose(time += 0.01, {}));
    return acked == 3;
  }));
}

TEST(HeadStream, NewestPoseWinsWhileTheServerDoesNotRead) {
  constexpr int kPushed = 30'000;
  std::promise<void> pushed;
  std::vector<double> times;
  std::atomic<bool> newest_arrived = false;
  FakeServer server([&](int, grpc::ServerContext&, FakeServer::Stream& stream) {
    AnswerOpen(stream, "t");
    pushed.get_future().wait_for(kLong);
    v1::AnimateRequest request;
    while (stream.Read(&request)) {
      times.push_back(request.pose().time_s());
      newest_arrived = times.back() == kPushed;
    }
    return grpc::Status::OK;
  });
  Client client = server.Connect();
  Head head = client.OpenHead(Realtime());
  ASSERT_TRUE(head.WaitUntilStreaming(kLong));
  for (int i = 1; i <= kPushed; ++i) ASSERT_TRUE(head.PushPose(i, {}));
  pushed.set_value();
  EXPECT_TRUE(Eventually([&] { return newest_arrived.load(); }));
  head.Close();
  ASSERT_TRUE(Eventually([&] { return !times.empty(); }));
  EXPECT_LT(times.size(), size_t{kPushed} / 2);
  for (size_t i = 1; i < times.size(); ++i) EXPECT_GT(times[i], times[i - 1]);
}

TEST(HeadStream, ResumesABrokenStreamWithTheTokenAndTheEnvironment) {
  std::promise<v1::AnimateRequest> reopened;
  std::promise<v1::AnimateRequest> next;
  FakeServer server([&](int call, grpc::ServerContext&, FakeServer::Stream& stream) {
    v1::AnimateRequest request;
    if (call == 0) {
      AnswerOpen(stream, "token-1");
      stream.Write(HairFrame(1));
      while (stream.Read(&request)) {
        if (request.acked_frame() == 1) return kBroken;
      }
      return grpc::Status::OK;
    }
    reopened.set_value(AnswerOpen(stream, "token-2", 2));
    stream.Read(&request);
    next.set_value(request);
    stream.Write(HairFrame(1));  // Sent again: must not replace anything.
    stream.Write(HairFrame(2));
    return Drain(stream);
  });
  Client client = server.Connect();
  Head head = client.OpenHead(Realtime());
  ASSERT_TRUE(head.SetEnvironment({.wind_velocity = Vector3{4, 0, 0}}));
  std::uint64_t last = 0;
  EXPECT_TRUE(Eventually([&] {
    const auto frame = head.NewestFrame();
    const std::uint64_t index = frame ? frame->index : 0;
    EXPECT_GE(index, last);
    last = index;
    return last == 2;
  }));
  const v1::AnimateRequest open = reopened.get_future().get();
  EXPECT_EQ(open.open().resume(), "token-1");
  EXPECT_EQ(open.acked_frame(), 1u);
  EXPECT_EQ(next.get_future().get().environment().wind_velocity().x(), 4);
  EXPECT_EQ(head.Status().state, HeadState::kStreaming);
  EXPECT_EQ(head.Status().resumes, 1u);
  EXPECT_EQ(head.Status().reopenings, 0u);
}

TEST(HeadStream, OpensAnewAtTheNewestPoseWhenTheServerForgotTheHead) {
  std::promise<v1::AnimateRequest> first, anew;
  FakeServer server([&](int call, grpc::ServerContext&, FakeServer::Stream& stream) {
    if (call == 0) {
      first.set_value(AnswerOpen(stream, "token"));
      stream.Write(HairFrame(100));
      v1::AnimateRequest request;
      while (stream.Read(&request)) {
        if (request.has_pose() && request.acked_frame() == 100) return kBroken;
      }
    }
    if (call == 1) return grpc::Status(grpc::StatusCode::NOT_FOUND, "no such head");
    anew.set_value(AnswerOpen(stream, "other"));
    stream.Write(HairFrame(1));
    v1::AnimateRequest request;
    while (stream.Read(&request)) EXPECT_LE(request.acked_frame(), 1u);
    return grpc::Status::OK;
  });
  Client client = server.Connect();
  Head head = client.OpenHead(Realtime());
  Pose pose;
  pose.position = {1, 2, 3};
  double time = 0;
  EXPECT_TRUE(Eventually([&] {
    head.NewestFrame();
    EXPECT_TRUE(head.PushPose(time += 0.01, pose));
    return head.Status().reopenings == 1;
  }));
  EXPECT_TRUE(Eventually([&] { return head.NewestFrame()->index == 1; }));
  const auto before = first.get_future().get(), after = anew.get_future().get();
  EXPECT_EQ(after.open().groom(), "grooms/test");
  EXPECT_EQ(after.open().resume(), "");
  EXPECT_EQ(after.open().initial_pose().position().z(), 3);
  EXPECT_EQ(after.acked_frame(), 0u);
  EXPECT_NE(after.open().request_id(), before.open().request_id());
  EXPECT_EQ(head.Status().resumes, 0u);
}

TEST(HeadStream, RepeatsALostOpenUnderTheSameRequestId) {
  std::mutex mutex;
  std::vector<std::string> ids;
  FakeServer server([&](int call, grpc::ServerContext&, FakeServer::Stream& stream) {
    v1::AnimateRequest open;
    stream.Read(&open);
    {
      std::lock_guard lock(mutex);
      ids.push_back(open.open().request_id());
    }
    if (call < 2) return kBroken;
    stream.Write(Opened("t"));
    return Drain(stream);
  });
  Client client = server.Connect();
  Head head = client.OpenHead(Realtime());
  EXPECT_TRUE(head.WaitUntilStreaming(kLong));
  std::lock_guard lock(mutex);
  ASSERT_EQ(ids.size(), 3u);
  EXPECT_FALSE(ids[0].empty());
  EXPECT_EQ(ids[0], ids[1]);
  EXPECT_EQ(ids[0], ids[2]);
  EXPECT_EQ(head.Status().reopenings, 0u);
}

TEST(HeadStream, GivesUpAfterTheReconnectTimeout) {
  FakeServer server([&](int, grpc::ServerContext&, FakeServer::Stream&) { return kBroken; });
  Client client = server.Connect();
  HeadOptions options = Realtime();
  options.reconnect_timeout = milliseconds(200);
  Head head = client.OpenHead(options);
  const auto open = head.WaitUntilStreaming(kLong);
  ASSERT_FALSE(open);
  EXPECT_EQ(open.error().code, ErrorCode::kUnavailable);
  EXPECT_EQ(head.Status().state, HeadState::kClosed);
  EXPECT_GE(server.calls(), 2);
}

TEST(HeadStream, DoesNotRetryWhatIsTheCallersFault) {
  FakeServer server([&](int, grpc::ServerContext&, FakeServer::Stream&) {
    return grpc::Status(grpc::StatusCode::INVALID_ARGUMENT, "open.rate_hz = -1, not 1 to 240");
  });
  Client client = server.Connect();
  Head head = client.OpenHead(Realtime());
  const auto open = head.WaitUntilStreaming(kLong);
  ASSERT_FALSE(open);
  EXPECT_EQ(open.error().code, ErrorCode::kInvalidArgument);
  const auto pushed = head.PushPose(1, {});
  ASSERT_FALSE(pushed);
  EXPECT_EQ(pushed.error().message, open.error().message);
  EXPECT_EQ(server.calls(), 1);
}

TEST(HeadStream, LockstepReturnsTheErrorOfABrokenStreamAndDoesNotReconnect) {
  FakeServer server([&](int, grpc::ServerContext&, FakeServer::Stream& stream) {
    AnswerOpen(stream, "t");
    v1::AnimateRequest request;
    stream.Read(&request);
    stream.Write(HairFrame(1, request.pose().time_s()));
    stream.Read(&request);
    return kBroken;
  });
  Client client = server.Connect();
  Head head = client.OpenHead(Lockstep());
  const auto frame = head.Step(0.25, {});
  ASSERT_TRUE(frame);
  EXPECT_EQ((*frame)->time_s, 0.25);
  const auto broken = head.Step(0.5, {});
  ASSERT_FALSE(broken);
  EXPECT_EQ(broken.error().code, ErrorCode::kUnavailable);
  EXPECT_FALSE(head.Step(0.75, {}));
  EXPECT_EQ(head.Status().state, HeadState::kClosed);
  EXPECT_EQ(server.calls(), 1);
}

TEST(HeadStream, AStepWithoutItsFrameEndsWithDeadlineExceeded) {
  FakeServer server([&](int, grpc::ServerContext&, FakeServer::Stream& stream) {
    AnswerOpen(stream, "t");
    return Drain(stream);
  });
  Client client = server.Connect();
  HeadOptions options = Lockstep();
  options.step_timeout = milliseconds(100);
  Head head = client.OpenHead(options);
  ASSERT_TRUE(head.WaitUntilStreaming(kLong));
  const auto step = head.Step(1, {});
  ASSERT_FALSE(step);
  EXPECT_EQ(step.error().code, ErrorCode::kDeadlineExceeded);
  EXPECT_EQ(head.Status().state, HeadState::kClosed);
}

TEST(HeadStream, LockstepSendsChangesBeforeTheirPose) {
  std::vector<v1::AnimateRequest::KindCase> kinds;
  FakeServer server([&](int, grpc::ServerContext&, FakeServer::Stream& stream) {
    AnswerOpen(stream, "t");
    v1::AnimateRequest request;
    std::uint64_t index = 0;
    while (stream.Read(&request)) {
      kinds.push_back(request.kind_case());
      if (request.has_pose() || request.has_teleport()) stream.Write(HairFrame(++index));
    }
    return grpc::Status::OK;
  });
  Client client = server.Connect();
  Head head = client.OpenHead(Lockstep());
  ASSERT_TRUE(head.Reset());
  ASSERT_TRUE(head.Step(1, {}));
  ASSERT_TRUE(head.SetEnvironment({.gravity = Vector3{}}));
  ASSERT_TRUE(head.StepTeleport(2, {}));
  head.Close();
  using Kind = v1::AnimateRequest;
  EXPECT_EQ(kinds, (std::vector{Kind::kReset, Kind::kPose, Kind::kEnvironment, Kind::kTeleport}));
}

TEST(HeadStream, RefusesTimesThatDoNotIncreaseAndCallsOfTheOtherPacing) {
  FakeServer server([&](int, grpc::ServerContext&, FakeServer::Stream& stream) {
    AnswerOpen(stream, "t");
    return Drain(stream);
  });
  Client client = server.Connect();
  Head realtime = client.OpenHead(Realtime());
  ASSERT_TRUE(realtime.PushPose(1, {}));
  for (const double time : {1.0, 0.5, std::numeric_limits<double>::quiet_NaN()}) {
    const auto pushed = realtime.PushPose(time, {});
    ASSERT_FALSE(pushed);
    EXPECT_EQ(pushed.error().code, ErrorCode::kInvalidArgument);
    EXPECT_EQ(pushed.error().field, "time_s");
  }
  EXPECT_TRUE(realtime.Teleport(1.5, {}));
  EXPECT_EQ(realtime.Step(2, {}).error().code, ErrorCode::kFailedPrecondition);
  ASSERT_TRUE(realtime.WaitUntilStreaming(kLong));
  Head lockstep = client.OpenHead(Lockstep());
  ASSERT_TRUE(lockstep.WaitUntilStreaming(kLong));
  EXPECT_EQ(lockstep.PushPose(1, {}).error().code, ErrorCode::kFailedPrecondition);
  EXPECT_EQ(lockstep.Teleport(1, {}).error().code, ErrorCode::kFailedPrecondition);
}

TEST(HeadStream, AMalformedFrameClosesTheHead) {
  FakeServer server([&](int, grpc::ServerContext&, FakeServer::Stream& stream) {
    AnswerOpen(stream, "t");
    v1::AnimateResponse frame = HairFrame(1);
    frame.mutable_frame()->set_data("short");
    stream.Write(frame);
    return Drain(stream);
  });
  Client client = server.Connect();
  Head head = client.OpenHead(Realtime());
  ASSERT_TRUE(Eventually([&] { return head.Status().state == HeadState::kClosed; }));
  EXPECT_EQ(head.Status().error->code, ErrorCode::kInternal);
  EXPECT_EQ(head.NewestFrame(), nullptr);
}

TEST(HeadStream, NoticesShowInTheStatus) {
  FakeServer server([&](int, grpc::ServerContext&, FakeServer::Stream& stream) {
    AnswerOpen(stream, "t");
    v1::AnimateResponse notice;
    notice.mutable_notice()->set_code(v1::Notice::CODE_LATE);
    notice.mutable_notice()->set_count(3);
    stream.Write(notice);
    stream.Write(notice);
    notice.mutable_notice()->set_code(v1::Notice::CODE_DRAINING);
    stream.Write(notice);
    return Drain(stream);
  });
  Client client = server.Connect();
  Head head = client.OpenHead(Realtime());
  EXPECT_TRUE(Eventually([&] { return head.Status().server_draining; }));
  EXPECT_EQ(head.Status().missed_deadlines, 6u);
}

// The destructor's return is what these show; the test's time limit is the bound.
TEST(HeadStream, ClosesWhileTheServerNeverAnswers) {
  FakeServer server([&](int call, grpc::ServerContext& context, FakeServer::Stream& stream) {
    if (call == 1) AnswerOpen(stream, "t");
    Eventually([&] { return context.IsCancelled(); });  // Reads nothing, says nothing.
    return grpc::Status::CANCELLED;
  });
  Client client = server.Connect();
  {
    Head unanswered = client.OpenHead(Realtime());
    ASSERT_TRUE(Eventually([&] { return server.calls() == 1; }));
  }
  Head silent = client.OpenHead(Realtime());
  ASSERT_TRUE(silent.WaitUntilStreaming(kLong));
  EXPECT_TRUE(silent.PushPose(1, {}));
  silent.Close();
  EXPECT_EQ(silent.Status().state, HeadState::kClosed);
  EXPECT_FALSE(silent.Status().error);
  EXPECT_EQ(silent.PushPose(2, {}).error().code, ErrorCode::kFailedPrecondition);
}

TEST(HeadStream, ClosesAtAnyMoment) {
  FakeServer server([&](int, grpc::ServerContext&, FakeServer::Stream& stream) {
    v1::AnimateRequest request;
    if (stream.Read(&request)) stream.Write(Opened("t"));
    for (std::uint64_t index = 1; stream.Read(&request); ++index) stream.Write(HairFrame(index));
    return grpc::Status::OK;
  });
  Client client = server.Connect();
  for (int i = 0; i < 300; ++i) {
    Head head = client.OpenHead(Realtime());
    for (int spins = 0; spins < i; ++spins) {
      EXPECT_TRUE(head.PushPose(spins, {}));
      head.NewestFrame();
    }
  }
}

TEST(HeadStream, ClosesWhileItWaitsToRetry) {
  FakeServer server([&](int, grpc::ServerContext&, FakeServer::Stream&) { return kBroken; });
  Client client = server.Connect();
  for (int i = 0; i < 20; ++i) {
    Head head = client.OpenHead(Realtime());
    ASSERT_TRUE(Eventually([&] { return head.Status().error.has_value(); }));
  }
}

TEST(HeadStream, HeadsOutliveTheirClientAndMove) {
  FakeServer server([&](int, grpc::ServerContext&, FakeServer::Stream& stream) {
    AnswerOpen(stream, "t");
    stream.Write(HairFrame(1));
    return Drain(stream);
  });
  auto client = std::make_unique<Client>(server.Connect());
  Head first = client->OpenHead(Realtime());
  Head second = client->OpenHead(Realtime());
  client.reset();
  ASSERT_TRUE(first.WaitUntilStreaming(kLong));
  ASSERT_TRUE(second.WaitUntilStreaming(kLong));
  first = std::move(second);
  EXPECT_TRUE(Eventually([&] { return first.NewestFrame() != nullptr; }));
}

TEST(HeadStream, ManyThreadsMayUseOneHead) {
  FakeServer server([&](int, grpc::ServerContext&, FakeServer::Stream& stream) {
    AnswerOpen(stream, "t");
    v1::AnimateRequest request;
    double last = 0;
    for (std::uint64_t index = 1; stream.Read(&request); ++index) {
      if (!request.has_pose()) continue;
      EXPECT_GT(request.pose().time_s(), last);
      last = request.pose().time_s();
      stream.Write(HairFrame(index, last));
    }
    return grpc::Status::OK;
  });
  Client client = server.Connect();
  Head head = client.OpenHead(Realtime());
  ASSERT_TRUE(head.WaitUntilStreaming(kLong));
  std::atomic<int> ticks = 0;
  std::vector<std::thread> threads;
  for (int t = 0; t < 4; ++t) {
    threads.emplace_back([&] {
      for (int i = 0; i < 500; ++i) {
        // A time that another thread has overtaken is refused, and that is all.
        (void)head.PushPose(++ticks, {});
        (void)head.SetEnvironment({.air_drag_scale = 1});
        head.NewestFrame();
        head.Status();
      }
    });
  }
  for (std::thread& thread : threads) thread.join();
  EXPECT_TRUE(Eventually([&] {
    const auto frame = head.NewestFrame();
    return frame && frame->time_s > 0 && head.Status().state == HeadState::kStreaming;
  }));
}

}  // namespace
}  // namespace mane::client_test
