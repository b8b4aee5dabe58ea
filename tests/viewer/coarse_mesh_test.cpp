// The mesh that stands in for one of too many triangles.

#include <gmock/gmock.h>

#include "viewer/saved/sent_shapes.hpp"

namespace kinloop {
namespace {

constexpr float kSlope = 0.5F;
constexpr int kEdge = 100;  // vertices

/// A square of 1 m, sloping along x, of 2 * 99 * 99 triangles; red grows with x.
ColoredMesh slope() {
  ColoredMesh mesh;
  for (int row = 0; row < kEdge; ++row) {
    for (int column = 0; column < kEdge; ++column) {
      const float x = static_cast<float>(column) / (kEdge - 1), y = static_cast<float>(row) / (kEdge - 1);
      mesh.points.emplace_back(x, y, kSlope * x);
      mesh.colors.push_back({static_cast<uint8_t>(200 * x), 50, 50});
      if (row + 1 == kEdge || column + 1 == kEdge) continue;
      const auto corner = static_cast<uint32_t>(row * kEdge + column);
      mesh.triangles.push_back({corner, corner + 1, corner + kEdge});
      mesh.triangles.push_back({corner + 1, corner + kEdge + 1, corner + kEdge});
    }
  }
  return mesh;
}

double area_m2(const ColoredMesh& mesh) {
  double area = 0;
  for (const auto& [a, b, c] : mesh.triangles)
    area += 0.5 * (mesh.points[b] - mesh.points[a]).cross(mesh.points[c] - mesh.points[a]).norm();
  return area;
}

TEST(CoarseMesh, HasAboutAsManyTrianglesAsItMay) {
  for (const size_t most : {100, 1000, 5000}) {
    const size_t count = coarse_mesh(slope(), most).triangles.size();
    EXPECT_LE(count, most);
    EXPECT_GE(count, most / 4);
  }
}

TEST(CoarseMesh, IsTheSameSurface) {
  const ColoredMesh coarse = coarse_mesh(slope(), 1000);
  EXPECT_EQ(coarse.points.size(), coarse.colors.size());
  for (size_t i = 0; i < coarse.points.size(); ++i) {
    EXPECT_NEAR(coarse.points[i].z(), kSlope * coarse.points[i].x(), 1e-5);
    EXPECT_NEAR(coarse.colors[i][0], 200 * coarse.points[i].x(), 2);
  }
  EXPECT_NEAR(area_m2(coarse), area_m2(slope()), 0.15 * area_m2(slope())) << "less its border";
}

TEST(CoarseMesh, OfFewTrianglesIsTheMeshItself) {
  EXPECT_EQ(coarse_mesh(slope(), 1'000'000).triangles, slope().triangles);
  EXPECT_TRUE(coarse_mesh({}, 10).triangles.empty());
}

TEST(CoarseMesh, MayBeWithoutColours) {
  ColoredMesh mesh = slope();
  mesh.colors.clear();
  const ColoredMesh coarse = coarse_mesh(mesh, 1000);
  EXPECT_TRUE(coarse.colors.empty());
  EXPECT_FALSE(coarse.triangles.empty());
}

}  // namespace
}  // namespace kinloop
