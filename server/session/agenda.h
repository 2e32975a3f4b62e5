#pragma once

#include <cstdint>
#include <set>
#include <unordered_map>
#include <utility>
#include <vector>

namespace mane::session {

/// When each of many heads wants to be looked at next: at one moment, or at none. Every method but
/// TakeDue takes O(log n); so does TakeDue for each head that is due.
///
/// Threads: none of its own; guarded by its owner.
class Agenda {
 public:
  /// `id` wants to be looked at at `time` [s], and no longer when it wanted before.
  void Set(uint64_t id, double time);
  /// `id` wants nothing; no effect if it wanted nothing before.
  void Remove(uint64_t id);
  /// Removes and returns what is due at `now` [s] or before, the earliest first.
  [[nodiscard]] std::vector<uint64_t> TakeDue(double now);
  /// The earliest moment [s]; infinity where nobody wants anything.
  [[nodiscard]] double next() const;

 private:
  std::set<std::pair<double, uint64_t>> moments_;
  std::unordered_map<uint64_t, double> moment_of_;
};

}  // namespace mane::session
