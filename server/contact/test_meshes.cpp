#include "contact/test_meshes.h"

#include <Eigen/Geometry>

#include <array>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <map>
#include <numbers>
#include <random>
#include <sstream>
#include <string>
#include <utility>

namespace mane::contact::fixtures {

using Eigen::Vector3d;
using Eigen::Vector3f;

TriangleMesh Sphere(int levels, const std::function<Vector3d(const Vector3d&)>& place) {
  const double g = std::numbers::phi;
  std::vector<Vector3d> points = {{-1, g, 0}, {1, g, 0}, {-1, -g, 0}, {1, -g, 0},
                                  {0, -1, g}, {0, 1, g}, {0, -1, -g}, {0, 1, -g},
                                  {g, 0, -1}, {g, 0, 1}, {-g, 0, -1}, {-g, 0, 1}};
  for (Vector3d& p : points) p.normalize();
  std::vector<Triangle> triangles = {{0, 11, 5}, {0, 5, 1},  {0, 1, 7},   {0, 7, 10}, {0, 10, 11},
                                     {1, 5, 9},  {5, 11, 4}, {11, 10, 2}, {10, 7, 6}, {7, 1, 8},
                                     {3, 9, 4},  {3, 4, 2},  {3, 2, 6},   {3, 6, 8},  {3, 8, 9},
                                     {4, 9, 5},  {2, 4, 11}, {6, 2, 10},  {8, 6, 7},  {9, 8, 1}};
  for (int level = 0; level < levels; ++level) {
    std::map<std::pair<uint32_t, uint32_t>, uint32_t> middles;
    const auto middle = [&](uint32_t a, uint32_t b) {
      const auto [found, is_new] =
          middles.emplace(std::minmax(a, b), static_cast<uint32_t>(points.size()));
      if (is_new) points.push_back((points[a] + points[b]).normalized());
      return found->second;
    };
    std::vector<Triangle> finer;
    for (const auto& [a, b, c] : triangles) {
      const uint32_t ab = middle(a, b), bc = middle(b, c), ca = middle(c, a);
      finer.insert(finer.end(), {{a, ab, ca}, {ab, b, bc}, {ca, bc, c}, {ab, bc, ca}});
    }
    triangles = std::move(finer);
  }
  TriangleMesh mesh;
  for (const Vector3d& p : points) mesh.vertices.push_back(place(p).cast<float>());
  mesh.triangles = std::move(triangles);
  return mesh;
}

TriangleMesh Sphere(int levels, double radius, const Vector3d& centre) {
  return Sphere(levels, [&](const Vector3d& p) { return Vector3d(centre + radius * p); });
}

TriangleMesh Box(const Vector3d& low, const Vector3d& high, int cells) {
  TriangleMesh mesh;  // Each side has vertices of its own, so that boxes are welded.
  for (int axis = 0; axis < 3; ++axis) {
    const int u = (axis + 1) % 3, v = (axis + 2) % 3;
    for (const bool top : {false, true}) {
      const auto first = static_cast<uint32_t>(mesh.vertices.size());
      for (int j = 0; j <= cells; ++j) {
        for (int i = 0; i <= cells; ++i) {
          Vector3d p;
          p[axis] = top ? high[axis] : low[axis];
          p[u] = low[u] + (high[u] - low[u]) * i / cells;
          p[v] = low[v] + (high[v] - low[v]) * j / cells;
          mesh.vertices.push_back(p.cast<float>());
        }
      }
      const auto row = static_cast<uint32_t>(cells + 1);
      for (int square = 0; square < cells * cells; ++square) {
        const uint32_t a = first + square / cells * row + square % cells;
        Triangle s{a, a + 1, a + row + 1}, t{a, a + row + 1, a + row};
        if (!top) std::swap(s[1], s[2]), std::swap(t[1], t[2]);
        mesh.triangles.insert(mesh.triangles.end(), {s, t});
      }
    }
  }
  return mesh;
}

TriangleMesh Torus(double ring_radius, double tube_radius, int around, int across) {
  TriangleMesh mesh;
  for (int i = 0; i < around; ++i) {
    for (int j = 0; j < across; ++j) {
      const double a = 2 * std::numbers::pi * i / around, b = 2 * std::numbers::pi * j / across;
      const double r = ring_radius + tube_radius * std::cos(b);
      mesh.vertices.push_back(
          Vector3d(r * std::cos(a), tube_radius * std::sin(b), r * std::sin(a)).cast<float>());
      const auto at = [&](int p, int q) {
        return static_cast<uint32_t>((p % around) * across + q % across);
      };
      mesh.triangles.push_back({at(i, j), at(i, j + 1), at(i + 1, j + 1)});
      mesh.triangles.push_back({at(i, j), at(i + 1, j + 1), at(i + 1, j)});
    }
  }
  return mesh;
}

TriangleMesh Heap(int tetrahedra, double size) {
  std::mt19937_64 rng(7);
  std::uniform_real_distribution<double> place(-size, size);
  const auto point = [&] { return Vector3d(place(rng), place(rng), place(rng)); };
  TriangleMesh mesh;
  for (int i = 0; i < tetrahedra; ++i) {
    const Vector3d centre = point();
    Vector3d p[4];
    for (Vector3d& each : p) each = centre + point();
    if ((p[1] - p[0]).cross(p[2] - p[0]).dot(p[3] - p[0]) < 0) std::swap(p[0], p[1]);
    const auto first = static_cast<uint32_t>(mesh.vertices.size());
    for (const Vector3d& each : p) mesh.vertices.push_back(each.cast<float>());
    for (const auto& [a, b, c] : {Triangle{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {0, 3, 2}}) {
      mesh.triangles.push_back({first + a, first + b, first + c});
    }
  }
  return mesh;
}

TriangleMesh Together(const TriangleMesh& a, const TriangleMesh& b) {
  TriangleMesh both = a;
  const auto shift = static_cast<uint32_t>(a.vertices.size());
  both.vertices.insert(both.vertices.end(), b.vertices.begin(), b.vertices.end());
  for (const auto& [i, j, k] : b.triangles) {
    both.triangles.push_back({i + shift, j + shift, k + shift});
  }
  return both;
}

TriangleMesh Part(const TriangleMesh& mesh, const std::function<bool(const Vector3f&)>& keep) {
  TriangleMesh part{mesh.vertices, {}};
  for (const Triangle& t : mesh.triangles) {
    const Vector3f sum = mesh.vertices[t[0]] + mesh.vertices[t[1]] + mesh.vertices[t[2]];
    if (keep(sum / 3)) part.triangles.push_back(t);
  }
  return part;
}

TriangleMesh Inverted(TriangleMesh mesh) {
  for (Triangle& t : mesh.triangles) std::swap(t[1], t[2]);
  return mesh;
}

std::optional<TriangleMesh> RealBody() {
  const char* elsewhere = std::getenv("MANE_SHARED");
  const std::string shared = elsewhere != nullptr ? elsewhere : MANE_REPOSITORY "/../shared";
  std::ifstream file(shared + "/data/heads/makehuman_base.obj");
  if (!file) return std::nullopt;
  TriangleMesh mesh;
  std::string line, word, group;
  while (std::getline(file, line)) {
    std::istringstream words(line);
    if (!(words >> word)) continue;
    if (word == "g") words >> group;
    if (word == "v") {
      double x, y, z;  // Decimetres.
      words >> x >> y >> z;
      mesh.vertices.push_back((Vector3d(x, y, z) / 10).cast<float>());
    } else if (word == "f" && group == "body") {
      std::vector<uint32_t> corners;
      while (words >> word) corners.push_back(static_cast<uint32_t>(std::stoul(word) - 1));
      for (size_t i = 2; i < corners.size(); ++i) {
        mesh.triangles.push_back({corners[0], corners[i - 1], corners[i]});
      }
    }
  }
  return mesh;
}

}  // namespace mane::contact::fixtures
