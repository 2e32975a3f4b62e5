#pragma once

#include <oneapi/tbb/global_control.h>
#include <oneapi/tbb/parallel_for.h>
#include <oneapi/tbb/task_arena.h>

#include <algorithm>
#include <condition_variable>
#include <deque>
#include <functional>
#include <mutex>

namespace mane::exec {

/// Workers of one kind of work, a oneTBB arena.
///
/// Threads: every method may be called from any thread. A thread that calls ParallelFor works along
/// as one of the workers. What runs never depends on how many workers there are: ParallelFor cuts
/// [0, n) into the same pieces always, and each piece owns its results.
class WorkerPool {
 public:
  /// @param workers  threads at work at once, >= 1.
  explicit WorkerPool(int workers);
  /// Waits for all posted work.
  ~WorkerPool();

  WorkerPool(const WorkerPool&) = delete;
  WorkerPool& operator=(const WorkerPool&) = delete;

  [[nodiscard]] int workers() const { return workers_; }

  /// Calls body(begin, end) for the pieces [0, grain), [grain, 2 grain), ... of [0, n); returns
  /// when all are done. Rethrows the first exception of a piece.
  template <typename Body>
  void ParallelFor(int n, int grain, const Body& body) {
    const int pieces = (n + grain - 1) / grain;
    if (pieces <= 1 || workers_ == 1) {
      for (int i = 0; i < pieces; ++i) body(i * grain, std::min(n, (i + 1) * grain));
      return;
    }
    // Isolated: a worker that waits for the last piece takes no other work into its stack.
    arena_.execute([&] {
      tbb::this_task_arena::isolate([&] {
        tbb::parallel_for(0, pieces, [&](int i) { body(i * grain, std::min(n, (i + 1) * grain)); });
      });
    });
  }

  /// Runs `task` on a worker, soon. The task must not throw.
  void Post(std::function<void()> task);

  /// Waits until nothing posted is waiting or running.
  void WaitIdle();

 private:
  // Runs the task posted first.
  void RunNext();

  const int workers_;
  tbb::global_control parallelism_;  // The process-wide limit counts every pool's workers.
  tbb::task_arena arena_;
  std::mutex mutex_;
  std::condition_variable idle_;
  // Guarded by mutex_. Tasks lie here rather than in oneTBB, which keeps a copy of what it runs a
  // little longer than it takes.
  std::deque<std::function<void()>> tasks_;
  int pending_ = 0;  // Waiting or running.
};

}  // namespace mane::exec
