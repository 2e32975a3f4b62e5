#include "styling/selection.h"

#include <fmt/format.h>

#include <algorithm>
#include <numbers>
#include <utility>

#include "styling/constraint.h"
#include "styling/region.h"

namespace mane::styling {
namespace {

// Sorts wisps by azimuth, beginning after the widest gap between them.
void SortAround(const Roots& roots, const ScalpChart& chart, std::vector<uint32_t>* wisps) {
  const auto azimuth = [&](uint32_t wisp) {
    return chart.At(roots.masters[wisp].position).azimuth;
  };
  std::sort(wisps->begin(), wisps->end(), [&](uint32_t a, uint32_t b) {
    return std::pair(azimuth(a), a) < std::pair(azimuth(b), b);
  });
  size_t begin = 0;
  double widest = 2 * std::numbers::pi - (azimuth(wisps->back()) - azimuth(wisps->front()));
  for (size_t i = 1; i < wisps->size(); ++i) {
    const double gap = azimuth((*wisps)[i]) - azimuth((*wisps)[i - 1]);
    if (gap <= widest) continue;
    widest = gap;
    begin = i;
  }
  std::rotate(wisps->begin(), wisps->begin() + static_cast<long>(begin), wisps->end());
}

}  // namespace

Result<std::vector<std::vector<uint32_t>>> SelectWisps(const std::vector<ConstraintQueue>& queues,
                                                       const Roots& roots, const ScalpChart& chart,
                                                       const std::string& field) {
  std::vector<std::vector<uint32_t>> selected(queues.size());
  for (size_t i = 0; i < queues.size(); ++i) {
    const ConstraintQueue& queue = queues[i];
    const std::string path = fmt::format("{}.queues[{}].selection", field, i);
    std::vector<uint32_t> all;
    for (int wisp = 0; wisp < roots.wisps(); ++wisp) {
      const auto number = static_cast<uint32_t>(wisp);
      const Eigen::Vector3d& root = roots.masters[wisp].position;
      if (Contains(queue.selection, chart, root, number)) all.push_back(number);
    }
    const size_t parts = static_cast<size_t>(std::max(queue.share_count, 1));
    if (all.size() < parts) {
      return InvalidArgument(path,
                             fmt::format("{} (\"{}\") holds {} wisps of this head; it needs {} "
                                         "at least: use a larger region, or more wisps",
                                         path, queue.name, all.size(), parts));
    }
    if (parts > 1) {
      SortAround(roots, chart, &all);
      const auto share = static_cast<size_t>(queue.share);
      all = {all.begin() + static_cast<long>(all.size() * share / parts),
             all.begin() + static_cast<long>(all.size() * (share + 1) / parts)};
      std::sort(all.begin(), all.end());
    }
    selected[i] = std::move(all);
  }
  const auto apart = ValidateSelections(queues, selected, roots.wisps(), field + ".queues");
  if (!apart) return apart.error();
  return selected;
}

}  // namespace mane::styling
