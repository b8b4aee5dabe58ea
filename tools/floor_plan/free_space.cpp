#include <algorithm>
#include <cmath>
#include <optional>

#include <opencv2/core.hpp>

#include "dense/surfels/voxel_samples.hpp"
#include "dense/usable_depth.hpp"
#include "tools/floor_plan/rooms.hpp"

namespace kinloop {
namespace {

constexpr int kRaysPerRow = 160;
/// The end of a ray that may lie within the surface by noise: a length, and a share of the depth.
constexpr double kEnd_m = 0.06, kEndShare = 0.03;

using Segment = std::pair<Eigen::Vector3d, Eigen::Vector3d>;

/// Returns the part of a ray between two heights.
std::optional<Segment> clipped(const Segment& ray, const HeightRange& range) {
  const double z0 = ray.first.z(), rise = ray.second.z() - z0;
  double begin = 0, end = 1;
  if (std::abs(rise) < 1e-9) {
    if (!range.contains(z0)) return std::nullopt;
  } else {
    const double a = (range.low_m - z0) / rise, b = (range.high_m - z0) / rise;
    begin = std::max(begin, std::min(a, b));
    end = std::min(end, std::max(a, b));
  }
  if (begin >= end) return std::nullopt;
  const Eigen::Vector3d way = ray.second - ray.first;
  return Segment{ray.first + begin * way, ray.first + end * way};
}

void mark(cv::Mat& marks, const PlanGrid& grid, const Segment& segment) {
  const Eigen::Vector2d from = segment.first.head<2>(), way = segment.second.head<2>() - from;
  const int steps = static_cast<int>(std::ceil(way.norm() / grid.cell_m)) + 1;
  for (int i = 0; i <= steps; ++i) {
    const cv::Point cell = grid.cell(from + way * (static_cast<double>(i) / steps));
    if (grid.contains(cell)) marks.at<uint8_t>(cell) = 1;
  }
}

/// Returns the rays of a view up to shortly before the surfaces.
std::vector<Segment> rays_of(const PlanViews& input, const PosedImage& view, const RayTable& table) {
  const cv::Mat depth_m = input.images.load(view.image).depth_m;
  const cv::Mat usable = usable_pixels(depth_m, table.focal_px, input.limits);
  const SE3 T_plan_camera = input.T_plan_world * view.T_world_camera;
  const int stride = std::max(1, depth_m.cols / kRaysPerRow);
  std::vector<Segment> rays;
  for (int row = 0; row < depth_m.rows; row += stride) {
    for (int col = 0; col < depth_m.cols; col += stride) {
      if (usable.at<uint8_t>(row, col) == 0) continue;
      const double z = depth_m.at<float>(row, col) * (1 - kEndShare) - kEnd_m;
      if (z <= 0) continue;
      const Eigen::Vector2f& ray =
          table.rays[static_cast<size_t>(row) * static_cast<size_t>(table.width) + static_cast<size_t>(col)];
      rays.emplace_back(T_plan_camera.translation,
                        T_plan_camera * Eigen::Vector3d(ray.x() * z, ray.y() * z, z));
    }
  }
  return rays;
}

}  // namespace

cv::Point PlanGrid::cell(const Eigen::Vector2d& p_m) const {
  const Eigen::Vector2d p = (p_m - origin_m) / cell_m;
  return {static_cast<int>(std::floor(p.x())), static_cast<int>(std::floor(p.y()))};
}

Eigen::Vector2d PlanGrid::middle_m(const cv::Point& cell) const {
  return origin_m + cell_m * Eigen::Vector2d(cell.x + 0.5, cell.y + 0.5);
}

std::vector<cv::Mat> observed_free_space(const PlanViews& input, const PlanGrid& grid,
                                         std::span<const HeightRange> ranges, const Progress& progress) {
  const RayTable table = ray_table(input.camera);
  std::vector<cv::Mat> counts;
  for (size_t i = 0; i < ranges.size(); ++i) counts.push_back(cv::Mat::zeros(grid.size, CV_8UC1));
  for (size_t i = 0; i < input.views.size(); ++i) {
    if (!report(progress, "free space", i, input.views.size())) break;
    const auto rays = rays_of(input, input.views[i], table);
    for (size_t r = 0; r < ranges.size(); ++r) {
      cv::Mat marks = cv::Mat::zeros(grid.size, CV_8UC1);
      for (const Segment& ray : rays) {
        if (const auto part = clipped(ray, ranges[r])) mark(marks, grid, *part);
      }
      counts[r] += marks;  // saturates
    }
  }
  report(progress, "free space", input.views.size(), input.views.size());
  const int least = input.views.size() > 1 ? 2 : 1;
  for (cv::Mat& count : counts) count = count >= least;
  return counts;
}

}  // namespace kinloop
