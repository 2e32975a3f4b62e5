#include "jobs/watchers.h"

#include <spdlog/spdlog.h>

#include <condition_variable>
#include <exception>
#include <limits>
#include <map>
#include <mutex>
#include <utility>

#include "base/clock.h"

namespace mane::jobs {

namespace {

constexpr double kMinIntervalS = 0.1;

}  // namespace

// What a Watchers and its subscriptions share.
class Subscription::Hub {
 public:
  explicit Hub(Watchers::Reader read) : read_(std::move(read)) {}

  uint64_t Add(std::string job_id, Watchers::Callback callback);
  void Remove(uint64_t number);
  void MarkChanged(const std::string& job_id);
  void Stop();
  // The body of the thread.
  void Run();

 private:
  struct Entry {
    std::string job_id;
    Watchers::Callback callback;
    bool changed = true;  // A call is due.
    bool over = false;    // The last call has been made.
    double earliest_s = 0;
  };
  using Entries = std::map<uint64_t, std::shared_ptr<Entry>>;

  Entries::iterator NextDue();
  bool Call(const Entry& entry) const;

  const Watchers::Reader read_;

  std::mutex mutex_;  // Guards what follows, and `changed`, `over`, `earliest_s` of entries.
  std::condition_variable work_;
  std::condition_variable called_;
  Entries entries_;
  uint64_t last_number_ = 0;
  uint64_t calling_ = 0;  // Whose callback runs; 0 for none.
  bool stopping_ = false;
  std::thread::id thread_;
};

uint64_t Subscription::Hub::Add(std::string job_id, Watchers::Callback callback) {
  auto entry = std::make_shared<Entry>();
  entry->job_id = std::move(job_id);
  entry->callback = std::move(callback);
  std::lock_guard lock(mutex_);
  entries_.emplace(++last_number_, std::move(entry));
  work_.notify_one();
  return last_number_;
}

void Subscription::Hub::Remove(uint64_t number) {
  std::shared_ptr<Entry> entry;  // Destroyed last, unlocked: what a callback owns may do anything.
  std::unique_lock lock(mutex_);
  const auto found = entries_.find(number);
  if (found != entries_.end()) {
    entry = std::move(found->second);
    entries_.erase(found);
  }
  if (std::this_thread::get_id() != thread_) {
    called_.wait(lock, [&] { return calling_ != number; });
  }
  lock.unlock();
}

void Subscription::Hub::MarkChanged(const std::string& job_id) {
  std::lock_guard lock(mutex_);
  for (auto& [number, entry] : entries_) {
    if (entry->job_id == job_id) entry->changed = true;
  }
  work_.notify_one();
}

void Subscription::Hub::Stop() {
  std::lock_guard lock(mutex_);
  stopping_ = true;
  work_.notify_one();
}

void Subscription::Hub::Run() {
  std::unique_lock lock(mutex_);
  thread_ = std::this_thread::get_id();
  while (!stopping_) {
    const auto due = NextDue();
    if (due == entries_.end()) {
      work_.wait(lock);
      continue;
    }
    const double wait_s = due->second->earliest_s - base::SteadySeconds();
    if (wait_s > 0) {
      work_.wait_for(lock, std::chrono::duration<double>(wait_s));
      continue;
    }
    const uint64_t number = due->first;
    std::shared_ptr<Entry> entry = due->second;
    calling_ = number;
    entry->changed = false;
    entry->earliest_s = base::SteadySeconds() + kMinIntervalS;
    lock.unlock();
    const bool last = Call(*entry);
    lock.lock();
    entry->over = last;
    lock.unlock();
    entry.reset();  // Unlocked: what a callback owns may do anything as it goes.
    lock.lock();
    calling_ = 0;
    called_.notify_all();
  }
}

// The changed entry that has waited longest, so that all get their turn.
Subscription::Hub::Entries::iterator Subscription::Hub::NextDue() {
  auto due = entries_.end();
  for (auto entry = entries_.begin(); entry != entries_.end(); ++entry) {
    if (!entry->second->changed || entry->second->over) continue;
    if (due == entries_.end() || entry->second->earliest_s < due->second->earliest_s) due = entry;
  }
  return due;
}

// True if it was the last call.
bool Subscription::Hub::Call(const Entry& entry) const {
  try {
    const Result<JobStatus> status = read_(entry.job_id);
    entry.callback(status);
    return !status || storage::HasEnded(status->job.state);
  } catch (const std::exception& e) {
    spdlog::error("job_watch_failed job={} error=\"{}\"", entry.job_id, e.what());
  } catch (...) {
    spdlog::error("job_watch_failed job={} error=\"not a std::exception\"", entry.job_id);
  }
  return true;
}

Subscription::Subscription(Subscription&& other) noexcept
    : hub_(std::move(other.hub_)), number_(std::exchange(other.number_, 0)) {}

Subscription& Subscription::operator=(Subscription&& other) noexcept {
  if (this == &other) return *this;
  Reset();
  hub_ = std::move(other.hub_);
  number_ = std::exchange(other.number_, 0);
  return *this;
}

void Subscription::Reset() {
  if (const auto hub = hub_.lock()) hub->Remove(number_);
  hub_.reset();
}

Watchers::Watchers(Reader read)
    : hub_(std::make_shared<Subscription::Hub>(std::move(read))),
      thread_([hub = hub_] { hub->Run(); }) {}

Watchers::~Watchers() {
  hub_->Stop();
  thread_.join();
}

Subscription Watchers::Watch(std::string job_id, Callback callback) {
  return {hub_, hub_->Add(std::move(job_id), std::move(callback))};
}

void Watchers::Changed(const std::string& job_id) { hub_->MarkChanged(job_id); }

}  // namespace mane::jobs
