#include "kinloop/tracking/evidence/moving_keypoints.hpp"

#include <algorithm>
#include <optional>
#include <vector>

#include <opencv2/imgproc.hpp>
#include <opencv2/video/tracking.hpp>

#include "kinloop/core/quantile.hpp"
#include "kinloop/sensor/surface_mask.hpp"

namespace kinloop {
namespace {

cv::Point2f to_cv(const Eigen::Vector2f& p) {
  return {p.x(), p.y()};
}

/// A keypoint with measured depth, its raw pixel, and the raw pixel at which the earlier image shows it if it
/// is at rest.
struct ExpectedKeypoint {
  uint32_t feature;
  cv::Point2f raw, expected;
};

std::vector<ExpectedKeypoint> expect_at_rest(const TrackedFrame& tracked, const TrackedFrame& earlier,
                                             const SE3& T_earlier_tracked, const Sensor& sensor) {
  constexpr double kMargin_px = 8;
  std::vector<ExpectedKeypoint> keypoints;
  const Features& features = tracked.features();
  for (uint32_t i = 0; i < features.size(); ++i) {
    const auto depth_m = static_cast<double>(features.depths_m[i]);
    if (!(depth_m > 0)) continue;
    const Eigen::Vector3d p_camera = sensor.camera.unproject(features.pixels[i].cast<double>(), depth_m);
    const auto raw = raw_pixel_of(sensor, T_earlier_tracked * p_camera, earlier.velocity);
    if (!raw || !sensor.camera.contains(*raw, kMargin_px)) continue;
    keypoints.push_back({i, to_cv(features.raw_pixels[i]), to_cv(raw->cast<float>())});
  }
  return keypoints;
}

/// Returns how far from its expected pixel each keypoint is found in the earlier image, px; nullopt where
/// optical flow (Lucas and Kanade, in pyramids: Bouguet 2001) does not lead back to where it came from.
std::vector<std::optional<float>> displacements_px(const std::vector<ExpectedKeypoint>& keypoints,
                                                   const cv::Mat& image, const cv::Mat& earlier_image) {
  constexpr double kMaxReturn_px = 0.7;
  constexpr int kMaxLevel = 2;
  const cv::Size window(15, 15);
  const cv::TermCriteria criteria(cv::TermCriteria::COUNT + cv::TermCriteria::EPS, 20, 0.03);
  if (keypoints.empty()) return {};
  std::vector<cv::Point2f> raw, found;
  for (const ExpectedKeypoint& keypoint : keypoints) {
    raw.push_back(keypoint.raw);
    found.push_back(keypoint.expected);
  }
  std::vector<cv::Point2f> back = raw;
  std::vector<uint8_t> is_found, is_back;
  std::vector<float> residuals;
  const auto follow = [&](const cv::Mat& from, const cv::Mat& to, const std::vector<cv::Point2f>& points,
                          std::vector<cv::Point2f>& guess, std::vector<uint8_t>& status) {
    cv::calcOpticalFlowPyrLK(from, to, points, guess, status, residuals, window, kMaxLevel, criteria,
                             cv::OPTFLOW_USE_INITIAL_FLOW);
  };
  follow(image, earlier_image, raw, found, is_found);
  follow(earlier_image, image, found, back, is_back);
  std::vector<std::optional<float>> displacements(keypoints.size());
  for (size_t i = 0; i < keypoints.size(); ++i) {
    if (is_found[i] != 0 && is_back[i] != 0 && cv::norm(back[i] - raw[i]) <= kMaxReturn_px)
      displacements[i] = static_cast<float>(cv::norm(found[i] - keypoints[i].expected));
  }
  return displacements;
}

/// Counts keypoints around each point of a surface grid.
class GridCounts {
 public:
  explicit GridCounts(const SurfaceCamera& camera)
      : camera_(camera), counts_(cv::Mat::zeros(camera.grid.height, camera.grid.width, CV_32FC1)) {}

  void add(const Eigen::Vector2f& pixel) {
    const Eigen::Vector2i point = nearest_point(camera_, pixel).cast<int>();
    const bool inside =
        point.x() >= 0 && point.y() >= 0 && point.x() < counts_.cols && point.y() < counts_.rows;
    if (inside) ++counts_.at<float>(point.y(), point.x());
  }

  /// Returns the sums over 9 x 9 points.
  [[nodiscard]] cv::Mat around() const {
    cv::Mat sums;
    cv::boxFilter(counts_, sums, CV_32F, {9, 9}, {-1, -1}, false, cv::BORDER_CONSTANT);
    return sums;
  }

 private:
  const SurfaceCamera& camera_;
  cv::Mat counts_;
};

/// Returns by how much a keypoint at rest may be displaced, px, given those of landmarks: blur, a rolling
/// shutter and depth that is not registered well displace them all. nullopt if there are too few.
std::optional<float> max_displacement_at_rest_px(std::vector<float> of_landmarks) {
  // Learned on simulated rooms with seeds from 101 on and on redkitchen, where 3.8 % of the keypoints are
  // beyond; around few points these are most.
  constexpr size_t kMinLandmarks = 20;
  constexpr float kMin_px = 2, kMedians = 5;
  if (of_landmarks.size() < kMinLandmarks) return std::nullopt;
  return std::max(kMin_px, kMedians * median(std::move(of_landmarks)));
}

}  // namespace

cv::Mat moving_points(const TrackedFrame& tracked, const TrackedFrame& earlier, const SE3& T_earlier_tracked,
                      const Sensor& sensor) {
  constexpr float kMinMoving = 3;  // keypoints within 9 x 9 points
  if (!tracked.frame->surfaces || tracked.frame->gray.empty() || earlier.frame->gray.empty()) return {};
  const auto keypoints = expect_at_rest(tracked, earlier, T_earlier_tracked, sensor);
  const auto displacements = displacements_px(keypoints, tracked.frame->gray, earlier.frame->gray);
  const std::vector<LandmarkId> landmark_of = landmark_of_keypoint(tracked);
  std::vector<float> of_landmarks;
  for (size_t i = 0; i < keypoints.size(); ++i) {
    if (displacements[i] && landmark_of[keypoints[i].feature].valid())
      of_landmarks.push_back(*displacements[i]);
  }
  const auto max_at_rest_px = max_displacement_at_rest_px(std::move(of_landmarks));
  if (!max_at_rest_px) return {};

  const Features& features = tracked.features();
  GridCounts moving(*tracked.frame->surfaces->camera), at_rest(*tracked.frame->surfaces->camera);
  for (size_t i = 0; i < keypoints.size(); ++i) {
    const uint32_t feature = keypoints[i].feature;
    if (!displacements[i] || landmark_of[feature].valid()) continue;
    (*displacements[i] > *max_at_rest_px ? moving : at_rest).add(features.measured_pixels[feature]);
  }
  for (const LandmarkMatch& match : tracked.matches) at_rest.add(features.measured_pixels[match.feature]);
  const cv::Mat around = moving.around();
  cv::Mat points = (around >= kMinMoving) & (around > at_rest.around());
  return cv::countNonZero(points) == 0 ? cv::Mat() : points;
}

}  // namespace kinloop
