#include "kinloop/tracking/evidence/camera_fixed_region.hpp"

#include <algorithm>
#include <cmath>

#include <opencv2/imgproc.hpp>

#include "kinloop/core/quantile.hpp"
#include "kinloop/features/extraction/image_octaves.hpp"
#include "kinloop/geometry/pixel_grid.hpp"
#include "kinloop/sensor/surfaces/surface_mask.hpp"

namespace kinloop {
namespace {

// A point is fixed if the others have changed this often on average since it last did. In rooms and desks
// without such a part no region reaches 12; parts of 10 to 40 % are found within 1.2 to 2.5 s of hand motion.
constexpr float kFixedAfterChanges = 14;

/// Brightness of the grid points, averaged over about the spacing of the grid.
class GraySamples {
 public:
  explicit GraySamples(const Frame& frame) {
    const int spacing_px = frame.surfaces->camera->spacing_px;
    while (octave_ + 1 < static_cast<int>(frame.octaves.size()) && 2 << octave_ <= spacing_px) ++octave_;
    image_ = frame.octaves[static_cast<size_t>(octave_)];
  }

  [[nodiscard]] float at(const cv::Point& pixel) const {
    const int x = std::min(pixel.x >> octave_, image_.cols - 1);
    const int y = std::min(pixel.y >> octave_, image_.rows - 1);
    return image_.ptr<uint8_t>(y)[x];
  }

 private:
  int octave_ = 0;
  cv::Mat image_;
};

bool is_new_depth(float inverse_depth_per_m, float before) {
  constexpr float kTolerance_per_m = 0.006F;  // four sigma of a Kinect
  return inverse_depth_per_m > 0 && before > 0 && std::abs(inverse_depth_per_m - before) > kTolerance_per_m;
}

/// Automatic exposure changes the brightness of everything a little.
bool is_new_gray(float gray, float before) {
  return std::abs(gray - before) > 10 + 0.1F * before;
}

}  // namespace

bool CameraFixedRegion::observe(const Frame& frame) {
  if (!frame.surfaces || frame.octaves.empty()) return false;
  if (frame.surfaces->camera != camera_) begin(frame);
  count_changes(update_points(frame));
  const bool grown = grow();
  mark();
  return grown;
}

void CameraFixedRegion::begin(const Frame& frame) {
  camera_ = frame.surfaces->camera;
  points_.assign(camera_->pixels.size(), {});
  const GraySamples gray(frame);
  for (size_t i = 0; i < points_.size(); ++i) {
    if (camera_->pixels[i].x >= 0) points_[i].gray = gray.at(camera_->pixels[i]);
    points_[i].since_ns = frame.stamp_ns;
  }
}

/// Returns 1 for each point that has changed, 0 for the others, 2 for those without depth.
std::vector<uint8_t> CameraFixedRegion::update_points(const Frame& frame) {
  const GraySamples gray(frame);
  std::vector<uint8_t> changed(points_.size(), 2);
  for (size_t i = 0; i < points_.size(); ++i) {
    if (camera_->pixels[i].x < 0) continue;
    Point& point = points_[i];
    const float inverse = frame.surfaces->inverse_depths_per_m[i];
    const float now = gray.at(camera_->pixels[i]);
    const bool is_new = is_new_depth(inverse, point.inverse_depth_per_m) || is_new_gray(now, point.gray);
    if (is_new || !(point.inverse_depth_per_m > 0)) point.inverse_depth_per_m = inverse;
    if (is_new) {
      point.gray = now;
      point.since_ns = frame.stamp_ns;
    }
    if (inverse > 0 || is_new) changed[i] = is_new ? 1 : 0;
  }
  return changed;
}

/// The clock of a point that does not change are the changes of the room.
void CameraFixedRegion::count_changes(const std::vector<uint8_t>& changed) {
  constexpr double kMinRoom = 0.3;  // share of the points with depth
  int known = 0, room = 0, changes = 0;
  for (size_t i = 0; i < points_.size(); ++i) {
    if (changed[i] == 2) continue;
    ++known;
    if (points_[i].unchanged >= kFixedAfterChanges) continue;
    ++room;
    changes += changed[i];
  }
  const float elapsed =
      room > kMinRoom * known ? static_cast<float>(changes) / static_cast<float>(room) : 0.0F;
  for (size_t i = 0; i < points_.size(); ++i) {
    Point& point = points_[i];
    if (changed[i] != 1) {
      point.unchanged = std::min(point.unchanged + elapsed, 2 * kFixedAfterChanges);
    } else {
      // One outlier does not take a point out of the region.
      point.unchanged = point.fixed ? std::max(point.unchanged - kFixedAfterChanges / 2, 0.0F) : 0;
      point.fixed = point.fixed && point.unchanged > 0;
    }
  }
}

/// Whether a point differs from its right or lower neighbour, which must exist, in the same region.
bool CameraFixedRegion::has_structure(const cv::Mat& labels, int x, int y) const {
  const auto differs = [&](int other_x, int other_y) {
    const Point& a = points_[grid_index(labels.cols, x, y)];
    const Point& b = points_[grid_index(labels.cols, other_x, other_y)];
    return labels.at<int>(y, x) == labels.at<int>(other_y, other_x) &&
           (is_new_gray(a.gray, b.gray) || is_new_depth(a.inverse_depth_per_m, b.inverse_depth_per_m));
  };
  return differs(x + 1, y) || differs(x, y + 1);
}

/// Adds connected points with structure: a plain wall along which the camera moves does not change either.
bool CameraFixedRegion::grow() {
  constexpr int kMinPoints = 60;
  constexpr double kMinStructure = 0.02;
  const int width = camera_->grid.width, height = camera_->grid.height;
  cv::Mat steady(height, width, CV_8UC1);
  for (size_t i = 0; i < points_.size(); ++i) {
    const Point& point = points_[i];
    steady.data[i] = point.inverse_depth_per_m > 0 && point.unchanged > kFixedAfterChanges ? 255 : 0;
  }
  steady = large_regions(steady, kMinPoints);
  if (cv::countNonZero(steady) == 0) return false;
  cv::Mat labels;
  const auto count = static_cast<size_t>(cv::connectedComponents(steady, labels, 8, CV_32S));
  std::vector<int> area(count, 0), structured(count, 0);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const auto label = static_cast<size_t>(labels.at<int>(y, x));
      ++area[label];
      if (y + 1 < height && x + 1 < width && has_structure(labels, x, y)) ++structured[label];
    }
  }
  std::vector<int64_t> since_ns;
  for (size_t i = 0; i < points_.size(); ++i) {
    const auto label = static_cast<size_t>(labels.ptr<int>()[i]);
    Point& point = points_[i];
    if (label == 0 || point.fixed || structured[label] < kMinStructure * area[label]) continue;
    point.fixed = true;
    point.unchanged = 2 * kFixedAfterChanges;
    since_ns.push_back(point.since_ns);
  }
  if (since_ns.empty()) return false;
  unchanged_since_ns_ = median(std::move(since_ns));
  return true;
}

void CameraFixedRegion::mark() {
  marked_ = cv::Mat::zeros(camera_->grid.height, camera_->grid.width, CV_8UC1);
  for (size_t i = 0; i < points_.size(); ++i) marked_.data[i] = points_[i].fixed ? 255 : 0;
  if (cv::countNonZero(marked_) == 0) marked_.release();
}

}  // namespace kinloop
