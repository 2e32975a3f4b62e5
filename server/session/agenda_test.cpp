// An agenda against a list that is searched: what is due, in which order, and when next.

#include "session/agenda.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <map>
#include <random>

namespace mane::session {
namespace {

TEST(AgendaTest, SaysWhatAListSays) {
  std::mt19937_64 rng(20261127);
  std::uniform_int_distribution<uint64_t> any_id(1, 40);
  std::uniform_int_distribution<int> any_time(0, 30), any_act(0, 9);  // Times that coincide, too.
  Agenda agenda;
  std::map<uint64_t, double> list;
  double now = 0;
  for (int i = 0; i < 5000; ++i) {
    SCOPED_TRACE(i);
    const uint64_t id = any_id(rng);
    const int act = any_act(rng);
    if (act < 6) {
      list[id] = now + any_time(rng);
      agenda.Set(id, list[id]);
    } else if (act < 8) {
      list.erase(id);
      agenda.Remove(id);
    } else {
      now += 1;
      std::vector<std::pair<double, uint64_t>> due;
      for (const auto& [own, time] : list) {
        if (time <= now) due.emplace_back(time, own);
      }
      std::ranges::sort(due);
      std::vector<uint64_t> ids;
      for (const auto& [time, own] : due) {
        ids.push_back(own);
        list.erase(own);
      }
      EXPECT_EQ(agenda.TakeDue(now), ids);
    }
    double next = std::numeric_limits<double>::infinity();
    for (const auto& [own, time] : list) next = std::min(next, time);
    EXPECT_EQ(agenda.next(), next);
  }
}

}  // namespace
}  // namespace mane::session
