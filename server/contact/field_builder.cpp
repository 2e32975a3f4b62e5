#include "contact/field_builder.h"

#include <fmt/format.h>

#include <Eigen/Geometry>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <utility>

#include "contact/field_block.h"
#include "contact/field_match.h"
#include "math/random.h"

namespace mane::contact {
namespace {

using Eigen::Vector3d;

constexpr int kFinest = 16;            // Cells along a child's side.
constexpr double kMaxRoots = 1 << 20;  // Root cells; larger ones for larger bodies.
constexpr double kLeastRoots = 4;      // Along the longest side of a small body.
constexpr double kSlope = 0.1;         // Of the tolerance beyond the band.
constexpr int kManyCells = 4;          // Along a side: then their middles are tests enough,
constexpr double kMiddle = 0.7;        // to this share of the tolerance.
constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr int kGrain = 16;  // Root cells a piece.

// One of so many root cells is divided before all are, where they are at least so many samples, to
// tell what would take some times what there is; what takes less tells itself.
constexpr int kSampled = 61;
constexpr int kLeastSamples = 8;
constexpr uint64_t kSurely = 3;

constexpr uint64_t kLooksSeed = 0x6d616e65;

// What the interpolation misses in a cell of side s, over s: at the worst, where all corners look
// away from one point; and per difference of two corners' normals, across a fold (D13).
constexpr double kCusp = 0.44;
constexpr double kFold = 0.125;

// A cell whose corners see a fold that may miss this many tolerances is cut, whatever tests say.
constexpr double kFolded = 2;

NodeBlock BlockOf(const FieldBlock& block) {
  const size_t row = block.counts()[0];
  const auto n = static_cast<int>(row) - 1;
  return {block.nodes().data(), row, row * row, n, static_cast<float>(n * block.step())};
}

// Largest difference of two corners' normals.
double Spread(const FieldBlock& block) {
  float squared = 0;
  for (const FieldGrid::Node& a : block.nodes()) {
    for (const FieldGrid::Node& b : block.nodes()) {
      const float x = a.gx - b.gx, y = a.gy - b.gy, z = a.gz - b.gz;
      squared = std::max(squared, x * x + y * y + z * z);
    }
  }
  return std::sqrt(squared);
}

}  // namespace

// What a piece of the root cells becomes. Places are relative to the piece's own lists.
struct FieldBuilder::Piece {
  std::vector<int> divided;               // Root cells.
  std::vector<FieldGrid::Cell> children;  // Of each of them.
  std::vector<FieldGrid::Node> nodes;     // Of their corners, then of cut children.

  // Takes over a block; returns where its first corner lies.
  uint32_t Add(const FieldBlock& block) {
    const auto first = static_cast<uint32_t>(nodes.size());
    nodes.insert(nodes.end(), block.nodes().begin(), block.nodes().end());
    return first;
  }
};

double FieldBuilder::Allowed(double distance) const {
  return options_.tolerance + kSlope * std::max(0.0, distance - options_.band);
}

void FieldBuilder::LayOut() {
  Eigen::AlignedBox3d box;
  for (const Triangle& t : truth_.surface().triangles) {
    for (const uint32_t v : t) box.extend(truth_.surface().vertices[v]);
  }
  const Vector3d extent = box.sizes();
  double side = std::min(options_.root_side, extent.maxCoeff() / kLeastRoots);
  for (;; side *= 1.1) {
    // The band lies within, with a cell to spare.
    const double margin = std::min(options_.band, 4 * side) + side;
    const Vector3d cells = ((extent.array() + 2 * margin) / side).ceil();
    if (cells.prod() > kMaxRoots) continue;
    for (int i = 0; i < 3; ++i) grid_.cells[i] = static_cast<int>(cells[i]);
    grid_.side = side;
    grid_.origin = box.center() - side / 2 * cells;
    break;
  }
  // A number of float32, so that positions differ from their corners' by nothing but rounding.
  grid_.origin = grid_.origin.cast<float>().cast<double>();
  cells_ = grid_.cells;
  grid_.index.resize(grid_.Roots());
  for (int root = 0; root < grid_.Roots(); ++root) {
    const auto [x, y, z] = PlaceOf(root);
    grid_.index[root].first = static_cast<uint32_t>(grid_.RootNode(x, y, z));
    grid_.index[root].row = cells_[0] + 1;
  }
}

void FieldBuilder::SampleRoots() {
  const int along = cells_[0] + 1, columns = cells_[1] + 1, layers = cells_[2] + 1;
  FieldBlock roots(truth_, grid_.origin, grid_.side, {0, 0, 0}, {along, columns, layers});
  pool_->ParallelFor(columns * layers, 16, [&](int begin, int end) {
    const SearchBudget::Share own_work(budget_);
    for (int row = begin; row < end && !budget_->over(); ++row) {
      const int j = row % columns, k = row / columns;
      double bound = kInfinity;
      if (row > begin && j > 0) bound = roots.distance(roots.At(0, j - 1, k)) + grid_.side;
      for (int i = 0; i < along; ++i) {
        roots.Measure(i, j, k, bound);
        bound = roots.distance(roots.At(i, j, k)) + grid_.side;
      }
    }
  });
  roots.Sign();
  grid_.nodes = roots.nodes();
  root_distance_.resize(roots.size());
  for (size_t i = 0; i < roots.size(); ++i) root_distance_[i] = roots.distance(i);
}

std::array<int, 3> FieldBuilder::PlaceOf(int root) const {
  const int row = root / cells_[0];
  return {root % cells_[0], row % cells_[1], row / cells_[1]};
}

FieldBlock FieldBuilder::RootBlock(int root) const {
  const std::array<int, 3> place = PlaceOf(root);
  FieldBlock block(truth_, grid_.origin, grid_.side, place, {2, 2, 2});
  for (int corner = 0; corner < 8; ++corner) {
    const int i = corner & 1, j = corner >> 1 & 1, k = corner >> 2;
    const size_t node = grid_.RootNode(place[0] + i, place[1] + j, place[2] + k);
    block.Adopt(i, j, k, grid_.nodes[node], root_distance_[node]);
  }
  return block;
}

// Whether the interpolation of `coarse` is good at every corner of `fine`, its halved block.
bool FieldBuilder::FitsCorners(const FieldBlock& coarse, const FieldBlock& fine) const {
  const NodeBlock block = BlockOf(coarse);
  const int n = fine.counts()[0];
  const float share = 1.0F / static_cast<float>(n - 1);
  for (size_t corner = 0; corner < fine.size(); ++corner) {
    const auto [i, j, k] = fine.PlaceOf(corner);
    const float d = Interpolate(block, static_cast<float>(i) * share, static_cast<float>(j) * share,
                                static_cast<float>(k) * share)
                        .d;
    if (!(std::abs(d - fine.nodes()[corner].d) <= Allowed(fine.distance(corner)))) return false;
  }
  return true;
}

// Whether the interpolation is good in the middle of every cell of `block`.
bool FieldBuilder::FitsMiddles(const FieldBlock& block) const {
  const NodeBlock nodes = BlockOf(block);
  const int n = nodes.n;
  const double reach = std::sqrt(3) / 2 * block.step();  // From the middle to a corner.
  for (int cell = 0; cell < n * n * n; ++cell) {
    const int i = cell % n, j = cell / n % n, k = cell / n / n;
    const Vector3d middle = block.Position(i, j, k) + Vector3d::Constant(block.step() / 2);
    size_t farthest = block.At(i, j, k);
    double bound = kInfinity;
    for (int corner = 0; corner < 8; ++corner) {
      const size_t at = block.At(i + (corner & 1), j + (corner >> 1 & 1), k + (corner >> 2));
      bound = std::min(bound, block.distance(at) + reach);
      if (block.distance(at) > block.distance(farthest)) farthest = at;
    }
    const double exact = truth_.Closest(middle, bound).distance;
    const bool together = exact + block.distance(farthest) > reach * (1 + 1e-6);  // (D9)
    const bool inside = together ? block.nodes()[farthest].d < 0 : truth_.Inside(middle);
    const auto share = [n](int place) {
      return (static_cast<float>(place) + 0.5F) / static_cast<float>(n);
    };
    const double d = Interpolate(nodes, share(i), share(j), share(k)).d;
    if (!(std::abs(d - (inside ? -exact : exact)) <= kMiddle * Allowed(exact))) return false;
  }
  return true;
}

// No point of a single cell is nearer to the surface: distances change by no more than the way.
double FieldBuilder::Away(const FieldBlock& block) const {
  double nearest = kInfinity;
  for (size_t i = 0; i < block.size(); ++i) nearest = std::min(nearest, block.distance(i));
  return std::max(0.0, nearest - std::sqrt(3) / 2 * block.step());
}

// Whether a single cell is so far away that no interpolation of it can fail.
bool FieldBuilder::NeedsNoTest(const FieldBlock& block) const {
  const double away = Away(block);
  const double worst = kCusp * block.step(), fold = kFold * Spread(block) * block.step();
  return worst < Allowed(away) || (away > options_.band && fold < Allowed(away));
}

// Cuts a single cell as finely as it needs.
FieldBlock FieldBuilder::Cut(FieldBlock block) const {
  if (NeedsNoTest(block)) return block;
  // A fold may miss all the places that are tested.
  const bool folded = kFold * Spread(block) * block.step() > kFolded * Allowed(Away(block));
  for (int n = 1; n < kFinest; n *= 2) {
    if (n >= kManyCells && FitsMiddles(block)) break;
    FieldBlock fine = block.Halved();
    if (n < kManyCells && !(folded && n == 1) && FitsCorners(block, fine)) break;
    block = std::move(fine);
  }
  return block;
}

void FieldBuilder::DivideRoot(int root, Piece* piece) const {
  const FieldBlock whole = RootBlock(root);
  if (NeedsNoTest(whole)) return;
  const FieldBlock half = whole.Halved();
  if (Away(whole) > options_.band && FitsCorners(whole, half)) return;
  constexpr int n = FieldGrid::kChildren;
  const FieldBlock parent = half.Halved();
  const uint32_t first = piece->Add(parent);
  piece->divided.push_back(root);
  for (int child = 0; child < n * n * n; ++child) {
    const int i = child % n, j = child / n % n, k = child / n / n;
    const FieldBlock block = Cut(parent.Child(i, j, k));
    const uint32_t row = block.counts()[0];
    FieldGrid::Cell cell;
    cell.n = row - 1;
    cell.row = row == 2 ? n + 1 : row;
    cell.first = row == 2 ? first + static_cast<uint32_t>(parent.At(i, j, k)) : piece->Add(block);
    piece->children.push_back(cell);
  }
}

// Refuses soon what would be refused late.
Result<void> FieldBuilder::LookAhead() const {
  const int samples = grid_.Roots() / kSampled;
  if (samples < kLeastSamples) return {};
  SearchBudget sampled(kSurely * budget_->most() / kSampled, budget_->cancelled());
  pool_->ParallelFor(samples, 1, [&](int sample, int /*end*/) {
    const SearchBudget::Share own_work(&sampled);
    Piece thrown_away;
    if (!sampled.over()) DivideRoot(sample * kSampled, &thrown_away);
  });
  auto within = sampled.Check();
  if (within || within.error().code == ErrorCode::kCancelled) return within;
  return budget_->TooMuch();
}

Result<void> FieldBuilder::DivideAll() {
  const int roots = grid_.Roots();
  std::vector<Piece> pieces((roots + kGrain - 1) / kGrain);
  std::atomic<size_t> bytes{grid_.Bytes()};
  pool_->ParallelFor(roots, kGrain, [&](int begin, int end) {
    const SearchBudget::Share own_work(budget_);
    Piece& piece = pieces[begin / kGrain];
    for (int root = begin; root < end && bytes <= options_.max_bytes && !budget_->over(); ++root) {
      const size_t nodes = piece.nodes.size();
      DivideRoot(root, &piece);
      bytes += (piece.nodes.size() - nodes) * sizeof(FieldGrid::Node);
    }
  });
  if (auto within = budget_->Check(); !within) return within;
  if (bytes > options_.max_bytes) {
    return Error{
        ErrorCode::kResourceExhausted,
        fmt::format("triangles need a distance field of more than {} bytes, the limit, for "
                    "an error of {} m within {} m of a surface as large and as rough: use a "
                    "smaller or smoother one",
                    options_.max_bytes, options_.tolerance, options_.band),
        "triangles"};
  }
  grid_.nodes.reserve(bytes / sizeof(FieldGrid::Node));
  for (Piece& piece : pieces) {
    const auto first_node = static_cast<uint32_t>(grid_.nodes.size());
    constexpr int kAll = FieldGrid::kChildren * FieldGrid::kChildren * FieldGrid::kChildren;
    for (size_t i = 0; i < piece.divided.size(); ++i) {
      FieldGrid::Cell& root = grid_.index[piece.divided[i]];
      root.n = 0;
      root.first = static_cast<uint32_t>(grid_.index.size() + i * kAll);
    }
    for (FieldGrid::Cell& child : piece.children) child.first += first_node;
    grid_.index.insert(grid_.index.end(), piece.children.begin(), piece.children.end());
    grid_.nodes.insert(grid_.nodes.end(), piece.nodes.begin(), piece.nodes.end());
    piece = {};
  }
  return {};
}

void FieldBuilder::MatchAll() {
  // Large cells first: they are final when smaller ones look at them.
  for (int step = kUnits / FieldGrid::kChildren; step >= 1; step /= 2) {
    pool_->ParallelFor(grid_.Roots(), kGrain, [&](int begin, int end) {
      for (int root = begin; root < end; ++root) {
        if (grid_.index[root].n == 0) MatchRoot(PlaceOf(root), step, &grid_);
      }
    });
  }
}

Result<FieldGrid> FieldBuilder::Build() {
  LayOut();
  SampleRoots();
  if (auto within = budget_->Check(); !within) return within.error();
  if (auto within = LookAhead(); !within) return within.error();
  if (auto divided = DivideAll(); !divided) return divided.error();
  MatchAll();
  return std::move(grid_);
}

double FieldBuilder::MaxError(const FieldGrid& grid) const {
  std::vector<double> worst(grid.Roots(), 0);
  constexpr int n = FieldGrid::kChildren;
  pool_->ParallelFor(static_cast<int>(worst.size()), kGrain, [&](int begin, int end) {
    const SearchBudget::Share own_work(budget_);
    for (int root = begin; root < end && !budget_->over(); ++root) {
      if (grid.index[root].n != 0) continue;
      const std::array<int, 3> place = PlaceOf(root);
      const Vector3d low = grid.origin + grid.side * Vector3d(place[0], place[1], place[2]);
      math::RandomStream random(kLooksSeed, root);
      for (int child = 0; child < n * n * n; ++child) {
        const int looks = static_cast<int>(grid.index[grid.index[root].first + child].n);
        const Vector3d at(child % n, child / n % n,
                          child / n / n);  // NOLINT(bugprone-integer-division)
        for (int look = 0; look < looks; ++look) {
          const Vector3d share =
              (at + Vector3d(random.Uniform(), random.Uniform(), random.Uniform())) / n;
          worst[root] = std::max(worst[root], ErrorAt(grid, root, low, share));
        }
      }
    }
  });
  return *std::ranges::max_element(worst);
}

double FieldBuilder::ErrorAt(const FieldGrid& grid, int root, const Vector3d& low,
                             const Vector3d& share) const {
  float place[3] = {static_cast<float>(share[0]), static_cast<float>(share[1]),
                    static_cast<float>(share[2])};
  const NodeBlock block = Locate(grid, root, place);
  const FieldSample sample = Interpolate(block, place[0], place[1], place[2]);
  if (std::abs(sample.d) > options_.band + 2 * options_.tolerance) return 0;
  const Vector3d point = low + grid.side * share;
  const double exact = truth_.Closest(point, std::abs(sample.d) + options_.tolerance).distance;
  if (exact > options_.band) return 0;
  const double from_first = block.side * Vector3d(place[0], place[1], place[2]).norm();
  const double first = block.first->d;
  const bool together = exact + std::abs(first) > (from_first + options_.tolerance) * 1.000001;
  const bool inside = together ? first < 0 : truth_.Inside(point);
  return std::abs(sample.d - (inside ? -exact : exact));
}

}  // namespace mane::contact
