#include "kinloop/features/extractor.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include <opencv2/features2d.hpp>

#include "kinloop/base/errors.hpp"
#include "kinloop/features/corner_detector.hpp"

namespace kinloop {
namespace {

/// Steered BRIEF at given corners. OpenCV drops corners near the border, so `corners` comes back with those
/// left.
cv::Mat describe(const cv::Mat& gray, std::vector<cv::KeyPoint>& corners, const FeatureOptions& options) {
  const auto orb = cv::ORB::create(options.count, static_cast<float>(options.scale_factor), options.levels);
  cv::Mat descriptors;
  orb->compute(gray, corners, descriptors);
  return descriptors;
}

}  // namespace

float depth_around(const cv::Mat& depth_m, const Eigen::Vector2f& raw_pixel, double max_relative_step) {
  const int x = cvRound(raw_pixel.x()), y = cvRound(raw_pixel.y());
  if (x < 1 || y < 1 || x + 1 >= depth_m.cols || y + 1 >= depth_m.rows) return 0;
  constexpr int kMinValid = 5;
  int valid = 0;
  float sum = 0, low = std::numeric_limits<float>::max(), high = 0;
  for (int dy = -1; dy <= 1; ++dy) {
    for (int dx = -1; dx <= 1; ++dx) {
      const float z = depth_m.at<float>(y + dy, x + dx);
      if (!(z > 0)) continue;
      ++valid;
      sum += z;
      low = std::min(low, z);
      high = std::max(high, z);
    }
  }
  if (valid < kMinValid || high - low > static_cast<float>(max_relative_step) * low) return 0;
  return sum / static_cast<float>(valid);
}

Eigen::Vector2f inverse_depth_gradient(const cv::Mat& depth_m, const Eigen::Vector2f& raw_pixel,
                                       double max_relative_step) {
  constexpr int kReach = 3;  // px to either side: over less, the noise of the depth is larger than its slope
  const int x = cvRound(raw_pixel.x()), y = cvRound(raw_pixel.y());
  if (x < kReach || y < kReach || x + kReach >= depth_m.cols || y + kReach >= depth_m.rows) {
    return Eigen::Vector2f::Zero();
  }
  const auto slope = [&](float before, float after) {
    if (!(before > 0) || !(after > 0)) return 0.0F;
    const bool step = std::abs(after - before) > kReach * static_cast<float>(max_relative_step) * before;
    return step ? 0.0F : (1 / after - 1 / before) / (2 * kReach);
  };
  return {slope(depth_m.at<float>(y, x - kReach), depth_m.at<float>(y, x + kReach)),
          slope(depth_m.at<float>(y - kReach, x), depth_m.at<float>(y + kReach, x))};
}

Features extract_features(const cv::Mat& gray, const cv::Mat& depth_m, const PinholeCamera& camera,
                          const FeatureOptions& options) {
  require(gray.type() == CV_8UC1, "extract_features: the image must be 8-bit grey");
  require(depth_m.empty() || (depth_m.type() == CV_32FC1 && depth_m.size() == gray.size()),
          "extract_features: depth must be float metres, of the image's size");
  auto corners = detect_corners(build_pyramid(gray, options), options);
  Features features;
  features.scale_factor = options.scale_factor;
  features.level_count = options.levels;
  features.descriptors = describe(gray, corners, options);
  for (const auto& corner : corners) {
    const Eigen::Vector2f raw(corner.pt.x, corner.pt.y);
    features.raw_pixels.push_back(raw);
    features.pixels.push_back(camera.undistort(raw.cast<double>()).cast<float>());
    features.depths_m.push_back(depth_m.empty() ? 0 : depth_around(depth_m, raw, options.max_depth_step));
    features.inverse_depth_gradients.push_back(
        features.depths_m.back() > 0 ? inverse_depth_gradient(depth_m, raw, options.max_depth_step)
                                     : Eigen::Vector2f::Zero());
    features.levels.push_back(corner.octave);
    features.angles_rad.push_back(corner.angle * std::numbers::pi_v<float> / 180.0F);
    features.sigmas_px.push_back(static_cast<float>(std::pow(options.scale_factor, corner.octave)));
  }
  return features;
}

}  // namespace kinloop
