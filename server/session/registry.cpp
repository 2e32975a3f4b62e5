#include "session/registry.h"

#include <sys/random.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "base/check.h"
#include "base/clock.h"
#include "session/admission.h"

namespace mane::session {
namespace {

// The clock's longest sleep [s]; it is woken for whatever comes up meanwhile.
constexpr double kLongestSleep = 60;

// 128 bits that nobody can guess.
std::string MakeToken() {
  std::array<uint64_t, 2> bits;
  MANE_CHECK(getrandom(bits.data(), sizeof bits, 0) == sizeof bits);
  return fmt::format("{:016x}{:016x}", bits[0], bits[1]);
}

}  // namespace

Registry::Registry(const RegistryOptions& options, exec::WorkerPool& realtime,
                   exec::WorkerPool& lockstep)
    : options_(options),
      realtime_(realtime),
      lockstep_(lockstep),
      levels_(lockstep),
      beams_(lockstep),
      clock_([this](std::stop_token stop) { RunClock(stop); }) {}

Registry::~Registry() {
  clock_.request_stop();
  clock_.join();
  EndAll({ErrorCode::kUnavailable, "the server is stopping", ""});
  realtime_.WaitIdle();
  lockstep_.WaitIdle();
}

Result<Registry::Entries::iterator> Registry::AdmitLocked(const groom::Groom& groom,
                                                          size_t state_bytes,
                                                          const HeadOptions& options,
                                                          const std::string& request_id) {
  if (!admitting_) return Error{ErrorCode::kUnavailable, "the server is stopping", ""};
  auto leaving = std::ranges::find_if(entries_, [&](const auto& item) {
    return !request_id.empty() && item.second.request_id == request_id;
  });
  if (leaving == entries_.end() && static_cast<int>(entries_.size()) >= options_.max_heads) {
    leaving = LongestDetached();
    if (leaving == entries_.end()) {
      return Error{ErrorCode::kResourceExhausted,
                   fmt::format("the server holds {} heads, its limit; try again later, or another "
                               "server",
                               entries_.size()),
                   ""};
    }
  }
  if (const auto ok = AdmitBytesLocked(state_bytes, leaving, "open.groom"); !ok) {
    return ok.error();
  }
  if (const auto ok = AdmitLoadLocked(RealtimeLoad(groom, options), leaving, "open"); !ok) {
    return ok.error();
  }
  return leaving;
}

Result<void> Registry::AdmitLoadLocked(double own, Entries::const_iterator left_out,
                                       const std::string& field) const {
  double load = own;
  for (auto item = entries_.begin(); item != entries_.end(); ++item) {
    // Detached ones too: Resume asks no more.
    if (item != left_out) load += item->second.load;
  }
  if (own == 0 || load <= options_.realtime_capacity) return {};
  return Error{ErrorCode::kResourceExhausted,
               fmt::format("with this head real-time heads would need {:.3g} element-steps a "
                           "second; the server has {:.3g}: ask for fewer substeps or a lower "
                           "rate_hz, or another server",
                           load, options_.realtime_capacity),
               field};
}

Result<void> Registry::AdmitBytesLocked(size_t own, Entries::const_iterator left_out,
                                        const std::string& field) const {
  size_t bytes = own;
  for (auto item = entries_.begin(); item != entries_.end(); ++item) {
    if (item != left_out) bytes += item->second.state_bytes;
  }
  if (bytes <= options_.max_state_bytes) return {};
  return Error{ErrorCode::kResourceExhausted,
               fmt::format("with this head the hair of all heads would take {} bytes; the server "
                           "has {}: try again when other heads are closed, use a groom of fewer "
                           "moving bodies, guides or elements, fewer segments, or another server",
                           bytes, options_.max_state_bytes),
               field};
}

Result<void> Registry::AdmitModel(const std::shared_ptr<HeadSession>& head,
                                  const head::ModelOptions& model) {
  HeadOptions options = head->options();
  options.model = model;
  if (auto ok = AdmitHead(head->groom(), options); !ok) return ok;
  const double load = RealtimeLoad(head->groom(), options);
  const size_t bytes = HeadBytes(head->groom(), options);
  std::lock_guard lock(mutex_);
  const auto item = Find(head.get());
  if (item == entries_.end()) return {};
  Entry& entry = item->second;
  if (load > entry.load) {
    if (auto ok = AdmitLoadLocked(load, item, "model.model"); !ok) return ok;
  }
  if (bytes > entry.state_bytes) {
    if (auto ok = AdmitBytesLocked(bytes, item, "model.model"); !ok) return ok;
  }
  entry.load = std::max(entry.load, load);
  entry.state_bytes = std::max(entry.state_bytes, bytes);
  return {};
}

Result<size_t> Registry::Weigh(const groom::Groom& groom, const HeadOptions& options,
                               const std::string& request_id) {
  if (const auto ok = AdmitHead(groom, options); !ok) return ok.error();
  const size_t state_bytes = HeadBytes(groom, options);
  std::lock_guard lock(mutex_);
  if (const auto ok = AdmitLocked(groom, state_bytes, options, request_id); !ok) return ok.error();
  return state_bytes;
}

Result<void> Registry::Admit(const groom::Groom& groom, const HeadOptions& options,
                             const std::string& request_id) {
  if (const auto weighed = Weigh(groom, options, request_id); !weighed) return weighed.error();
  return {};
}

Result<OpenedHead> Registry::Open(const Asset& asset, const HeadOptions& options,
                                  const std::string& request_id, FrameSink* sink) {
  const groom::Groom& groom = *asset.groom;
  // Before the head is built, which takes time and memory, and, as others come and go meanwhile,
  // once more below.
  const auto state_bytes = Weigh(groom, options, request_id);
  if (!state_bytes) return state_bytes.error();
  const uint64_t id = next_id_++;
  exec::WorkerPool& pool = options.pacing == Pacing::kRealtime ? realtime_ : lockstep_;
  const OpenedHead opened{std::make_shared<HeadSession>(fmt::format("heads/{}", id), asset, options,
                                                        pool, levels_, beams_),
                          MakeToken()};
  std::lock_guard handover(handover_);
  std::shared_ptr<HeadSession> replaced;
  {
    std::lock_guard lock(mutex_);
    const auto leaving = AdmitLocked(groom, *state_bytes, options, request_id);
    if (!leaving) return leaving.error();
    if (*leaving != entries_.end()) {
      replaced = std::move((*leaving)->second.head);
      Erase(*leaving);
    }
    Entry& entry = entries_[id];
    entry = {opened.head,  opened.resume_token,         request_id, sink, 0,
             *state_bytes, RealtimeLoad(groom, options)};
    Schedule(id, entry);
  }
  opened.head->Attach(sink);
  if (replaced) {
    // Nobody hears this of a head that only made room: it was detached.
    replaced->End({ErrorCode::kCancelled, "opened again with the same request_id", "open"});
  }
  return opened;
}

Result<OpenedHead> Registry::Resume(const std::string& resume_token, FrameSink* sink) {
  std::lock_guard handover(handover_);
  OpenedHead opened;
  bool held = false;
  {
    std::lock_guard lock(mutex_);
    if (!admitting_) return Error{ErrorCode::kUnavailable, "the server is stopping", ""};
    const auto item = std::ranges::find_if(
        entries_, [&](const auto& candidate) { return candidate.second.token == resume_token; });
    if (item == entries_.end()) {
      return Error{ErrorCode::kNotFound,
                   fmt::format("open.resume names no head of this server; a head waits {} s for "
                               "its stream to come back, then open it anew",
                               options_.resume_grace),
                   "open.resume"};
    }
    Entry& entry = item->second;
    held = std::exchange(entry.sink, sink) != nullptr;
    opened = {entry.head, entry.token};
    Schedule(item->first, entry);
  }
  if (held) opened.head->Displace();
  opened.head->Attach(sink);
  return opened;
}

void Registry::Leave(const std::shared_ptr<HeadSession>& head, FrameSink* sink) {
  {
    std::lock_guard lock(mutex_);
    const auto item = Find(head.get());
    if (item != entries_.end() && item->second.sink == sink) {
      item->second.sink = nullptr;
      Plan(item->first, item->second, base::SteadySeconds() + options_.resume_grace);
      rescheduled_ = true;
      wake_.notify_one();
    }
  }
  head->Detach(sink);
}

void Registry::Close(const std::shared_ptr<HeadSession>& head, FrameSink* sink) {
  {
    std::lock_guard lock(mutex_);
    const auto item = Find(head.get());
    if (item != entries_.end() && item->second.sink == sink) Erase(item);
  }
  head->Detach(sink);
}

void Registry::Notify(const Notice& notice) {
  std::vector<std::shared_ptr<HeadSession>> heads;
  {
    std::lock_guard lock(mutex_);
    for (const auto& [id, entry] : entries_) heads.push_back(entry.head);
  }
  for (const auto& head : heads) head->Notify(notice);
}

void Registry::EndAll(const Error& error) {
  Entries entries;
  {
    std::lock_guard lock(mutex_);
    entries.swap(entries_);
    agenda_ = {};
  }
  for (const auto& [id, entry] : entries) entry.head->End(error);
}

void Registry::StopAdmitting() {
  std::lock_guard lock(mutex_);
  admitting_ = false;
}

int Registry::attached_count() const {
  std::lock_guard lock(mutex_);
  return static_cast<int>(std::ranges::count_if(
      entries_, [](const auto& item) { return item.second.sink != nullptr; }));
}

int Registry::head_count() const {
  std::lock_guard lock(mutex_);
  return static_cast<int>(entries_.size());
}

Registry::Entries::iterator Registry::Find(const HeadSession* head) {
  return std::ranges::find_if(entries_,
                              [&](const auto& item) { return item.second.head.get() == head; });
}

Registry::Entries::iterator Registry::LongestDetached() {
  auto oldest = entries_.end();
  for (auto item = entries_.begin(); item != entries_.end(); ++item) {
    if (item->second.sink != nullptr) continue;
    if (oldest == entries_.end() || item->second.moment < oldest->second.moment) oldest = item;
  }
  return oldest;
}

void Registry::Erase(Entries::iterator item) {
  agenda_.Remove(item->first);
  entries_.erase(item);
}

void Registry::Plan(uint64_t id, Entry& entry, double moment) {
  entry.moment = moment;
  agenda_.Set(id, moment);
}

void Registry::Schedule(uint64_t id, Entry& entry) {
  if (entry.head->options().pacing == Pacing::kLockstep) return agenda_.Remove(id);
  // The golden ratio spreads any number of heads evenly over their period.
  const double phase = std::fmod(static_cast<double>(id) * 0.6180339887498949, 1.0);
  Plan(id, entry, base::SteadySeconds() + phase / entry.head->options().rate_hz);
  rescheduled_ = true;
  wake_.notify_one();
}

void Registry::RunClock(std::stop_token stop) {
  std::unique_lock lock(mutex_);
  while (!stop.stop_requested()) {
    TickDue(base::SteadySeconds(), lock);
    const double pause = std::clamp(agenda_.next() - base::SteadySeconds(), 0.0, kLongestSleep);
    wake_.wait_for(lock, stop, std::chrono::duration<double>(pause),
                   [this] { return std::exchange(rescheduled_, false); });
  }
}

void Registry::TickDue(double now, std::unique_lock<std::mutex>& lock) {
  struct DueTick {
    std::shared_ptr<HeadSession> head;
    double due;
    int missed;
  };
  std::vector<DueTick> ticks;
  std::vector<std::shared_ptr<HeadSession>> expired;
  for (const uint64_t id : agenda_.TakeDue(now)) {
    const auto item = entries_.find(id);
    Entry& entry = item->second;
    if (entry.sink == nullptr) {
      expired.push_back(std::move(entry.head));
      entries_.erase(item);
      continue;
    }
    const double period = 1 / entry.head->options().rate_hz;
    const int missed = static_cast<int>((now - entry.moment) / period);
    ticks.push_back({entry.head, entry.moment + missed * period, missed});
    Plan(id, entry, entry.moment + (missed + 1) * period);
  }
  lock.unlock();
  for (const DueTick& tick : ticks) tick.head->Tick(tick.due, tick.missed);
  for (const auto& head : expired) {
    head->End({ErrorCode::kCancelled, "the stream did not come back in time", ""});
  }
  lock.lock();
}

}  // namespace mane::session
