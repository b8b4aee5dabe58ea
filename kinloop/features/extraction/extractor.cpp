#include "kinloop/features/extraction/extractor.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <span>

#include <Eigen/Cholesky>

#include "kinloop/core/errors.hpp"
#include "kinloop/features/extraction/corner_detector.hpp"
#include "kinloop/features/hamming.hpp"
#include "kinloop/features/kernels/gaussian_blur.hpp"
#include "kinloop/features/kernels/steered_brief.hpp"

namespace kinloop {
namespace {

const Eigen::Vector2f kUnknownSlope = Eigen::Vector2f::Constant(std::numeric_limits<float>::quiet_NaN());

/// Returns one row of descriptors per corner.
cv::Mat describe(const std::vector<cv::Mat>& pyramid, std::span<const Corner> corners) {
  std::vector<cv::Mat> blurred;
  for (const cv::Mat& level : pyramid) blurred.push_back(gaussian_blur(level));
  cv::Mat descriptors(static_cast<int>(corners.size()), kOrbBytes, CV_8UC1);
  for (int i = 0; i < descriptors.rows; ++i) {
    const Corner& corner = corners[static_cast<size_t>(i)];
    describe_corner(blurred[static_cast<size_t>(corner.level)], corner.x, corner.y, corner.angle_deg,
                    descriptors.ptr<uint8_t>(i));
  }
  return descriptors;
}

/// Maps a corner on a pyramid level to the full image. Resizing keeps the outer corner of the first pixel
/// fixed, which is half a pixel from its centre, and level sizes are rounded to whole pixels.
Eigen::Vector2f to_full_resolution(const Corner& corner, const std::vector<cv::Mat>& pyramid) {
  const cv::Mat& full = pyramid.front();
  const cv::Mat& level = pyramid[static_cast<size_t>(corner.level)];
  const auto scale_x = static_cast<float>(full.cols) / static_cast<float>(level.cols);
  const auto scale_y = static_cast<float>(full.rows) / static_cast<float>(level.rows);
  return {(static_cast<float>(corner.x) + corner.dx + 0.5F) * scale_x - 0.5F,
          (static_cast<float>(corner.y) + corner.dy + 0.5F) * scale_y - 0.5F};
}

/// kinloop's ORB.
DetectedKeypoints detect_orb_keypoints(const cv::Mat& gray, const FeatureOptions& options) {
  const auto pyramid = build_pyramid(gray, options);
  const auto corners = detect_corners(pyramid, options);
  DetectedKeypoints image;
  image.level_count = options.levels;
  image.descriptors = describe(pyramid, corners);
  for (const Corner& corner : corners) {
    image.points.push_back({to_full_resolution(corner, pyramid), corner.level, corner.angle_deg});
  }
  return image;
}

DetectedKeypoints without_masked(const DetectedKeypoints& all, const cv::Mat& mask) {
  DetectedKeypoints kept{.level_count = all.level_count, .points = {}, .descriptors = {}};
  for (size_t i = 0; i < all.points.size(); ++i) {
    if (!is_used(mask, all.points[i].raw_pixel)) continue;
    kept.points.push_back(all.points[i]);
    kept.descriptors.push_back(all.descriptors.row(static_cast<int>(i)));
  }
  return kept;
}

}  // namespace

float average_depth(const cv::Mat& depth_m, const Eigen::Vector2f& raw_pixel, double max_relative_step) {
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
  if (valid < kMinValid || !(high - low <= static_cast<float>(max_relative_step) * low)) return 0;
  return sum / static_cast<float>(valid);
}

std::optional<Eigen::Vector2f> inverse_depth_gradient(const cv::Mat& depth_m,
                                                      const Eigen::Vector2f& raw_pixel,
                                                      const Sensor& sensor) {
  // The depth slope over a few pixels is smaller than the sensor's disparity quantisation; a wide, sparsely
  // sampled window averages it out.
  constexpr int kReach = 8, kStep = 2;
  constexpr int kMinValid = 60;           // of 81
  constexpr double kMaxRms_per_m = 4e-3;  // deviation from a plane: three times the noise of a Kinect 1
  const int x = cvRound(raw_pixel.x()), y = cvRound(raw_pixel.y());
  if (x < kReach || y < kReach || x + kReach >= depth_m.cols || y + kReach >= depth_m.rows) {
    return std::nullopt;
  }
  // Least squares fit of inverse depth = a + b dx + c dy. The sums over pixel offsets are integers.
  int valid = 0, x1 = 0, y1 = 0, xx = 0, xy = 0, yy = 0;
  double squares = 0, g0 = 0, gx = 0, gy = 0;
  for (int dy = -kReach; dy <= kReach; dy += kStep) {
    const float* row = depth_m.ptr<float>(y + dy) + x;
    for (int dx = -kReach; dx <= kReach; dx += kStep) {
      if (!(row[dx] > 0)) continue;
      const double inverse_depth = 1.0 / static_cast<double>(row[dx]);
      ++valid;
      x1 += dx;
      y1 += dy;
      xx += dx * dx;
      xy += dx * dy;
      yy += dy * dy;
      squares += inverse_depth * inverse_depth;
      g0 += inverse_depth;
      gx += dx * inverse_depth;
      gy += dy * inverse_depth;
    }
  }
  if (valid < kMinValid) return std::nullopt;
  Eigen::Matrix3d H;
  H << valid, x1, y1, x1, xx, xy, y1, xy, yy;
  const Eigen::Vector3d g(g0, gx, gy);
  const Eigen::Vector3d plane = H.ldlt().solve(g);
  const double rms = std::sqrt(std::max(squares - plane.dot(g), 0.0) / valid);
  // Across an edge the slope would belong to no surface and be far too steep.
  const double sigma_per_m = sensor.noise.plane.inverse_sigma_per_m(g0 / valid);
  if (!(rms < kMaxRms_per_m * std::max(1.0, sigma_per_m / kSensorInverseDepthSigmaPerM))) return std::nullopt;
  return plane.tail<2>().cast<float>();
}

KeypointSample sample_keypoint(const cv::Mat& depth_m, const Eigen::Vector2d& raw_pixel, float raw_sigma_px,
                               const Sensor& sensor, const FeatureOptions& options) {
  const PinholeCamera& camera = sensor.camera;
  const Eigen::Vector2f raw = raw_pixel.cast<float>();
  const Eigen::Vector2d pixel = camera.undistort(raw_pixel);
  KeypointSample sample{pixel.cast<float>(), raw_sigma_px, 0, kUnknownSlope};
  if (!depth_m.empty()) {
    sample.depth_m = average_depth(depth_m, raw, options.max_depth_step);
    sample.inverse_depth_gradient = inverse_depth_gradient(depth_m, raw, sensor).value_or(kUnknownSlope);
  }
  if (!camera.has_distortion()) return sample;
  constexpr double kLeastArea = 1e-6;  // of raw per undistorted pixel, at the limit of the field of view
  const Eigen::Matrix2d J = camera.distort_jacobian(pixel);
  sample.sigma_px /= static_cast<float>(std::sqrt(std::max(std::abs(J.determinant()), kLeastArea)));
  // The chain rule. Inverse depth is linear in undistorted pixels on a plane, not in raw ones.
  sample.inverse_depth_gradient = J.cast<float>().transpose() * sample.inverse_depth_gradient;
  return sample;
}

bool is_used(const cv::Mat& mask, const Eigen::Vector2f& raw_pixel) {
  if (mask.empty()) return true;
  const int x = std::clamp(cvRound(raw_pixel.x()), 0, mask.cols - 1);
  const int y = std::clamp(cvRound(raw_pixel.y()), 0, mask.rows - 1);
  return mask.ptr<uint8_t>(y)[x] != 0;
}

Features extract_features(const cv::Mat& gray, const cv::Mat& depth_m, const Sensor& sensor,
                          const FeatureOptions& options, const cv::Mat& mask) {
  require(gray.type() == CV_8UC1, "extract_features: the image must be 8-bit grey");
  require(depth_m.empty() || (depth_m.type() == CV_32FC1 && depth_m.size() == gray.size()),
          "extract_features: depth must be float metres and of the image's size");
  require(mask.empty() || (mask.type() == CV_8UC1 && mask.size() == gray.size()),
          "extract_features: the mask must be 8-bit and of the image's size");
  DetectedKeypoints image = options.kind == FeatureKind::kOrb ? detect_orb_keypoints(gray, options)
                                                              : detect_float_keypoints(gray, options);
  if (!mask.empty()) image = without_masked(image, mask);
  Features features;
  features.scale_factor = options.scale_factor;
  features.level_count = image.level_count;
  features.descriptors = image.descriptors;
  for (const DetectedKeypoint& point : image.points) {
    const Eigen::Vector2f& raw = point.raw_pixel;
    features.raw_pixels.push_back(raw);
    const KeypointSample sample =
        sample_keypoint(depth_m, raw.cast<double>(),
                        static_cast<float>(std::pow(options.scale_factor, point.level)), sensor, options);
    features.pixels.push_back(sample.pixel);
    features.depths_m.push_back(sample.depth_m);
    features.inverse_depth_gradients.push_back(sample.inverse_depth_gradient);
    features.measured_pixels.push_back(features.pixels.back());
    features.measured_depths_m.push_back(features.depths_m.back());
    features.levels.push_back(point.level);
    features.angles_rad.push_back(point.angle_deg * std::numbers::pi_v<float> / 180.0F);
    features.sigmas_px.push_back(sample.sigma_px);
  }
  return features;
}

}  // namespace kinloop
