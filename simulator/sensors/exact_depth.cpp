#include "simulator/sensors/exact_depth.hpp"

#include <algorithm>
#include <limits>

namespace kinloop::sim {

void cast_shadow(const float* depth_m, int width, double disparity_scale, std::vector<uint8_t>& shadow) {
  double leftmost = std::numeric_limits<double>::infinity();
  for (int x = width - 1; x >= 0; --x) {
    const double column = x - disparity_scale / static_cast<double>(depth_m[x]);
    shadow[static_cast<size_t>(x)] = column >= leftmost ? 1 : 0;
    leftmost = std::min(leftmost, column);
  }
}

double grazing_loss(float cosine) {
  constexpr double kSafeCosine = 0.31, kLostCosine = 0.12;  // 72 and 83 degrees off the normal
  return std::clamp((kSafeCosine - static_cast<double>(cosine)) / (kSafeCosine - kLostCosine), 0.0, 1.0);
}

}  // namespace kinloop::sim
