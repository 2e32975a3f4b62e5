#include "contact/wisp_ends.h"

namespace mane::contact {

using Eigen::Vector3d;

void ListEnds(std::span<const WispPair> pairs, size_t points, WispScratch& scratch) {
  auto& first = scratch.first_end;
  first.assign(points + 1, 0);
  for (const WispPair& pair : pairs) {
    for (const int32_t point : pair.point) ++first[static_cast<size_t>(point)];
  }
  int32_t sum = 0;
  for (int32_t& k : first) k = sum += k;
  scratch.ends.resize(static_cast<size_t>(sum));
  for (size_t i = pairs.size(); i-- > 0;) {
    for (int side = 2; side-- > 0;) {
      const auto point = static_cast<size_t>(pairs[i].point[side]);
      scratch.ends[static_cast<size_t>(--first[point])] = {static_cast<int32_t>(i), side};
    }
  }
}

void SpreadImpulses(int begin, int end, std::span<const WispPair> pairs, const WispScratch& scratch,
                    const ImpulseSpans& impulses) {
  SumAtPoints(
      begin, end, pairs, scratch, Vector3d(Vector3d::Zero()),
      [&](const WispPair& pair, int side) {
        const Vector3d impulse = pair.impulse.cast<double>();
        return Vector3d(side == 0 ? impulse : Vector3d(-impulse));
      },
      [&](size_t p, const Vector3d& sum) {
        impulses.x[p] = static_cast<float>(sum.x());
        impulses.y[p] = static_cast<float>(sum.y());
        impulses.z[p] = static_cast<float>(sum.z());
      });
}

void SpreadImpulses(std::span<const WispPair> pairs, const WispScratch& scratch,
                    exec::WorkerPool& pool, const ImpulseSpans& impulses) {
  pool.ParallelFor(static_cast<int>(impulses.x.size()), kPointsAPiece, [&](int begin, int end) {
    SpreadImpulses(begin, end, pairs, scratch, impulses);
  });
}

}  // namespace mane::contact
