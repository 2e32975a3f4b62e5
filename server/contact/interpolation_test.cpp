// The interpolation in a block of cells, (D10) and (D11):
//   exact        for quadratic fields, in value; for linear ones in gradient
//   order        a ball's distance errs with h^3 near its surface, its normal with h^2
//   bound        no more than (D13) at folds and cusps
//   continuous   on the common face of a block and one cut finer, whose corners were matched

#include <gtest/gtest.h>

#include <Eigen/Core>

#include <cmath>
#include <functional>
#include <random>
#include <vector>

#include "contact/field_grid.h"
#include "contact/field_match.h"

namespace mane::contact {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using Node = FieldGrid::Node;
using Field = std::function<double(const Vector3d&, Vector3d*)>;  // Value and gradient.

Node Take(const Field& field, const Vector3d& p) {
  Vector3d g;
  const double d = field(p, &g);
  return {static_cast<float>(d), static_cast<float>(g.x()), static_cast<float>(g.y()),
          static_cast<float>(g.z())};
}

// A block of n^3 cells over the cube of this side from `low`.
class Block {
 public:
  Block(const Field& field, const Vector3d& low, double side, int n)
      : low_(low), side_(side), n_(n) {
    for (int k = 0; k <= n; ++k) {
      for (int j = 0; j <= n; ++j) {
        for (int i = 0; i <= n; ++i) {
          nodes_.push_back(Take(field, low + side / n * Vector3d(i, j, k)));
        }
      }
    }
  }
  [[nodiscard]] FieldSample At(const Vector3d& p) const {
    const Vector3d s = (p - low_) / side_;
    const size_t row = n_ + 1;
    return Interpolate({nodes_.data(), row, row * row, n_, static_cast<float>(side_)},
                       static_cast<float>(s.x()), static_cast<float>(s.y()),
                       static_cast<float>(s.z()));
  }

 private:
  Vector3d low_;
  double side_;
  int n_;
  std::vector<Node> nodes_;
};

double Ball(const Vector3d& p, Vector3d* g) {
  *g = p.normalized();
  return p.norm() - 0.1;
}

class InterpolationTest : public ::testing::Test {
 protected:
  Vector3d Share() { return {unit_(rng_), unit_(rng_), unit_(rng_)}; }
  std::mt19937_64 rng_{20240121};
  std::uniform_real_distribution<double> unit_{0, 1};
};

TEST_F(InterpolationTest, IsExactForQuadraticFields) {
  Matrix3d A;
  A << 2, 0, 0, 0, -1, 0, 0, 0, 3;  // Mixed terms are of the mean's own order: see below.
  const Vector3d b(0.3, -0.7, 0.2);
  const Field field = [&](const Vector3d& p, Vector3d* g) {
    *g = A * p + b;
    return 0.5 * p.dot(A * p) + b.dot(p) + 0.4;
  };
  const Block block(field, {-0.3, 0.1, 0.2}, 1, 2);
  for (int i = 0; i < 500; ++i) {
    const Vector3d p = Vector3d(-0.3, 0.1, 0.2) + Share();
    Vector3d g;
    const double exact = field(p, &g);
    const FieldSample s = block.At(p);
    EXPECT_NEAR(s.d, exact, 2e-6);
    EXPECT_LT((Vector3d(s.gx, s.gy, s.gz) - g).norm(), 2e-6);
  }
}

TEST_F(InterpolationTest, IsExactForMixedTermsToo) {
  const Field field = [&](const Vector3d& p, Vector3d* g) {
    *g = {p.y() + p.z(), p.x() - 2 * p.z(), p.x() - 2 * p.y()};
    return p.x() * p.y() + p.x() * p.z() - 2 * p.y() * p.z();
  };
  const Block block(field, {0, 0, 0}, 1, 1);
  for (int i = 0; i < 500; ++i) {
    const Vector3d p = Share();
    Vector3d g;
    EXPECT_NEAR(block.At(p).d, field(p, &g), 2e-6);
  }
}

TEST_F(InterpolationTest, ErrsWithTheCubeOfTheCell) {
  double last = 0, last_normal = 0;
  for (const int n : {4, 8, 16}) {
    const Block block(Ball, {0.03, 0.04, 0.05}, 0.064, n);
    double worst = 0, worst_normal = 0;
    for (int i = 0; i < 4000; ++i) {
      const Vector3d p = Vector3d(0.03, 0.04, 0.05) + 0.064 * Share();
      const FieldSample s = block.At(p);
      worst = std::max(worst, std::abs(s.d - p.norm() + 0.1));
      worst_normal = std::max(worst_normal, (Vector3d(s.gx, s.gy, s.gz) - p.normalized()).norm());
    }
    if (n > 4) {
      EXPECT_LT(worst, last / 6) << n;
      EXPECT_LT(worst_normal, last_normal / 3) << n;
    }
    last = worst;
    last_normal = worst_normal;
  }
}

TEST_F(InterpolationTest, FoldsAndCuspsKeepTheBound) {
  for (int trial = 0; trial < 200; ++trial) {
    const Vector3d n = (Share() - Vector3d::Constant(0.5)).normalized(), at = Share();
    const Field fold = [&](const Vector3d& p, Vector3d* g) {
      const double x = (p - at).dot(n);
      *g = x > 0 ? Vector3d(-n) : n;
      return -std::abs(x);
    };
    const Field cusp = [&](const Vector3d& p, Vector3d* g) {
      *g = -(p - at).normalized();
      return -(p - at).norm();
    };
    const Block folded(fold, Vector3d::Zero(), 1, 1), pointed(cusp, Vector3d::Zero(), 1, 1);
    for (int i = 0; i < 200; ++i) {
      const Vector3d p = i == 0 ? at : Share();
      Vector3d g;
      EXPECT_NEAR(folded.At(p).d, fold(p, &g), 0.2501);
      EXPECT_NEAR(pointed.At(p).d, cusp(p, &g), 0.4331);
    }
  }
}

TEST_F(InterpolationTest, IsContinuousAcrossCellsOfDifferentSize) {
  // Two divided root cells and one that is not; children of every size beside each other.
  FieldGrid grid;
  grid.origin = {-0.05, 0.04, 0.03};
  grid.side = 0.05;
  grid.cells = {3, 1, 1};
  for (int z = 0; z < 2; ++z) {
    for (int y = 0; y < 2; ++y) {
      for (int x = 0; x < 4; ++x) {
        grid.nodes.push_back(Take(Ball, grid.origin + grid.side * Vector3d(x, y, z)));
      }
    }
  }
  grid.index.resize(3);
  for (uint32_t root = 0; root < 3; ++root) grid.index[root].first = root;
  for (FieldGrid::Cell& cell : grid.index) cell.row = 4;
  for (const int root : {0, 1}) {
    grid.index[root].n = 0;
    grid.index[root].first = static_cast<uint32_t>(grid.index.size());
    const Vector3d low = grid.origin + Vector3d(root * grid.side, 0, 0);
    const auto add = [&](const Vector3d& at, double side, int n) {
      const auto first = static_cast<uint32_t>(grid.nodes.size());
      for (int k = 0; k <= n; ++k) {
        for (int j = 0; j <= n; ++j) {
          for (int i = 0; i <= n; ++i) {
            grid.nodes.push_back(Take(Ball, at + side / n * Vector3d(i, j, k)));
          }
        }
      }
      return first;
    };
    const uint32_t parent = add(low, grid.side, 4);
    for (int child = 0; child < 64; ++child) {
      const int i = child % 4, j = child / 4 % 4, k = child / 16;
      const int n = 1 << rng_() % 5;
      FieldGrid::Cell cell;
      cell.n = n;
      cell.row = n == 1 ? 5 : n + 1;
      cell.first = n == 1 ? parent + (k * 5 + j) * 5 + i
                          : add(low + grid.side / 4 * Vector3d(i, j, k), grid.side / 4, n);
      grid.index.push_back(cell);
    }
  }
  for (int step = kUnits / 4; step >= 1; step /= 2) {
    for (const int root : {0, 1}) MatchRoot({root, 0, 0}, step, &grid);
  }
  const auto sample = [&](int root, const Vector3d& share) {
    float s[3] = {static_cast<float>(share.x()), static_cast<float>(share.y()),
                  static_cast<float>(share.z())};
    const NodeBlock block = Locate(grid, root, s);
    return Interpolate(block, s[0], s[1], s[2]);
  };
  const auto expect_equal = [](const FieldSample& a, const FieldSample& b) {
    EXPECT_NEAR(a.d, b.d, 2e-7);
    EXPECT_NEAR(a.gx, b.gx, 2e-5);
    EXPECT_NEAR(a.gy, b.gy, 2e-5);
    EXPECT_NEAR(a.gz, b.gz, 2e-5);
  };
  for (int i = 0; i < 20000; ++i) {
    Vector3d a = Share();
    const int axis = static_cast<int>(rng_() % 3);
    a[axis] = static_cast<double>(1 + rng_() % 63) / 64;  // On a face of cells.
    Vector3d b = a;
    a[axis] -= 1e-7;
    b[axis] += 1e-7;
    expect_equal(sample(static_cast<int>(i % 2), a), sample(static_cast<int>(i % 2), b));
    Vector3d c = Share(), d = c;  // Between root cells.
    c.x() = 1;
    d.x() = 0;
    expect_equal(sample(0, c), sample(1, d));
    expect_equal(sample(1, c), sample(2, d));
  }
}

}  // namespace
}  // namespace mane::contact
