// Properties of the worker pool:
//   cover        ParallelFor visits every index once
//   partition    the pieces are the same for any number of workers
//   bound        never more than `workers` bodies at once, and really that many
//   exceptions   the first one reaches the caller; the pool lives on
//   post         everything posted runs, whoever posts it; WaitIdle and the destructor wait for it
//   nesting      posted tasks may call ParallelFor and Post

#include "exec/worker_pool.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <functional>
#include <memory>
#include <mutex>
#include <set>
#include <stdexcept>
#include <thread>
#include <utility>
#include <vector>

#include "base/check_failure.h"

namespace mane::exec {
namespace {

using std::chrono::steady_clock;

// Waits until `condition` holds; false when it has not within 20 s.
template <typename Condition>
bool Eventually(const Condition& condition) {
  const auto deadline = steady_clock::now() + std::chrono::seconds(20);
  while (!condition()) {
    if (steady_clock::now() > deadline) return false;
    std::this_thread::yield();
  }
  return true;
}

// Keeps count of how many are inside at once.
class Occupancy {
 public:
  void Enter() {
    const int now = ++inside_;
    int most = most_;
    while (now > most && !most_.compare_exchange_weak(most, now)) {
    }
  }
  void Leave() { --inside_; }
  [[nodiscard]] int most() const { return most_; }

 private:
  std::atomic<int> inside_{0};
  std::atomic<int> most_{0};
};

TEST(WorkerPoolTest, ParallelForVisitsEveryIndexOnce) {
  for (const int workers : {1, 2, 3, 8}) {
    WorkerPool pool(workers);
    EXPECT_EQ(pool.workers(), workers);
    for (const int n : {0, 1, 2, 7, 64, 100, 1001}) {
      for (const int grain : {1, 3, 64, 5000}) {
        std::vector<std::atomic<int>> visits(n);
        pool.ParallelFor(n, grain, [&](int begin, int end) {
          for (int i = begin; i < end; ++i) ++visits[i];
        });
        for (int i = 0; i < n; ++i) {
          ASSERT_EQ(visits[i], 1) << "workers=" << workers << " n=" << n << " grain=" << grain;
        }
      }
    }
  }
}

TEST(WorkerPoolTest, PiecesAreTheSameForAnyNumberOfWorkers) {
  for (const int n : {1, 10, 64, 101}) {
    for (const int grain : {1, 7, 64}) {
      std::set<std::pair<int, int>> expected;
      for (int begin = 0; begin < n; begin += grain) {
        expected.insert({begin, std::min(n, begin + grain)});
      }
      for (const int workers : {1, 2, 5}) {
        WorkerPool pool(workers);
        std::mutex mutex;
        std::vector<std::pair<int, int>> pieces;
        pool.ParallelFor(n, grain, [&](int begin, int end) {
          std::lock_guard lock(mutex);
          pieces.emplace_back(begin, end);
        });
        EXPECT_EQ(pieces.size(), expected.size());
        EXPECT_EQ(std::set(pieces.begin(), pieces.end()), expected)
            << "n=" << n << " grain=" << grain << " workers=" << workers;
      }
    }
  }
}

TEST(WorkerPoolTest, AtMostTheAskedNumberWorksAtOnce) {
  for (const int workers : {1, 2, 3}) {
    WorkerPool pool(workers);
    Occupancy loop, posted;
    pool.ParallelFor(300, 1, [&](int, int) {
      loop.Enter();
      std::this_thread::yield();
      loop.Leave();
    });
    for (int i = 0; i < 300; ++i) {
      pool.Post([&] {
        posted.Enter();
        std::this_thread::yield();
        posted.Leave();
      });
    }
    pool.WaitIdle();
    EXPECT_LE(loop.most(), workers);
    EXPECT_LE(posted.most(), workers);
  }
}

TEST(WorkerPoolTest, PoolsWorkAtOnceWithAllTheirWorkers) {
  // Each task ends when all tasks of all pools have begun.
  WorkerPool many(4), few(2);
  std::atomic<int> begun{0}, met{0};
  const auto meet = [&] {
    ++begun;
    met += Eventually([&] { return begun == 6; });
  };
  for (int i = 0; i < 4; ++i) many.Post(meet);
  for (int i = 0; i < 2; ++i) few.Post(meet);
  many.WaitIdle();
  few.WaitIdle();
  EXPECT_EQ(met, 6);
}

TEST(WorkerPoolTest, ExceptionsReachTheCallerAndThePoolLivesOn) {
  for (const int workers : {1, 4}) {
    WorkerPool pool(workers);
    const auto fail = [&](int begin, int) {
      if (begin == 50) throw std::runtime_error("piece 50");
    };
    try {
      pool.ParallelFor(100, 1, fail);
      ADD_FAILURE() << "no exception, workers=" << workers;
    } catch (const std::runtime_error& error) {
      EXPECT_STREQ(error.what(), "piece 50");
    }
    std::atomic<int> visited{0};
    pool.ParallelFor(100, 1, [&](int, int) { ++visited; });
    EXPECT_EQ(visited, 100);
  }
}

TEST(WorkerPoolTest, RunsAllThatSeveralThreadsPost) {
  WorkerPool pool(3);
  std::atomic<int> ran{0};
  std::vector<std::thread> posters;
  for (int t = 0; t < 6; ++t) {
    posters.emplace_back([&] {
      for (int i = 0; i < 500; ++i) pool.Post([&] { ++ran; });
      pool.WaitIdle();  // May be called from any thread, also while others post.
    });
  }
  for (std::thread& poster : posters) poster.join();
  pool.WaitIdle();
  EXPECT_EQ(ran, 3000);
}

TEST(WorkerPoolTest, WaitIdleCoversWhatTasksPost) {
  WorkerPool pool(2);
  std::atomic<int> ran{0};
  std::function<void(int)> cascade = [&](int depth) {
    ++ran;
    if (depth == 0) return;
    pool.Post([&, depth] { cascade(depth - 1); });
    pool.Post([&, depth] { cascade(depth - 1); });
  };
  pool.Post([&] { cascade(8); });
  pool.WaitIdle();
  EXPECT_EQ(ran, 511);
}

TEST(WorkerPoolTest, WhatTasksCapturedIsGoneWhenWaitIdleReturns) {
  WorkerPool pool(2);
  for (int i = 0; i < 2000; ++i) {
    std::weak_ptr<int> seen;
    {
      auto captured = std::make_shared<int>(i);
      seen = captured;
      pool.Post([captured = std::move(captured)] { EXPECT_GE(*captured, 0); });
    }
    pool.WaitIdle();
    ASSERT_TRUE(seen.expired()) << i;
  }
}

TEST(WorkerPoolTest, WaitIdleReturnsAtOnceWhenNothingWasPosted) {
  WorkerPool pool(1);
  pool.WaitIdle();
  SUCCEED();
}

TEST(WorkerPoolTest, DestructorWaitsForPostedWork) {
  std::atomic<int> ran{0};
  {
    WorkerPool pool(2);
    for (int i = 0; i < 200; ++i) pool.Post([&] { ++ran; });
  }
  EXPECT_EQ(ran, 200);
}

TEST(WorkerPoolTest, PostRunsOnAnotherThreadAndDoesNotBlock) {
  WorkerPool pool(1);
  std::atomic<bool> release{false}, met{false};
  std::atomic<std::thread::id> runner;
  pool.Post([&] {
    runner = std::this_thread::get_id();
    met = Eventually([&] { return release.load(); });
  });
  release = true;  // Reached only because Post returned before the task ended.
  pool.WaitIdle();
  EXPECT_TRUE(met);
  EXPECT_NE(runner.load(), std::this_thread::get_id());
}

TEST(WorkerPoolTest, PoolsWhoseWorkersWaitTakeNoneFromOthers) {
  // One worker more than would be there if the smallest pool, or the machine, set the limit.
  const int each = static_cast<int>(std::thread::hardware_concurrency()) + 6;
  WorkerPool small(1), a(each), b(each);
  std::atomic<int> waiting{0}, met{0};
  const auto wait_for_all = [&] {
    ++waiting;
    met += Eventually([&] { return waiting == 2 * each + 1; }) ? 1 : 0;
  };
  small.Post(wait_for_all);
  for (int i = 0; i < each; ++i) {
    a.Post(wait_for_all);
    b.Post(wait_for_all);
  }
  for (WorkerPool* pool : {&small, &a, &b}) pool->WaitIdle();
  EXPECT_EQ(met, 2 * each + 1);
}

TEST(WorkerPoolTest, PostedTasksMayLoopInParallel) {
  for (const int workers : {1, 2, 4}) {
    WorkerPool pool(workers);
    std::atomic<int> visited{0};
    for (int task = 0; task < 20; ++task) {
      pool.Post(
          [&] { pool.ParallelFor(100, 7, [&](int begin, int end) { visited += end - begin; }); });
    }
    pool.WaitIdle();
    EXPECT_EQ(visited, 2000) << workers;
  }
}

TEST(WorkerPoolTest, RefusesAPoolWithoutWorkers) {
  EXPECT_THROW(WorkerPool pool(0), base::CheckFailure);
}

}  // namespace
}  // namespace mane::exec
