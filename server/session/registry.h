#pragma once

#include <atomic>
#include <condition_variable>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "base/result.h"
#include "exec/worker_pool.h"
#include "session/agenda.h"
#include "session/head_session.h"

namespace mane::session {

struct RegistryOptions {
  int max_heads = 1000;      ///< Open at once, detached ones included; 1 to 100,000.
  double resume_grace = 10;  ///< How long a head waits for its broken stream to come back [s].
  /// Element-steps a second that all real-time heads may need together, those that wait for their
  /// client included (admission.h). The default is less than half of what one core steps with
  /// vector kernels: the costs are estimates, and heads that fall due at once should not make each
  /// other late.
  double realtime_capacity = 1e7;
  /// What all heads, waiting ones included, may remember of their hair together (HeadBytes).
  size_t max_state_bytes = size_t{4} << 30;
};

/// A head and the secret with which a broken stream comes back to it.
struct OpenedHead {
  std::shared_ptr<HeadSession> head;
  std::string resume_token;
};

/// All heads of a server: admission, the real-time clock, and heads that wait for their client.
///
/// Threads: every method from any thread. One thread of its own ticks real-time heads when they are
/// due and lets detached heads expire; heads are spread over their period so that they do not fall
/// due at once. `mutex_` guards what stands below it and is never held while a head or a sink is
/// called.
class Registry {
 public:
  /// Real-time heads run on `realtime`, the others on `lockstep`, so that these do not delay those;
  /// there, too, levels of detail are made.
  Registry(const RegistryOptions& options, exec::WorkerPool& realtime, exec::WorkerPool& lockstep);
  /// Ends all heads and stops the clock.
  ~Registry();

  /// What would keep such a head out of Open now, if anything does.
  [[nodiscard]] Result<void> Admit(const groom::Groom& groom, const HeadOptions& options,
                                   const std::string& request_id);
  /// A new head with `sink` attached. A `request_id` that is already open is taken for the lost
  /// first try of the same call, and ended if this one is admitted. At `max_heads` the head that
  /// has waited longest for its client makes room. kResourceExhausted when none waits, when the
  /// head alone is too much (AdmitHead), or when real-time heads would need more than
  /// `realtime_capacity`, of which detached ones keep their share for Resume, or all heads more
  /// than `max_state_bytes`; kUnavailable once StopAdmitting was called.
  Result<OpenedHead> Open(const Asset& asset, const HeadOptions& options,
                          const std::string& request_id, FrameSink* sink);
  /// The detached head of `resume_token`, attached to `sink`. A stream that still holds it is
  /// ended. kNotFound when it has expired.
  Result<OpenedHead> Resume(const std::string& resume_token, FrameSink* sink);
  /// Whether there is room for the head to change to `model`: kResourceExhausted as of Open. What a
  /// head was ever let in with it keeps, so that a change back is no matter of room.
  Result<void> AdmitModel(const std::shared_ptr<HeadSession>& head,
                          const head::ModelOptions& model);
  /// The stream broke: the head stands still and waits.
  void Leave(const std::shared_ptr<HeadSession>& head, FrameSink* sink);
  /// The client is done: the head is gone.
  void Close(const std::shared_ptr<HeadSession>& head, FrameSink* sink);
  /// Tells every client.
  void Notify(const Notice& notice);
  /// From now on Open and Resume fail.
  void StopAdmitting();
  /// Ends all heads.
  void EndAll(const Error& error);

  [[nodiscard]] int head_count() const;
  /// Heads that a stream holds.
  [[nodiscard]] int attached_count() const;

 private:
  struct Entry {
    std::shared_ptr<HeadSession> head;
    std::string token;
    std::string request_id;
    FrameSink* sink = nullptr;  // Null while detached.
    double moment = 0;          // When it is on the agenda [s].
    size_t state_bytes = 0;     // Of what its hair remembers.
    double load = 0;            // What it was let in with (RealtimeLoad).
  };
  using Entries = std::map<uint64_t, Entry>;

  void RunClock(std::stop_token stop);
  // Ticks what is due at `now`, ends what has expired. Called with `lock` held; releases it around
  // calls of heads.
  void TickDue(double now, std::unique_lock<std::mutex>& lock);
  // kResourceExhausted naming `field` where a head that needs `own` would be too much for the
  // others but `left_out`.
  Result<void> AdmitLoadLocked(double own, Entries::const_iterator left_out,
                               const std::string& field) const;
  // The same for bytes.
  Result<void> AdmitBytesLocked(size_t own, Entries::const_iterator left_out,
                                const std::string& field) const;
  Entries::iterator Find(const HeadSession* head);
  // The detached entry that expires first, or end().
  Entries::iterator LongestDetached();
  // Puts an entry on the agenda.
  void Plan(uint64_t id, Entry& entry, double moment);
  // Sets the first tick of a newly attached head and has the clock look at it.
  void Schedule(uint64_t id, Entry& entry);
  void Erase(Entries::iterator item);

  // As Admit; what the head would remember of its hair [bytes], which takes a while to count.
  Result<size_t> Weigh(const groom::Groom& groom, const HeadOptions& options,
                       const std::string& request_id);
  // What keeps a head out, if anything does; else the entry that leaves for it, or end(): the one
  // of the same `request_id`, or at `max_heads` the one detached longest. Changes nothing, so that
  // who is refused harms nobody. With `mutex_`.
  Result<Entries::iterator> AdmitLocked(const groom::Groom& groom, size_t state_bytes,
                                        const HeadOptions& options, const std::string& request_id);

  const RegistryOptions options_;
  exec::WorkerPool& realtime_;
  exec::WorkerPool& lockstep_;
  LevelLibrary levels_;
  BeamLibrary beams_;

  // Held by Open, once it has built its head, and by Resume until they have attached, so that two
  // streams which want one head get it one after the other. Taken before every other lock.
  std::mutex handover_;

  mutable std::mutex mutex_;
  bool admitting_ = true;
  std::condition_variable_any wake_;
  bool rescheduled_ = false;  // The clock must look again.
  Entries entries_;
  // Next ticks of attached heads in real time, and when detached ones expire.
  Agenda agenda_;
  std::atomic<uint64_t> next_id_ = 1;

  std::jthread clock_;  // Last: stopped before the rest goes.
};

}  // namespace mane::session
