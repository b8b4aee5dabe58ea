#pragma once
// A cloud of coloured points: what the dense map is, whoever shows or writes it.

#include <array>
#include <cstdint>
#include <vector>

#include <Eigen/Core>

namespace kinloop {

/// Red, green, blue.
using Rgb = std::array<uint8_t, 3>;

/// Points in the world, metres, and the colour of each.
struct ColoredCloud {
  std::vector<Eigen::Vector3f> points;
  std::vector<Rgb> colors;

  [[nodiscard]] size_t size() const { return points.size(); }
};

}  // namespace kinloop
