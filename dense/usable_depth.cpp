#include "dense/usable_depth.hpp"

#include <cmath>
#include <numbers>

namespace kinloop {

void mark_usable(const cv::Mat& depth_m, int row, double focal_px, const DepthLimits& limits,
                 uint8_t* __restrict usable) {
  const float* here = depth_m.ptr<float>(row);
  const float* above = depth_m.ptr<float>(row - kDepthMarginPx);
  const float* below = depth_m.ptr<float>(row + kDepthMarginPx);
  const auto min_depth_m = static_cast<float>(limits.min_depth_m),
             max_depth_m = static_cast<float>(limits.max_depth_m);
  // On a surface inclined by angle a to the ray, depth changes by tan(a) z / f per pixel.
  const auto max_change = static_cast<float>(std::tan(limits.max_incidence_deg * std::numbers::pi / 180) *
                                             kDepthMarginPx / focal_px);
  const int end = depth_m.cols - kDepthMarginPx;
  for (int col = kDepthMarginPx; col < end; ++col) {  // without branches, so that it is vectorised
    const float z = here[col];
    const float limit_m = max_change * z;
    const auto joined = [=](float other) { return !(other > 0) | (std::abs(other - z) <= limit_m); };
    usable[col] =
        static_cast<uint8_t>((z >= min_depth_m) & (z <= max_depth_m) & joined(here[col - kDepthMarginPx]) &
                             joined(here[col + kDepthMarginPx]) & joined(above[col]) & joined(below[col]));
  }
}

cv::Mat usable_pixels(const cv::Mat& depth_m, double focal_px, const DepthLimits& limits) {
  cv::Mat usable = cv::Mat::zeros(depth_m.size(), CV_8UC1);
  for (int row = kDepthMarginPx; row < depth_m.rows - kDepthMarginPx; ++row) {
    mark_usable(depth_m, row, focal_px, limits, usable.ptr<uint8_t>(row));
  }
  return usable;
}

}  // namespace kinloop
