#include <algorithm>
#include <optional>
#include <vector>

#include <opencv2/imgproc.hpp>
#include <opencv2/video/tracking.hpp>

#include "kinloop/core/quantile.hpp"
#include "kinloop/sensor/surfaces/surface_mask.hpp"
#include "kinloop/tracking/evidence/moved_points.hpp"

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

/// Optical flow between two images (Lucas and Kanade, in pyramids: Bouguet 2001).
class OpticalFlow {
 public:
  OpticalFlow(const cv::Mat& image, const cv::Mat& earlier_image) {
    cv::buildOpticalFlowPyramid(image, pyramid_, kWindow, kMaxLevel);
    cv::buildOpticalFlowPyramid(earlier_image, earlier_pyramid_, kWindow, kMaxLevel);
  }

  /// Returns how far from its expected pixel each keypoint is found in the earlier image, px; nullopt where
  /// the flow does not lead back to where it came from.
  [[nodiscard]] std::vector<std::optional<float>> displacements_px(
      const std::vector<ExpectedKeypoint>& keypoints) const {
    constexpr double kMaxReturn_px = 0.7;
    std::vector<cv::Point2f> raw, found;
    for (const ExpectedKeypoint& keypoint : keypoints) {
      raw.push_back(keypoint.raw);
      found.push_back(keypoint.expected);
    }
    std::vector<cv::Point2f> back = raw;
    const std::vector<uint8_t> is_found = follow(pyramid_, earlier_pyramid_, raw, found);
    const std::vector<uint8_t> is_back = follow(earlier_pyramid_, pyramid_, found, back);
    std::vector<std::optional<float>> displacements(keypoints.size());
    for (size_t i = 0; i < keypoints.size(); ++i) {
      if (is_found[i] != 0 && is_back[i] != 0 && cv::norm(back[i] - raw[i]) <= kMaxReturn_px)
        displacements[i] = static_cast<float>(cv::norm(found[i] - keypoints[i].expected));
    }
    return displacements;
  }

 private:
  using Pyramid = std::vector<cv::Mat>;
  static constexpr int kMaxLevel = 2;
  inline static const cv::Size kWindow{15, 15};

  static std::vector<uint8_t> follow(const Pyramid& from, const Pyramid& to,
                                     const std::vector<cv::Point2f>& points,
                                     std::vector<cv::Point2f>& guess) {
    const cv::TermCriteria criteria(cv::TermCriteria::COUNT + cv::TermCriteria::EPS, 20, 0.03);
    std::vector<uint8_t> is_found;
    if (points.empty()) return is_found;
    cv::calcOpticalFlowPyrLK(from, to, points, guess, is_found, cv::noArray(), kWindow, kMaxLevel, criteria,
                             cv::OPTFLOW_USE_INITIAL_FLOW);
    return is_found;
  }

  Pyramid pyramid_, earlier_pyramid_;
};

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

/// Returns by how much a keypoint at rest may be displaced, px, given some of the landmarks: blur, a rolling
/// shutter and depth that is not registered well displace them all. nullopt if there are too few.
std::optional<float> max_displacement_at_rest_px(const std::vector<ExpectedKeypoint>& landmarks,
                                                 const OpticalFlow& flow) {
  // Learned on simulated rooms with seeds from 101 on and on redkitchen, where 3.8 % of the keypoints are
  // beyond; around few points these are most.
  constexpr size_t kMinLandmarks = 20, kMaxLandmarks = 100;
  constexpr float kMin_px = 2, kMedians = 5;
  const size_t step = 1 + landmarks.size() / kMaxLandmarks;
  std::vector<ExpectedKeypoint> sample;
  for (size_t i = 0; i < landmarks.size(); i += step) sample.push_back(landmarks[i]);
  std::vector<float> displacements;
  for (const auto displacement : flow.displacements_px(sample)) {
    if (displacement) displacements.push_back(*displacement);
  }
  if (displacements.size() < kMinLandmarks) return std::nullopt;
  return std::max(kMin_px, kMedians * median(std::move(displacements)));
}

}  // namespace

cv::Mat moving_points(const TrackedFrame& tracked, const TrackedFrame& earlier, const SE3& T_earlier_tracked,
                      const Sensor& sensor) {
  constexpr float kMinMoving = 3;  // keypoints within 9 x 9 points
  if (!tracked.frame->surfaces || tracked.frame->gray.empty() || earlier.frame->gray.empty()) return {};
  const std::vector<LandmarkId> landmark_of = landmark_of_keypoint(tracked);
  std::vector<ExpectedKeypoint> landmarks, others;
  for (const ExpectedKeypoint& keypoint : expect_at_rest(tracked, earlier, T_earlier_tracked, sensor))
    (landmark_of[keypoint.feature].valid() ? landmarks : others).push_back(keypoint);
  const OpticalFlow flow(tracked.frame->gray, earlier.frame->gray);
  const auto max_at_rest_px = max_displacement_at_rest_px(landmarks, flow);
  if (!max_at_rest_px) return {};

  const Features& features = tracked.features();
  GridCounts moving(*tracked.frame->surfaces->camera), at_rest(*tracked.frame->surfaces->camera);
  const auto displacements = flow.displacements_px(others);
  for (size_t i = 0; i < others.size(); ++i) {
    if (!displacements[i]) continue;
    (*displacements[i] > *max_at_rest_px ? moving : at_rest).add(features.measured_pixels[others[i].feature]);
  }
  for (const LandmarkMatch& match : tracked.matches) at_rest.add(features.measured_pixels[match.feature]);
  const cv::Mat around = moving.around();
  cv::Mat points = (around >= kMinMoving) & (around > at_rest.around());
  return cv::countNonZero(points) == 0 ? cv::Mat() : points;
}

}  // namespace kinloop
