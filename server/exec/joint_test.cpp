// One makes, the others wait; it stops when nobody wants it any more, and not before.

#include "exec/joint.h"

#include <gtest/gtest.h>

#include <atomic>
#include <stdexcept>
#include <thread>
#include <vector>

namespace mane::exec {
namespace {

using base::Cancelled;

// Makes 7 once it may, unless it is stopped.
struct Maker {
  Result<int> operator()(const Cancelled& unwanted) {
    ++begun;
    while (!may_end) {
      if (unwanted()) return base::CancelledError();
      std::this_thread::yield();
    }
    return 7;
  }
  std::atomic<int> begun = 0;
  std::atomic<bool> may_end = false;
};

class JointTest : public ::testing::Test {
 protected:
  Result<int> Get(const std::atomic<bool>& cancelled) {
    return joint_.Get([&] { return cancelled.load(); }, std::ref(maker_));
  }
  void WaitUntilBegun(int times) {
    while (maker_.begun < times) std::this_thread::yield();
  }

  Joint<int> joint_;
  Maker maker_;
};

TEST_F(JointTest, AllGetWhatOneMakes) {
  std::atomic<bool> stay = false;
  std::atomic<int> sum = 0;
  std::vector<std::jthread> threads;
  for (int i = 0; i < 5; ++i) threads.emplace_back([&] { sum += *Get(stay); });
  WaitUntilBegun(1);
  maker_.may_end = true;
  threads.clear();
  EXPECT_EQ(sum, 5 * 7);
  EXPECT_EQ(*joint_.Get({}, std::ref(maker_)), 7);
  EXPECT_EQ(maker_.begun, 1);
}

TEST_F(JointTest, WhoWaitsMayLeaveAndWhoMakesGoesOnForTheOthers) {
  std::atomic<bool> first = false, second = false, third = false;
  Result<int> of_first = 0, of_second = 0, of_third = 0;
  std::jthread one([&] { of_first = Get(first); });
  WaitUntilBegun(1);
  std::jthread two([&] { of_second = Get(second); });
  std::atomic<bool> waits = false;
  std::jthread three([&] {
    of_third = joint_.Get(
        [&] {
          waits = true;
          return third.load();
        },
        std::ref(maker_));
  });
  while (!waits) std::this_thread::yield();
  first = second = true;
  two.join();
  ASSERT_FALSE(of_second);
  EXPECT_EQ(of_second.error().code, ErrorCode::kCancelled);
  maker_.may_end = true;
  one.join(), three.join();
  EXPECT_EQ(*of_first, 7);
  EXPECT_EQ(*of_third, 7);
  EXPECT_EQ(maker_.begun, 1);
}

TEST_F(JointTest, ItStopsWhenNobodyWantsItAndIsBegunAnew) {
  std::atomic<bool> first = false, second = false;
  Result<int> of_first = 0;
  std::jthread one([&] { of_first = Get(first); });
  WaitUntilBegun(1);
  first = true;
  one.join();
  ASSERT_FALSE(of_first);
  EXPECT_EQ(of_first.error().code, ErrorCode::kCancelled);
  maker_.may_end = true;
  EXPECT_EQ(*Get(second), 7);
  EXPECT_EQ(maker_.begun, 2);
}

TEST_F(JointTest, AFailureIsToldToAll) {
  const auto fails = [](const Cancelled&) -> Result<int> { return InvalidArgument("x", "bad"); };
  EXPECT_EQ(joint_.Get({}, fails).error().field, "x");
  EXPECT_EQ(joint_.Get({}, std::ref(maker_)).error().field, "x");
  Joint<int> other;
  const auto throws = [](const Cancelled&) -> Result<int> { throw std::runtime_error("fault"); };
  EXPECT_EQ(other.Get({}, throws).error().code, ErrorCode::kInternal);
}

}  // namespace
}  // namespace mane::exec
