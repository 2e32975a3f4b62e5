#include "contact/repair.h"

#include <fmt/format.h>

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <unordered_map>

#include "contact/boundary.h"

namespace mane::contact {
namespace {

using Eigen::Vector3d;

// Vertices nearer than this share of the bounding box's diagonal are one.
constexpr double kWeldShare = 1e-6;

// A triangle less high than this share of its longest side has no area.
constexpr double kFlatShare = 1e-7;

// Least volume of a solid over its area to the power of 1.5; a ball has 0.094, a plate of
// 1 m x 1 m x 1 mm 3.5e-4.
constexpr double kLeastFullness = 1e-6;

Error TooMany(const char* field, size_t count, int limit) {
  return {ErrorCode::kResourceExhausted,
          fmt::format("{} holds {}; at most {} are taken", field, count, limit), field};
}

// Whether a triangle has it, for each vertex. The others are as if they were not there.
std::vector<bool> UsedVertices(const TriangleMesh& mesh) {
  std::vector<bool> used(mesh.vertices.size());
  for (const Triangle& t : mesh.triangles) {
    for (const uint32_t v : t) used[v] = true;
  }
  return used;
}

Result<void> CheckVertices(const TriangleMesh& mesh, const MeshLimits& limits) {
  const std::vector<bool> used = UsedVertices(mesh);
  Eigen::Vector3f low = mesh.vertices[mesh.triangles[0][0]], high = low;
  for (size_t i = 0; i < mesh.vertices.size(); ++i) {
    if (!used[i]) continue;
    const Eigen::Vector3f& v = mesh.vertices[i];
    if (!(v.cwiseAbs().maxCoeff() <= limits.max_coordinate) || !v.allFinite()) {
      const std::string field = fmt::format("vertices[{}]", i);
      return InvalidArgument(
          field, fmt::format("{} is ({}, {}, {}); coordinates must be finite and within ±{} m",
                             field, v.x(), v.y(), v.z(), limits.max_coordinate));
    }
    low = low.cwiseMin(v);
    high = high.cwiseMax(v);
  }
  const double extent = (high - low).maxCoeff();
  if (extent > 0 && extent <= limits.max_extent) return {};
  return InvalidArgument(
      "vertices", fmt::format("vertices have an extent of {} m; it must lie in (0, {}] m", extent,
                              limits.max_extent));
}

Result<void> Check(const TriangleMesh& mesh, const MeshLimits& limits) {
  if (std::ssize(mesh.vertices) > limits.max_vertices) {
    return TooMany("vertices", mesh.vertices.size(), limits.max_vertices);
  }
  if (std::ssize(mesh.triangles) > limits.max_triangles) {
    return TooMany("triangles", mesh.triangles.size(), limits.max_triangles);
  }
  if (mesh.vertices.empty() || mesh.triangles.empty()) {
    const std::string field = mesh.vertices.empty() ? "vertices" : "triangles";
    return InvalidArgument(field, fmt::format("{} is empty; a body needs a surface", field));
  }
  for (size_t t = 0; t < mesh.triangles.size(); ++t) {
    for (const uint32_t v : mesh.triangles[t]) {
      if (v < mesh.vertices.size()) continue;
      const std::string field = fmt::format("triangles[{}]", t);
      return InvalidArgument(field, fmt::format("{} names vertex {}; the mesh has {}", field, v,
                                                mesh.vertices.size()));
    }
  }
  return CheckVertices(mesh, limits);
}

// Cells of a few welding distances, each with the vertices that were kept in it.
class WeldGrid {
 public:
  explicit WeldGrid(double reach) : reach_(reach) {}

  // Calls visit(vertices) for each cell within reach of `p`.
  template <typename Visit>
  void Near(const Vector3d& p, const Visit& visit) const {
    const Cell low = CellOf(p - Vector3d::Constant(reach_));
    const Cell high = CellOf(p + Vector3d::Constant(reach_));
    for (int64_t x = low[0]; x <= high[0]; ++x) {
      for (int64_t y = low[1]; y <= high[1]; ++y) {
        for (int64_t z = low[2]; z <= high[2]; ++z) {
          const auto found = cells_.find({x, y, z});
          if (found != cells_.end()) visit(found->second);
        }
      }
    }
  }

  void Add(const Vector3d& p, uint32_t vertex) { cells_[CellOf(p)].push_back(vertex); }

 private:
  using Cell = std::array<int64_t, 3>;
  struct Hash {
    size_t operator()(const Cell& c) const {
      return static_cast<size_t>(c[0]) * 0x9e3779b97f4a7c15 +
             static_cast<size_t>(c[1]) * 0xc2b2ae3d27d4eb4f +
             static_cast<size_t>(c[2]) * 0x165667b19e3779f9;
    }
  };

  [[nodiscard]] Cell CellOf(const Vector3d& p) const {
    Cell cell;
    for (int i = 0; i < 3; ++i) cell[i] = static_cast<int64_t>(std::floor(p[i] / (16 * reach_)));
    return cell;
  }

  const double reach_;
  std::unordered_map<Cell, std::vector<uint32_t>, Hash> cells_;
};

// Each used vertex joins the first one within the welding distance. Unused ones go.
SolidMesh Weld(const TriangleMesh& mesh, MeshReport* report) {
  constexpr uint32_t kNone = ~0U;
  const std::vector<bool> used = UsedVertices(mesh);
  std::vector<uint32_t> target(mesh.vertices.size(), kNone);
  Eigen::AlignedBox3d box;
  for (size_t i = 0; i < used.size(); ++i) {
    if (used[i]) box.extend(mesh.vertices[i].cast<double>());
  }
  const double reach = kWeldShare * box.diagonal().norm();
  WeldGrid grid(reach);
  SolidMesh solid;
  for (size_t i = 0; i < target.size(); ++i) {
    if (!used[i]) continue;
    const Vector3d p = mesh.vertices[i].cast<double>();
    uint32_t first = kNone;
    grid.Near(p, [&](const std::vector<uint32_t>& kept) {
      for (const uint32_t v : kept) {
        if ((solid.vertices[v] - p).norm() <= reach) first = std::min(first, v);
      }
    });
    if (first == kNone) {
      first = static_cast<uint32_t>(solid.vertices.size());
      solid.vertices.push_back(p);
      grid.Add(p, first);
    } else {
      ++report->welded_vertices;
    }
    target[i] = first;
  }
  solid.triangles.reserve(mesh.triangles.size());
  for (const auto& [a, b, c] : mesh.triangles) {
    solid.triangles.push_back({target[a], target[b], target[c]});
  }
  return solid;
}

Vector3d AreaVector(const SolidMesh& mesh, const Triangle& t) {
  const Vector3d& a = mesh.vertices[t[0]];
  return (mesh.vertices[t[1]] - a).cross(mesh.vertices[t[2]] - a) / 2;
}

bool IsFlat(const SolidMesh& mesh, const Triangle& t) {
  double longest = 0;
  for (int i = 0; i < 3; ++i) {
    longest =
        std::max(longest, (mesh.vertices[t[(i + 1) % 3]] - mesh.vertices[t[i]]).squaredNorm());
  }
  return !(2 * AreaVector(mesh, t).norm() > kFlatShare * longest);
}

void DropFlat(SolidMesh* mesh, MeshReport* report) {
  report->degenerate_triangles += static_cast<int>(
      std::erase_if(mesh->triangles, [&](const Triangle& t) { return IsFlat(*mesh, t); }));
}

// Of triangles on the same vertices one is left if more face one way than the other, else none.
void DropDuplicates(SolidMesh* mesh, MeshReport* report) {
  struct Group {
    int facing = 0;  // With an even permutation of the sorted vertices, less with an odd one.
    bool taken = false;
  };
  const auto sorted = [](Triangle t) {
    std::ranges::sort(t);
    return t;
  };
  const auto sign = [](const Triangle& t) {
    return ((t[0] < t[1]) + (t[1] < t[2]) + (t[2] < t[0])) == 2 ? 1 : -1;
  };
  std::map<Triangle, Group> groups;
  for (const Triangle& t : mesh->triangles) groups[sorted(t)].facing += sign(t);
  report->duplicate_triangles +=
      static_cast<int>(std::erase_if(mesh->triangles, [&](const Triangle& t) {
        Group& group = groups[sorted(t)];
        const bool keep = !group.taken && sign(t) * group.facing > 0;
        group.taken |= keep;
        return !keep;
      }));
}

// Closes each loop of the boundary by a cone; returns their area [m^2].
double CloseHoles(SolidMesh* mesh, MeshReport* report) {
  double area = 0;
  for (const std::vector<uint32_t>& loop : BoundaryLoops(mesh->triangles)) {
    Vector3d centre = Vector3d::Zero();
    for (const uint32_t v : loop) centre += mesh->vertices[v];
    centre = (centre / static_cast<double>(loop.size())).cast<float>().cast<double>();
    const auto top = static_cast<uint32_t>(mesh->vertices.size());
    mesh->vertices.push_back(centre);
    for (size_t i = 0; i < loop.size(); ++i) {
      mesh->triangles.push_back({loop[(i + 1) % loop.size()], loop[i], top});
      area += AreaVector(*mesh, mesh->triangles.back()).norm();
    }
    ++report->holes;
  }
  return area;
}

double Volume(const SolidMesh& mesh) {
  const Vector3d origin = mesh.vertices[mesh.triangles[0][0]];
  double volume = 0;
  for (const Triangle& t : mesh.triangles) {
    volume += AreaVector(mesh, t).dot(mesh.vertices[t[0]] - origin) / 3;
  }
  return volume;
}

}  // namespace

Result<SolidMesh> Repair(const TriangleMesh& mesh, const MeshLimits& limits, MeshReport* report) {
  *report = {};
  if (auto checked = Check(mesh, limits); !checked) return checked.error();
  report->vertices = static_cast<int>(mesh.vertices.size());
  report->triangles = static_cast<int>(mesh.triangles.size());
  SolidMesh solid = Weld(mesh, report);
  DropFlat(&solid, report);
  DropDuplicates(&solid, report);
  if (solid.triangles.empty()) {
    return InvalidArgument(
        "triangles",
        fmt::format("triangles bound no solid: of {}, {} have no area and {} lie "
                    "back to back with or on top of another",
                    report->triangles, report->degenerate_triangles, report->duplicate_triangles));
  }
  for (const Triangle& t : solid.triangles) report->surface_area += AreaVector(solid, t).norm();
  report->hole_area = CloseHoles(&solid, report);
  if (report->hole_area > limits.max_hole_share * report->surface_area) {
    return InvalidArgument(
        "triangles",
        fmt::format("triangles leave {} holes of {:.6g} m^2, {:.3g} of the surface's {:.6g} m^2; "
                    "the share must lie in [0, {}]: the mesh is open, or faces both ways",
                    report->holes, report->hole_area, report->hole_area / report->surface_area,
                    report->surface_area, limits.max_hole_share));
  }
  report->volume = Volume(solid);
  if (report->volume < 0) {
    report->inverted = true;
    report->volume = -report->volume;
    for (Triangle& t : solid.triangles) std::swap(t[1], t[2]);
  }
  const double least = kLeastFullness * std::pow(report->surface_area, 1.5);
  if (!(report->volume > least)) {
    return InvalidArgument("triangles",
                           fmt::format("triangles of {:.6g} m^2 enclose {:.3g} m^3; it must be "
                                       "more than {:.3g} m^3",
                                       report->surface_area, report->volume, least));
  }
  return solid;
}

}  // namespace mane::contact
