#include "dense/mesh/simplify_mesh.hpp"

#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <set>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "kinloop/core/errors.hpp"
#include "kinloop/core/random.hpp"

namespace kinloop {
namespace {

#define SKIP_WITHOUT_CGAL() \
  if (!mesh_simplification_available()) GTEST_SKIP() << "this build has no CGAL"

/// Number of triangles on each directed edge.
std::map<std::pair<uint32_t, uint32_t>, int> directed_edges(const ColoredMesh& mesh) {
  std::map<std::pair<uint32_t, uint32_t>, int> edges;
  for (const auto& [a, b, c] : mesh.triangles) ++edges[{a, b}], ++edges[{b, c}], ++edges[{c, a}];
  return edges;
}

/// Returns whether the triangles around the vertex, given by the edges opposite to it, form one fan.
bool is_fan(const std::map<uint32_t, uint32_t>& opposite) {
  std::set<uint32_t> ends;
  for (const auto& [from, to] : opposite) ends.insert(to);
  uint32_t first = opposite.begin()->first;
  for (const auto& [from, to] : opposite) {
    if (!ends.contains(from)) first = from;  // an open fan begins here
  }
  size_t length = 1;
  for (uint32_t at = opposite.at(first); at != first && opposite.contains(at); ++length) at = opposite.at(at);
  return length == opposite.size();
}

bool is_manifold(const ColoredMesh& mesh) {
  for (const auto& [edge, count] : directed_edges(mesh)) {
    if (count > 1 || edge.first == edge.second) return false;
  }
  std::map<uint32_t, std::map<uint32_t, uint32_t>> around;
  for (const auto& [a, b, c] : mesh.triangles) {
    around[a].emplace(b, c);
    around[b].emplace(c, a);
    around[c].emplace(a, b);
  }
  return std::all_of(around.begin(), around.end(), [](const auto& vertex) { return is_fan(vertex.second); });
}

bool is_closed(const ColoredMesh& mesh) {
  const auto edges = directed_edges(mesh);
  return std::all_of(edges.begin(), edges.end(), [&](const auto& edge) {
    return edges.contains({edge.first.second, edge.first.first});
  });
}

double area_m2(const ColoredMesh& mesh) {
  double sum = 0;
  for (const auto& [a, b, c] : mesh.triangles)
    sum += 0.5 * (mesh.points[b] - mesh.points[a]).cross(mesh.points[c] - mesh.points[a]).norm();
  return sum;
}

ColoredMesh mesh_of(std::vector<Eigen::Vector3f> points, std::vector<Triangle> triangles) {
  ColoredMesh mesh{std::move(points), {}, std::move(triangles)};
  mesh.colors.resize(mesh.points.size());
  return mesh;
}

/// A sphere around the origin, radius 1 m, from rings of quads and two caps.
ColoredMesh sphere(uint32_t rings, uint32_t sectors) {
  ColoredMesh mesh = mesh_of({{0, 0, 1}}, {});
  for (uint32_t ring = 1; ring < rings; ++ring) {
    const double polar = std::numbers::pi * ring / rings;
    for (uint32_t sector = 0; sector < sectors; ++sector) {
      const double turn = 2 * std::numbers::pi * sector / sectors;
      mesh.points.push_back(
          Eigen::Vector3d(std::sin(polar) * std::cos(turn), std::sin(polar) * std::sin(turn), std::cos(polar))
              .cast<float>());
    }
  }
  mesh.points.emplace_back(0, 0, -1);
  mesh.colors.resize(mesh.points.size());
  const auto last = static_cast<uint32_t>(mesh.points.size() - 1);
  for (uint32_t sector = 0; sector < sectors; ++sector) {
    const uint32_t next = (sector + 1) % sectors, bottom = 1 + (rings - 2) * sectors;
    mesh.triangles.push_back({0, 1 + sector, 1 + next});
    mesh.triangles.push_back({last, bottom + next, bottom + sector});
    for (uint32_t row = 1; row < bottom; row += sectors) {
      mesh.triangles.push_back({row + sector, row + sectors + sector, row + sectors + next});
      mesh.triangles.push_back({row + sector, row + sectors + next, row + next});
    }
  }
  return mesh;
}

/// A square of 1 m, of 2 * cells * cells triangles.
ColoredMesh square(uint32_t cells) {
  ColoredMesh mesh;
  const auto at = [&](uint32_t i) { return static_cast<float>(i) / static_cast<float>(cells); };
  for (uint32_t y = 0; y <= cells; ++y) {
    for (uint32_t x = 0; x <= cells; ++x) mesh.points.emplace_back(at(x), at(y), 0);
  }
  for (uint32_t y = 0; y < cells; ++y) {
    for (uint32_t x = 0; x < cells; ++x) {
      const uint32_t i = y * (cells + 1) + x, above = i + cells + 1;
      mesh.triangles.push_back({i, i + 1, above + 1});
      mesh.triangles.push_back({i, above + 1, above});
    }
  }
  mesh.colors.resize(mesh.points.size());
  return mesh;
}

/// Corners of a tetrahedron that faces outwards.
std::vector<Triangle> tetrahedron(uint32_t a, uint32_t b, uint32_t c, uint32_t d) {
  return {{a, c, b}, {a, b, d}, {b, c, d}, {c, a, d}};
}

/// Two tetrahedra with a common edge, and a third that has one vertex with the second in common.
ColoredMesh touching() {
  std::vector<Triangle> triangles = tetrahedron(0, 1, 2, 3);
  for (const Triangle& triangle : tetrahedron(0, 4, 1, 5)) triangles.push_back(triangle);
  for (const Triangle& triangle : tetrahedron(4, 6, 7, 8)) triangles.push_back(triangle);
  return mesh_of({{0, 0, 0},
                  {1, 0, 0},
                  {0, 1, 0},
                  {0, 0, 1},
                  {0, -1, 0},
                  {0, 0, -1},
                  {1, -2, 0},
                  {0, -2, 0},
                  {0, -2, 1}},
                 triangles);
}

/// The faces of unit cubes that have no other at their side.
ColoredMesh surface_of(const std::set<std::array<int, 3>>& cubes) {
  ColoredMesh mesh;
  std::map<std::array<int, 3>, uint32_t> vertices;
  const auto vertex = [&](const std::array<int, 3>& place) {
    const auto [at, is_new] = vertices.try_emplace(place, mesh.points.size());
    if (is_new) mesh.points.push_back(Eigen::Vector3i(place.data()).cast<float>());
    return at->second;
  };
  for (const std::array<int, 3>& cube : cubes) {
    for (size_t axis = 0; axis < 3; ++axis) {
      for (const int side : {0, 1}) {
        std::array<int, 3> beside = cube;
        beside[axis] += 2 * side - 1;
        if (cubes.contains(beside)) continue;
        std::array<uint32_t, 4> corners{};
        for (size_t k = 0; k < 4; ++k) {
          std::array<int, 3> place = cube;
          place[axis] += side;
          place[(axis + 1) % 3] += k == 1 || k == 2 ? 1 : 0;
          place[(axis + 2) % 3] += k >= 2 ? 1 : 0;
          corners[side == 1 ? k : 3 - k] = vertex(place);
        }
        mesh.triangles.push_back({corners[0], corners[1], corners[2]});
        mesh.triangles.push_back({corners[0], corners[2], corners[3]});
      }
    }
  }
  mesh.colors.resize(mesh.points.size());
  return mesh;
}

TEST(SimplifyMesh, AnEdgeOfFourTrianglesOfOneSurfaceLeavesNoSlit) {
  SKIP_WITHOUT_CGAL();
  // Two cubes that have an edge in common, and three above it that join them.
  const ColoredMesh cubes = surface_of({{0, 0, 0}, {1, 1, 0}, {0, 0, 1}, {1, 0, 1}, {1, 1, 1}});
  ASSERT_FALSE(is_manifold(cubes));
  const ColoredMesh closed = manifold_mesh(cubes);
  EXPECT_TRUE(is_manifold(closed));
  EXPECT_TRUE(is_closed(closed));
  EXPECT_EQ(closed.triangles.size(), cubes.triangles.size());
  const ColoredMesh few = simplified_mesh(cubes, 20);
  EXPECT_LE(few.triangles.size(), 20U);
  EXPECT_TRUE(is_closed(few));
}

TEST(SimplifyMesh, PiecesThatOnlyTouchedAreLeftOutIfTheyAreSmall) {
  SKIP_WITHOUT_CGAL();
  EXPECT_EQ(manifold_mesh(touching(), 4).triangles.size(), 12U);
  EXPECT_TRUE(manifold_mesh(touching(), 5).triangles.empty());
  ColoredMesh with_debris = sphere(10, 12);
  with_debris.points.emplace_back(0, 1, 2);
  with_debris.points.emplace_back(1, 0, 2);
  with_debris.colors.resize(with_debris.points.size());
  const auto last = static_cast<uint32_t>(with_debris.points.size() - 1);
  with_debris.triangles.push_back({0, last - 1, last});
  EXPECT_EQ(manifold_mesh(with_debris, 2).triangles.size(), sphere(10, 12).triangles.size());
}

TEST(SimplifyMesh, SurfacesThatTouchGetVerticesOfTheirOwn) {
  SKIP_WITHOUT_CGAL();
  ASSERT_FALSE(is_manifold(touching()));
  const ColoredMesh separate = manifold_mesh(touching());
  EXPECT_TRUE(is_manifold(separate));
  EXPECT_TRUE(is_closed(separate));
  EXPECT_EQ(separate.triangles.size(), touching().triangles.size());
  EXPECT_EQ(separate.points.size(), 12U);
  EXPECT_NEAR(area_m2(separate), area_m2(touching()), 1e-6);
}

TEST(SimplifyMesh, ManifoldMeshKeepsTheFreeSide) {
  SKIP_WITHOUT_CGAL();
  const ColoredMesh same = manifold_mesh(sphere(10, 12));
  const auto normals = vertex_normals(same);
  ASSERT_EQ(normals.size(), sphere(10, 12).points.size());
  for (size_t i = 0; i < normals.size(); ++i) EXPECT_GT(normals[i].dot(same.points[i]), 0.9F);
}

TEST(SimplifyMesh, DegenerateAndRepeatedTrianglesAreLeftOut) {
  SKIP_WITHOUT_CGAL();
  const ColoredMesh odd =
      mesh_of({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}}, {{0, 1, 2}, {1, 2, 0}, {1, 3, 2}, {1, 1, 3}});
  const ColoredMesh clean = manifold_mesh(odd);
  EXPECT_EQ(clean.triangles.size(), 2U);
  EXPECT_TRUE(is_manifold(clean));
}

TEST(SimplifyMesh, ASphereStaysClosedAndRoundWithATenthOfItsTriangles) {
  SKIP_WITHOUT_CGAL();
  const ColoredMesh fine = sphere(40, 64);
  ASSERT_TRUE(is_closed(fine));
  const ColoredMesh coarse = simplified_mesh(fine, fine.triangles.size() / 10);
  EXPECT_LE(coarse.triangles.size(), fine.triangles.size() / 10);
  EXPECT_GE(coarse.triangles.size(), fine.triangles.size() / 10 - 2);
  EXPECT_TRUE(is_manifold(coarse));
  EXPECT_TRUE(is_closed(coarse));
  EXPECT_EQ(coarse.colors.size(), coarse.points.size());
  for (const auto& point : coarse.points) EXPECT_NEAR(point.norm(), 1, 0.03);
  EXPECT_NEAR(area_m2(coarse), area_m2(fine), 0.03 * area_m2(fine));
}

TEST(SimplifyMesh, AFlatSquareKeepsItsBorder) {
  SKIP_WITHOUT_CGAL();
  const ColoredMesh few = simplified_mesh(square(16), 8);
  EXPECT_LE(few.triangles.size(), 8U);
  EXPECT_GE(few.triangles.size(), 2U);
  EXPECT_NEAR(area_m2(few), 1, 1e-3);
}

TEST(SimplifyMesh, TouchingSurfacesAreManifoldWhenSimplified) {
  SKIP_WITHOUT_CGAL();
  ColoredMesh two = sphere(12, 16);
  const auto count = static_cast<uint32_t>(two.points.size());
  for (const Eigen::Vector3f& p : sphere(12, 16).points) two.points.push_back(p + Eigen::Vector3f(0, 0, 2));
  two.colors.resize(two.points.size());
  for (const auto& [a, b, c] : sphere(12, 16).triangles) {
    const auto moved = [&](uint32_t i) {
      return i == count - 1 ? 0 : i + count;
    };  // its lowest is the highest of the first
    two.triangles.push_back({moved(a), moved(b), moved(c)});
  }
  ASSERT_FALSE(is_manifold(two));
  const ColoredMesh coarse = simplified_mesh(two, 200);
  EXPECT_LE(coarse.triangles.size(), 200U);
  EXPECT_GE(coarse.triangles.size(), 198U);
  EXPECT_TRUE(is_manifold(coarse));
  EXPECT_TRUE(is_closed(coarse));
}

TEST(SimplifyMesh, AsFewTrianglesAsTheTopologyAllowsAreLeft) {
  SKIP_WITHOUT_CGAL();
  const ColoredMesh fewest = simplified_mesh(sphere(8, 8), 1);
  EXPECT_EQ(fewest.triangles.size(), 4U);
  EXPECT_TRUE(is_closed(fewest));
  EXPECT_TRUE(simplified_mesh({}, 10).triangles.empty());
  EXPECT_TRUE(manifold_mesh({}).triangles.empty());
}

TEST(SimplifyMesh, ARaggedSheetIsHardlyFoldedWhereFewTrianglesCanGo) {
  SKIP_WITHOUT_CGAL();
  constexpr uint32_t kSide = 60;
  ColoredMesh sheet;
  Random random(8);
  for (uint32_t row = 0; row < kSide; ++row) {
    for (uint32_t col = 0; col < kSide; ++col) {
      sheet.points.emplace_back(col, row, 0.2 * random.gaussian());
      const uint32_t first = row * kSide + col;
      if (row + 1 == kSide || col + 1 == kSide) continue;
      if (random.index(3) > 0) sheet.triangles.push_back({first, first + 1, first + kSide});
      if (random.index(3) > 0) sheet.triangles.push_back({first + 1, first + kSide + 1, first + kSide});
    }
  }
  sheet.colors.resize(sheet.points.size());
  const ColoredMesh coarse = simplified_mesh(sheet, 10);
  EXPECT_LT(coarse.triangles.size(), sheet.triangles.size() * 3 / 4);
  EXPECT_GT(coarse.triangles.size(), sheet.triangles.size() / 10);
  EXPECT_LT(area_m2(coarse), 1.1 * area_m2(sheet));
  size_t folded = 0;
  for (const auto& [a, b, c] : coarse.triangles) {
    const Eigen::Vector3f normal =
        (coarse.points[b] - coarse.points[a]).cross(coarse.points[c] - coarse.points[a]);
    folded += normal.z() < 0 ? 1 : 0;
  }
  EXPECT_LT(folded, 30U) << "of " << coarse.triangles.size();
}

TEST(SimplifyMesh, WithoutCgalThePackageIsNamed) {
  if (mesh_simplification_available()) {
    EXPECT_NO_THROW(static_cast<void>(manifold_mesh(square(1))));
    return;
  }
  EXPECT_THROW(static_cast<void>(manifold_mesh(square(1))), UsageError);
  EXPECT_THROW(static_cast<void>(simplified_mesh(square(1), 1)), UsageError);
}

}  // namespace
}  // namespace kinloop
