#include "contact/boundary.h"

#include <algorithm>
#include <map>

#include "base/check.h"

namespace mane::contact {
namespace {

// Edges that more triangles have one way than the other, that way and that often, by their start.
std::map<uint32_t, std::vector<uint32_t>> OpenEdges(std::span<const Triangle> triangles) {
  struct Edge {
    uint32_t low, high;
    int way;  // 1 from low to high, else -1.
  };
  std::vector<Edge> edges;
  edges.reserve(3 * triangles.size());
  for (const Triangle& t : triangles) {
    for (int i = 0; i < 3; ++i) {
      const uint32_t a = t[i], b = t[(i + 1) % 3];
      edges.push_back({std::min(a, b), std::max(a, b), a < b ? 1 : -1});
    }
  }
  std::ranges::sort(edges, [](const Edge& a, const Edge& b) {
    return a.low < b.low || (a.low == b.low && a.high < b.high);
  });
  std::map<uint32_t, std::vector<uint32_t>> open;
  for (size_t i = 0; i < edges.size();) {
    const Edge& edge = edges[i];
    int net = 0;
    for (; i < edges.size() && edges[i].low == edge.low && edges[i].high == edge.high; ++i) {
      net += edges[i].way;
    }
    for (; net > 0; --net) open[edge.low].push_back(edge.high);
    for (; net < 0; ++net) open[edge.high].push_back(edge.low);
  }
  return open;
}

}  // namespace

std::vector<std::vector<uint32_t>> BoundaryLoops(std::span<const Triangle> triangles) {
  auto open = OpenEdges(triangles);
  std::vector<std::vector<uint32_t>> loops;
  std::vector<uint32_t> path;
  std::map<uint32_t, size_t> place;  // Of vertices in the path.
  while (!open.empty() || !path.empty()) {
    if (path.empty()) {
      place[open.begin()->first] = 0;
      path.push_back(open.begin()->first);
    }
    const auto here = open.find(path.back());
    if (here == open.end()) {  // As many edges arrive at a vertex as leave it: the path is done.
      MANE_CHECK(path.size() == 1);
      path.clear();
      place.clear();
      continue;
    }
    const uint32_t next = here->second.back();
    here->second.pop_back();
    if (here->second.empty()) open.erase(here);
    const auto [again, is_new] = place.emplace(next, path.size());
    if (is_new) {
      path.push_back(next);
      continue;
    }
    // Back at a vertex of the path: what lies since is a loop.
    const size_t begin = again->second;
    loops.emplace_back(path.begin() + static_cast<long>(begin), path.end());
    for (size_t i = begin + 1; i < path.size(); ++i) place.erase(path[i]);
    path.resize(begin + 1);
  }
  return loops;
}

}  // namespace mane::contact
