#pragma once
// A coloured point cloud, the format of the dense map.

#include <array>
#include <cstdint>
#include <vector>

#include <Eigen/Core>

namespace kinloop {

/// Red, green, blue.
using Rgb = std::array<uint8_t, 3>;

/// Points in the world frame, metres, with colours. If the surfaces are known, also unit normals towards the
/// observing cameras; otherwise `normals` is empty.
struct ColoredCloud {
  std::vector<Eigen::Vector3f> points;
  std::vector<Rgb> colors;
  std::vector<Eigen::Vector3f> normals = {};

  [[nodiscard]] size_t size() const { return points.size(); }
};

/// Returns whether a point can be drawn: its coordinates are finite, and so small that no sum of a few of
/// them overflows. Files of other programs have points that are neither.
inline bool is_drawable(const Eigen::Vector3f& point) {
  constexpr float kFarthestM = 1e9F;
  return (point.array().abs() < kFarthestM).all();  // false for NaN
}

}  // namespace kinloop
