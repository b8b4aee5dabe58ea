#include "kinloop/tracking/evidence/moved_points.hpp"

#include <algorithm>
#include <cmath>
#include <deque>

#include <opencv2/imgproc.hpp>

#include "kinloop/geometry/pixel_grid.hpp"
#include "kinloop/sensor/surfaces/surface_mask.hpp"

namespace kinloop {
namespace {

/// Extends the regions over the points that are not `at_rest`, as far as their surface goes on.
void extend(cv::Mat& moved, const cv::Mat& at_rest, const SurfaceGrid& surfaces) {
  constexpr float kMaxStep_per_m = 0.03F;
  std::deque<cv::Point> open;
  for (int y = 0; y < moved.rows; ++y) {
    for (int x = 0; x < moved.cols; ++x) {
      if (moved.at<uint8_t>(y, x) != 0) open.emplace_back(x, y);
    }
  }
  const auto inverse = [&](const cv::Point& p) {
    return surfaces.inverse_depths_per_m[grid_index(moved.cols, p.x, p.y)];
  };
  const cv::Rect grid({0, 0}, moved.size());
  while (!open.empty()) {
    const cv::Point p = open.front();
    open.pop_front();
    for (const cv::Point& step : {cv::Point(1, 0), cv::Point(-1, 0), cv::Point(0, 1), cv::Point(0, -1)}) {
      const cv::Point q = p + step;
      if (!grid.contains(q) || moved.at<uint8_t>(q) != 0) continue;
      if (at_rest.at<uint8_t>(q) != 0) continue;
      if (!(inverse(q) > 0) || std::abs(inverse(q) - inverse(p)) > kMaxStep_per_m) continue;
      moved.at<uint8_t>(q) = 255;
      open.push_back(q);
    }
  }
}

constexpr int kMinRegion = 40;  // points, 1.3 % of the image

cv::Mat no_points(const SurfaceGrid& surfaces) {
  return cv::Mat::zeros(surfaces.camera->grid.height, surfaces.camera->grid.width, CV_8UC1);
}

/// The points of a view on surfaces that have left: the frame sees through a part of them. Something that
/// moves along its own surface, as a block or a back does, is mostly found where it was. Empty if there are
/// none.
cv::Mat departed_points(const SurfaceView& view, const SurfaceGrid& frame) {
  // More is a wall before which the pose or the depth is wrong.
  constexpr int kMaxGrowth = 8;
  constexpr double kMaxShare = 0.5;
  const auto states = states_in_view(*view.surfaces, frame, view.T_view_frame.inverse());
  cv::Mat gone = no_points(*view.surfaces);
  for (size_t i = 0; i < states.size(); ++i) {
    if (states[i] == PointState::kContradicted) gone.data[i] = 255;
  }
  gone = large_regions(gone, kMinRegion);
  const int count = cv::countNonZero(gone);
  if (count == 0) return {};
  cv::Mat departed = gone.clone();
  extend(departed, no_points(*view.surfaces), *view.surfaces);
  const bool is_wall = cv::countNonZero(departed) > kMaxGrowth * count || marked_share(departed) > kMaxShare;
  return is_wall ? cv::Mat() : departed;
}

/// How many views contradict each point, and how many find it where it is.
struct Votes {
  cv::Mat against, supporting;  // 8UC1
};

void add_votes(const SurfaceGrid& surfaces, const SurfaceView& view, Votes& votes) {
  const auto states = states_in_view(surfaces, *view.surfaces, view.T_view_frame);
  auto states_at_rest = states;  // in what has not left
  if (const cv::Mat departed = departed_points(view, surfaces); !departed.empty())
    states_at_rest = states_in_view(surfaces, without_points(*view.surfaces, departed), view.T_view_frame);
  for (size_t i = 0; i < states.size(); ++i) {
    const bool consistent = states[i] == PointState::kConsistent;
    const bool at_rest = states_at_rest[i] == PointState::kConsistent;
    if (states[i] == PointState::kContradicted || (consistent && !at_rest)) ++votes.against.data[i];
    if (consistent && at_rest) ++votes.supporting.data[i];
  }
}

}  // namespace

cv::Mat moved_points(const SurfaceGrid& surfaces, std::span<const SurfaceView> views) {
  const int min_against = views.size() > 1 ? 2 : 1;  // one of many may be wrong
  Votes votes{no_points(surfaces), no_points(surfaces)};
  for (const SurfaceView& view : views) add_votes(surfaces, view, votes);
  cv::Mat moved = large_regions((votes.against >= min_against) & (votes.supporting == 0), kMinRegion);
  if (cv::countNonZero(moved) == 0) return {};
  extend(moved, votes.supporting > votes.against, surfaces);
  cv::dilate(moved, moved, cv::Mat::ones(3, 3, CV_8UC1));
  return moved;
}

cv::Mat moved_points(const LocalMap& local_map, const Frame& frame, const SE3& T_reference_camera) {
  constexpr size_t kMaxViews = 12;
  if (!frame.surfaces || !local_map.surfaces) return {};
  std::vector<SurfaceView> views = {{local_map.surfaces.get(), T_reference_camera}};
  for (const LocalView& view : local_map.views) {
    if (view.surfaces && view.keyframe != local_map.reference && views.size() < kMaxViews)
      views.push_back({view.surfaces.get(), view.T_keyframe_reference * T_reference_camera});
  }
  return moved_points(*frame.surfaces, views);
}

}  // namespace kinloop
