#include "session/input/input_traits.hpp"

#include <algorithm>
#include <vector>

#include "kinloop/core/quantile.hpp"

namespace kinloop {
namespace {

/// A depth_scale of 5000 or more with depth that would be that of a room with 1000 or 5000 is more likely
/// wrong than the scene is near.
bool suggests_another_scale(double median_m, double depth_scale) {
  constexpr double kRoomNear_m = 0.6, kRoomFar_m = 4;
  const auto is_room = [&](double scale) {
    const double m = median_m * depth_scale / scale;
    return scale != depth_scale && m >= kRoomNear_m && m <= kRoomFar_m;
  };
  return is_room(1000) || is_room(5000);
}

}  // namespace

InputTraits traits_of(const FrameSource& source, const std::deque<Frame>& first_frames) {
  const RgbdCamera& camera = source.camera();
  InputTraits traits{source.info().name, source.info().live, camera.sensor, std::nullopt};
  DepthLimits usual;
  if (camera.sensor.origin != SensorOrigin::kAssumed) usual.min_depth_m = camera.sensor.min_depth_m;
  if (camera.sensor.origin != SensorOrigin::kCameraFile)
    traits.near_minimum_m = near_minimum_m(first_frames, usual, camera.depth_scale);
  return traits;
}

std::optional<double> near_minimum_m(const std::deque<Frame>& frames, const DepthLimits& limits,
                                     double depth_scale) {
  constexpr int kStep_px = 16;
  constexpr double kNear = 0.05, kMargin = 0.5, kNearest_m = 0.05, kNoCamera_m = 0.1;
  std::vector<double> depths_m;
  for (const Frame& frame : frames) {
    for (int row = 0; row < frame.depth_m.rows; row += kStep_px) {
      for (int col = 0; col < frame.depth_m.cols; col += kStep_px) {
        if (const float depth_m = frame.depth_m.at<float>(row, col); depth_m > 0) depths_m.push_back(depth_m);
      }
    }
  }
  if (depths_m.empty()) return std::nullopt;
  const double median_m = median(depths_m);
  if (median_m >= limits.min_depth_m || median_m < kNoCamera_m ||
      suggests_another_scale(median_m, depth_scale))
    return std::nullopt;
  return std::max(kNearest_m, kMargin * quantile(depths_m, kNear));
}

}  // namespace kinloop
