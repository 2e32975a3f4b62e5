#include "head/shown.h"

#include <algorithm>

namespace mane::head {

using Eigen::Vector3f;

double Remaining(const Transition& transition, double time) {
  const double u = std::clamp((time - transition.begin) / kTransitionTime, 0.0, 1.0);
  return 1 - u * u * (3 - 2 * u);
}

int ShownBlocks(const groom::Groom& groom, const HeadState& state) {
  return state.beams.active ? state.beams.beams->batch.blocks()
                            : static_cast<int>(groom.batch.blocks().size());
}

void PointsOfBeam(std::span<const Vector3f> nodes, std::span<Vector3f> points) {
  const auto segments = static_cast<int>(nodes.size()) - 1;
  const auto last = static_cast<int>(points.size()) - 1;
  for (int j = 0; j <= last; ++j) {
    // In whole numbers: a point that falls on a node is that node.
    const int i = std::min(j * segments / last, segments - 1);
    const float part = static_cast<float>(j * segments - i * last) / static_cast<float>(last);
    points[j] = nodes[i] + part * (nodes[i + 1] - nodes[i]);
  }
}

void AddOffsets(double remaining, const Eigen::Matrix3f& turn, std::span<const Vector3f> offsets,
                float longest, std::span<Vector3f> points) {
  const Eigen::Matrix3f part = static_cast<float>(remaining) * turn;
  Vector3f own = points[0];
  for (size_t j = 0; j < offsets.size(); ++j) {
    Vector3f chord = points[j + 1] - own + part * offsets[j];
    if (const float length = chord.norm(); length > longest) chord *= longest / length;
    own = points[j + 1];
    points[j + 1] = points[j] + chord;
  }
}

}  // namespace mane::head
