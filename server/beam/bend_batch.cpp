#include "beam/bend_batch.h"

#include <algorithm>

#include "base/check.h"
#include "beam/packing.h"

namespace mane::beam {
namespace {

using Eigen::Vector3d;

template <typename T>
BendForce<T> ForceOf(const Force& force, const Hull& hull) {
  using Kind = typename BendForce<T>::Kind;
  BendForce<T> out{};
  out.kind = force.kind == Force::Kind::kUniform  ? Kind::kUniform
             : force.kind == Force::Kind::kToward ? Kind::kToward
                                                  : Kind::kAround;
  Fill<T>(force.vector, out.vector);
  Fill<T>(force.point - hull.center, out.point);
  out.strength = static_cast<T>(force.strength);
  out.softening = static_cast<T>(force.softening);
  out.plane_count = static_cast<int>(force.where.size());
  return out;
}

}  // namespace

template <typename T>
BendBatch<T>::BendBatch(std::span<const double> weights, const BendField& field, const Hull& hull)
    : hull_(hull), weights_(weights.begin(), weights.end()), scene_{} {
  MANE_CHECK(field.forces.size() <= 32);
  for (const Force& force : field.forces) {
    forces_.emplace_back(ForceOf<T>(force, hull));
    for (const HalfSpace& half : force.where) {
      for (int j = 0; j < 3; ++j) planes_.emplace_back(static_cast<T>(half.normal[j]));
      planes_.emplace_back(static_cast<T>(half.offset - half.normal.dot(hull.center)));
    }
  }
  const T* next = planes_.data();
  for (BendForce<T>& force : forces_) {
    force.planes = next;
    next += bend_layout::kPlaneNumbers * force.plane_count;
  }
  Fill<T>(hull.radii.cwiseInverse(), scene_.inverse_radii);
  Fill<T>(field.gravity, scene_.gravity);
  scene_.forces = forces_.data();
  scene_.force_count = static_cast<int>(forces_.size());
}

template <typename T>
size_t BendBatch<T>::hair_rows() const {
  return bend_layout::kFirstForce + forces_.size();
}

template <typename T>
void BendBatch<T>::Bend(const KernelTable<T>& kernels, std::span<const BendHair> hairs,
                        std::span<Row> rows, std::span<Row> nodes) const {
  for (int lane = 0; lane < simd::kLanes; ++lane) {
    const BendHair& hair = hairs[std::min<size_t>(lane, hairs.size() - 1)];
    const auto put = [&](int row, double value) { rows[row].lane[lane] = static_cast<T>(value); };
    SetLane<T>(hair.root - hull_.center, lane, &rows[bend_layout::kRoot]);
    SetLane<T>(hair.direction, lane, &rows[bend_layout::kDirection]);
    put(bend_layout::kLength, hair.segment_length);
    put(bend_layout::kSoftness, hair.softness);
    for (int f = 0; f < scene_.force_count; ++f) {
      put(bend_layout::kFirstForce + f, hair.forces >> f & 1);
    }
  }
  kernels.bend.bend(segments(), weights_.data(), scene_, rows.data()->lane, nodes.data()->lane);
}

template class BendBatch<float>;
template class BendBatch<double>;

}  // namespace mane::beam
