#pragma once
// A cloud of coloured points: what the dense map is, whoever shows or writes it.

#include <array>
#include <cstdint>
#include <vector>

#include <Eigen/Core>

namespace kinloop {

/// Red, green, blue.
using Rgb = std::array<uint8_t, 3>;

/// Points in the world, metres, and the colour of each. Where the surfaces are known, unit normals too,
/// towards the cameras that saw them; else there are none.
struct ColoredCloud {
  std::vector<Eigen::Vector3f> points;
  std::vector<Rgb> colors;
  std::vector<Eigen::Vector3f> normals = {};

  [[nodiscard]] size_t size() const { return points.size(); }
};

}  // namespace kinloop
