#include "session/agenda.h"

#include <limits>

namespace mane::session {

void Agenda::Set(uint64_t id, double time) {
  Remove(id);
  moments_.emplace(time, id);
  moment_of_.emplace(id, time);
}

void Agenda::Remove(uint64_t id) {
  const auto found = moment_of_.find(id);
  if (found == moment_of_.end()) return;
  moments_.erase({found->second, id});
  moment_of_.erase(found);
}

std::vector<uint64_t> Agenda::TakeDue(double now) {
  std::vector<uint64_t> due;
  while (!moments_.empty() && moments_.begin()->first <= now) {
    due.push_back(moments_.begin()->second);
    moment_of_.erase(due.back());
    moments_.erase(moments_.begin());
  }
  return due;
}

double Agenda::next() const {
  return moments_.empty() ? std::numeric_limits<double>::infinity() : moments_.begin()->first;
}

}  // namespace mane::session
