#include "kinloop/features/extractor.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include <Eigen/Cholesky>
#include <opencv2/features2d.hpp>

#include "kinloop/base/errors.hpp"
#include "kinloop/features/corner_detector.hpp"

namespace kinloop {
namespace {

const Eigen::Vector2f kUnknownSlope = Eigen::Vector2f::Constant(std::numeric_limits<float>::quiet_NaN());

/// Steered BRIEF at given corners. OpenCV drops corners near the border, so `corners` comes back with those
/// left.
cv::Mat describe(const cv::Mat& gray, std::vector<cv::KeyPoint>& corners, const FeatureOptions& options) {
  const auto orb = cv::ORB::create(options.count, static_cast<float>(options.scale_factor), options.levels);
  cv::Mat descriptors;
  orb->compute(gray, corners, descriptors);
  return descriptors;
}

/// Where a corner of a pyramid level lies on the full image. cv::ORB scales coordinates, which puts the
/// corner of the image at rest; resizing puts the corner of its first pixel at rest, half a pixel further
/// out, and level sizes are whole numbers.
Eigen::Vector2f on_full_image(const cv::KeyPoint& corner, const cv::Mat& gray,
                              const std::vector<cv::Mat>& pyramid, double scale_factor) {
  const cv::Mat& level = pyramid[static_cast<size_t>(corner.octave)];
  const auto nominal = static_cast<float>(std::pow(scale_factor, corner.octave));
  const auto scale_x = static_cast<float>(gray.cols) / static_cast<float>(level.cols);
  const auto scale_y = static_cast<float>(gray.rows) / static_cast<float>(level.rows);
  return {(corner.pt.x / nominal + 0.5F) * scale_x - 0.5F, (corner.pt.y / nominal + 0.5F) * scale_y - 0.5F};
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

std::optional<Eigen::Vector2f> inverse_depth_gradient(const cv::Mat& depth_m,
                                                      const Eigen::Vector2f& raw_pixel) {
  // The slope over a few pixels is smaller than the steps in which the sensor quantises disparity: a wide
  // window, sparsely sampled, sees through them.
  constexpr int kReach = 8, kStep = 2;
  constexpr int kMinValid = 60;           // of 81
  constexpr double kMaxRms_per_m = 4e-3;  // of a plane; three times the sensor's noise
  const int x = cvRound(raw_pixel.x()), y = cvRound(raw_pixel.y());
  if (x < kReach || y < kReach || x + kReach >= depth_m.cols || y + kReach >= depth_m.rows) {
    return std::nullopt;
  }
  // Least squares of inverse depth = a + b dx + c dy.
  int valid = 0;
  double squares = 0;
  Eigen::Matrix3d H = Eigen::Matrix3d::Zero();
  Eigen::Vector3d g = Eigen::Vector3d::Zero();
  for (int dy = -kReach; dy <= kReach; dy += kStep) {
    const float* row = depth_m.ptr<float>(y + dy) + x;
    for (int dx = -kReach; dx <= kReach; dx += kStep) {
      if (!(row[dx] > 0)) continue;
      const double inverse_depth = 1.0 / static_cast<double>(row[dx]);
      const Eigen::Vector3d basis(1, dx, dy);
      ++valid;
      squares += inverse_depth * inverse_depth;
      H += basis * basis.transpose();
      g += basis * inverse_depth;
    }
  }
  if (valid < kMinValid) return std::nullopt;
  const Eigen::Vector3d plane = H.ldlt().solve(g);
  const double rms = std::sqrt(std::max(squares - plane.dot(g), 0.0) / valid);
  // A slope across an edge would be that of no surface, and far too steep.
  if (!(rms < kMaxRms_per_m)) return std::nullopt;
  return plane.tail<2>().cast<float>();
}

Features extract_features(const cv::Mat& gray, const cv::Mat& depth_m, const PinholeCamera& camera,
                          const FeatureOptions& options) {
  require(gray.type() == CV_8UC1, "extract_features: the image must be 8-bit grey");
  require(depth_m.empty() || (depth_m.type() == CV_32FC1 && depth_m.size() == gray.size()),
          "extract_features: depth must be float metres, of the image's size");
  const auto pyramid = build_pyramid(gray, options);
  auto corners = detect_corners(pyramid, options);
  Features features;
  features.scale_factor = options.scale_factor;
  features.level_count = options.levels;
  features.descriptors = describe(gray, corners, options);
  for (const auto& corner : corners) {
    const Eigen::Vector2f raw = on_full_image(corner, gray, pyramid, options.scale_factor);
    features.raw_pixels.push_back(raw);
    features.pixels.push_back(camera.undistort(raw.cast<double>()).cast<float>());
    features.depths_m.push_back(depth_m.empty() ? 0 : depth_around(depth_m, raw, options.max_depth_step));
    const auto slope = depth_m.empty() ? std::nullopt : inverse_depth_gradient(depth_m, raw);
    features.inverse_depth_gradients.push_back(slope.value_or(kUnknownSlope));
    features.measured_pixels.push_back(features.pixels.back());
    features.measured_depths_m.push_back(features.depths_m.back());
    features.levels.push_back(corner.octave);
    features.angles_rad.push_back(corner.angle * std::numbers::pi_v<float> / 180.0F);
    features.sigmas_px.push_back(static_cast<float>(std::pow(options.scale_factor, corner.octave)));
  }
  return features;
}

}  // namespace kinloop
