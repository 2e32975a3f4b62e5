#pragma once

#include <oneapi/tbb/global_control.h>
#include <oneapi/tbb/task_arena.h>

#include <algorithm>
#include <atomic>
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
    Loop<Body> loop(body, n, grain);
    RunPieces((n + grain - 1) / grain, &loop, &Loop<Body>::Run);
  }

  /// Runs `task` on a worker, soon. The task must not throw.
  void Post(std::function<void()> task);

  /// Waits until nothing posted is waiting or running.
  void WaitIdle();

 private:
  using Piece = void (*)(void* context, int index);

  // What a loop shares with its workers.
  template <typename Body>
  class Loop {
   public:
    Loop(const Body& body, int n, int grain) : body_(body), n_(n), grain_(grain) {
      handed_over_.store(1, std::memory_order_release);
    }
    ~Loop() { handed_over_.load(std::memory_order_acquire); }
    Loop(const Loop&) = delete;
    Loop& operator=(const Loop&) = delete;

    // Runs one piece; the Piece of RunPieces.
    static void Run(void* loop, int index) {
      auto& self = *static_cast<Loop*>(loop);
      self.handed_over_.load(std::memory_order_acquire);
      struct HandBack {
        std::atomic<int>& handed_over;
        ~HandBack() { handed_over.fetch_add(1, std::memory_order_release); }
      } const hand_back{self.handed_over_};  // Also when the body throws.
      const int begin = index * self.grain_;
      self.body_(begin, std::min(self.n_, begin + self.grain_));
    }

   private:
    const Body& body_;
    const int n_;
    const int grain_;
    // The scheduler orders the caller before the workers, and them before its return. This says so
    // once more where ThreadSanitizer, which cannot see into the distribution's oneTBB, sees it.
    std::atomic<int> handed_over_{0};
  };

  // Calls piece(context, i) for i in [0, pieces), on any worker.
  void RunPieces(int pieces, void* context, Piece piece);

  // Runs the task posted first.
  void RunNext();

  const int workers_;
  tbb::global_control parallelism_;  // The process-wide limit, above every pool's workers.
  tbb::task_arena arena_;
  std::mutex mutex_;
  std::condition_variable idle_;
  // Guarded by mutex_. Tasks lie here rather than in oneTBB, which keeps a copy of what it runs a
  // little longer than it takes.
  std::deque<std::function<void()>> tasks_;
  int pending_ = 0;  // Waiting or running.
};

}  // namespace mane::exec
