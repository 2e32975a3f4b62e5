#include "exec/worker_pool.h"

#include <oneapi/tbb/parallel_for.h>

#include <utility>

#include "base/check.h"

namespace mane::exec {
namespace {

// oneTBB shares its threads among all arenas and starts at most as many as the smallest live
// global_control allows, so each pool asks for more than all pools together can use: a pool whose
// workers wait for a disk or for each other takes none from another. Threads start when needed.
constexpr size_t kParallelism = 4096;

}  // namespace

WorkerPool::WorkerPool(int workers)
    : workers_(workers),
      parallelism_(tbb::global_control::max_allowed_parallelism, kParallelism),
      arena_(workers, /*reserved_for_masters=*/0) {
  MANE_CHECK(workers >= 1);
}

WorkerPool::~WorkerPool() { WaitIdle(); }

void WorkerPool::RunPieces(int pieces, void* context, Piece piece) {
  if (pieces <= 1 || workers_ == 1) {
    for (int i = 0; i < pieces; ++i) piece(context, i);
    return;
  }
  // Isolated: a worker that waits for the last piece takes no other work into its stack.
  arena_.execute([&] {
    tbb::this_task_arena::isolate(
        [&] { tbb::parallel_for(0, pieces, [&](int i) { piece(context, i); }); });
  });
}

void WorkerPool::Post(std::function<void()> task) {
  {
    std::lock_guard lock(mutex_);
    tasks_.push_back(std::move(task));
    ++pending_;
  }
  arena_.enqueue([this] { RunNext(); });
}

void WorkerPool::RunNext() {
  {
    std::function<void()> task;
    {
      std::lock_guard lock(mutex_);
      task = std::move(tasks_.front());
      tasks_.pop_front();
    }
    task();
  }  // What the task captured is gone before it counts as done.
  std::lock_guard lock(mutex_);
  if (--pending_ == 0) idle_.notify_all();
}

void WorkerPool::WaitIdle() {
  std::unique_lock lock(mutex_);
  idle_.wait(lock, [this] { return pending_ == 0; });
}

}  // namespace mane::exec
