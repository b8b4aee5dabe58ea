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

}  // namespace kinloop
