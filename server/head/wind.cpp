#include "head/wind.h"

#include <cmath>
#include <numbers>

#include "math/random.h"

namespace mane::head {
namespace {

using Eigen::Vector3d;
using rod::layout::kLanes;

constexpr double kTurn = 2 * std::numbers::pi;

Vector3d Direction(math::RandomStream& random) {
  while (true) {
    const Vector3d v(random.Normal(), random.Normal(), random.Normal());
    if (v.norm() > 1e-3) return v.normalized();
  }
}

// cos(2 pi x), to 2e-6: a polynomial, so that lanes are computed together and alike everywhere.
float CosineOfTurns(float x) {
  constexpr float kRound = 12582912.0F;  // 1.5 2^23: adding it rounds to whole numbers.
  x -= (x + kRound) - kRound;
  const float a = static_cast<float>(std::numbers::pi) * x, y = a * a;  // |a| <= pi / 2
  const float c =
      1 + y * (-1.0F / 2 +
               y * (1.0F / 24 + y * (-1.0F / 720 + y * (1.0F / 40320 + y * (-1.0F / 3628800)))));
  return 2 * c * c - 1;
}

}  // namespace

WindField::WindField(const Vector3d& mean, const WindVariation& variation)
    : mean_(mean), gust_strength_(variation.gust_strength), speed_(variation.turbulence_speed) {
  if (gust_strength_ > 0) {
    for (int i = 0; i < kGusts; ++i) {
      math::RandomStream random(variation.seed, i);
      const double period = variation.gust_period * std::exp2(random.Uniform(-1, 1));
      gusts_[i] = {kTurn / period, random.Uniform(0, kTurn)};
    }
  }
  if (speed_ <= 0) return;
  for (int i = 0; i < kEddies; ++i) {
    math::RandomStream random(variation.seed, 1000 + i);
    const double size = variation.turbulence_size * std::exp2(random.Uniform(-1, 1));
    const Vector3d direction = Direction(random);
    const Vector3d across = direction.cross(Direction(random)).stableNormalized();
    // Each carries its share of the mean square; it lives about as long as it takes to turn over.
    eddies_[i] = {kTurn / size * direction, std::sqrt(2.0 / kEddies) * speed_ * across,
                  kTurn / size * speed_ * random.Normal(), random.Uniform(0, kTurn)};
  }
}

Vector3d WindField::Mean(double t) const {
  if (gust_strength_ <= 0) return mean_;
  double sum = 0;
  for (const Gust& gust : gusts_) sum += std::cos(gust.frequency * t + gust.phase);
  return (1 + gust_strength_ * std::sqrt(2.0 / kGusts) * sum) * mean_;
}

void WindField::Evaluate(double t, const Vector3d& origin,
                         std::span<const rod::Row<float>, 3> offset, Lanes velocity) const {
  const Vector3d mean = Mean(t);
  for (int i = 0; i < 3; ++i) {
    for (float& v : velocity[i].lane) v = static_cast<float>(mean[i]);
  }
  if (!turbulent()) return;
  for (const Eddy& eddy : eddies_) {
    // In turns, of which only the fraction matters.
    const double phase = (eddy.k.dot(origin - t * mean_) + eddy.frequency * t + eddy.phase) / kTurn;
    const auto start = static_cast<float>(phase - std::floor(phase));
    const Eigen::Vector3f k = (eddy.k / kTurn).cast<float>(), u = eddy.velocity.cast<float>();
    for (int lane = 0; lane < kLanes; ++lane) {
      const float c = CosineOfTurns(start + k.x() * offset[0].lane[lane] +
                                    k.y() * offset[1].lane[lane] + k.z() * offset[2].lane[lane]);
      velocity[0].lane[lane] += u.x() * c;
      velocity[1].lane[lane] += u.y() * c;
      velocity[2].lane[lane] += u.z() * c;
    }
  }
}

}  // namespace mane::head
