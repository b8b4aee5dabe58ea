// Grids of surface points. A lookup table maps the raw depth image to the grid of an ideal pinhole camera, so
// that lens distortion costs nothing per frame.

#include <algorithm>
#include <cmath>
#include <limits>

#include <Eigen/LU>
#include <opencv2/imgproc.hpp>

#include "kinloop/core/errors.hpp"
#include "kinloop/geometry/pixel_grid.hpp"
#include "kinloop/optimize/pose/icp.hpp"

namespace kinloop {
namespace {

constexpr float kMaxInverseDepthStep_per_m = 0.02F;  // between neighbouring points of one surface
constexpr int kNormalRadius = 2;                     // grid points on each side used to fit a normal
constexpr float kMinNormalPoints = 10;               // of the 25

IcpCamera::Level make_level(const PinholeCamera& camera, int block) {
  IcpCamera::Level level;
  level.camera = grid_camera(camera, block);
  const PinholeCamera& grid = level.camera;
  level.map_x.create(grid.height, grid.width, CV_32FC1);
  level.map_y.create(grid.height, grid.width, CV_32FC1);
  for (int y = 0; y < grid.height; ++y) {
    for (int x = 0; x < grid.width; ++x) {
      const Eigen::Vector2d pixel(block * (x + 0.5) - 0.5, block * (y + 0.5) - 0.5);
      const Eigen::Vector2d raw = camera.distort(pixel);
      level.map_x.at<float>(y, x) = static_cast<float>((raw.x() + 0.5) / block - 0.5);
      level.map_y.at<float>(y, x) = static_cast<float>((raw.y() + 0.5) / block - 0.5);
      level.rays.emplace_back(camera.unproject(pixel, 1.0).head<2>().cast<float>());
    }
  }
  if (!camera.has_distortion()) level.map_x = level.map_y = cv::Mat();
  return level;
}

/// Selects the block of depth pixels nearest to each point of the finest grid and corrects its ray for the
/// rounding.
void choose_blocks(const PinholeCamera& camera, IcpCamera& icp) {
  IcpCamera::Level& level = icp.levels.front();
  const double half = 0.5 * (icp.block - 1);  // from a block's first pixel to its centre
  for (Eigen::Vector2f& ray : level.rays) {
    const Eigen::Vector2d ideal(camera.fx * static_cast<double>(ray.x()) + camera.cx,
                                camera.fy * static_cast<double>(ray.y()) + camera.cy);
    const Eigen::Vector2d raw = camera.distort(ideal);
    const long left = std::lround(raw.x() - half), top = std::lround(raw.y() - half);
    const bool inside =
        left >= 0 && top >= 0 && left + icp.block <= camera.width && top + icp.block <= camera.height;
    icp.block_corner.push_back(inside ? static_cast<int32_t>(top * camera.width + left) : -1);
    if (!inside) continue;
    const Eigen::Vector2d middle(static_cast<double>(left) + half, static_cast<double>(top) + half);
    ray = camera.unproject(camera.undistort(middle), 1.0).head<2>().cast<float>();
  }
}

/// Mean inverse depth (0 = unknown) of the nearest surface. Averages inverse depths, in which a plane is
/// linear and the noise constant.
class SurfaceMean {
 public:
  explicit SurfaceMean(float nearest) : limit_(nearest - kMaxInverseDepthStep_per_m) {}
  void add(float inverse) {
    if (!(inverse > 0 && inverse >= limit_)) return;
    sum_ += inverse;
    count_ += 1;
  }
  [[nodiscard]] float value() const { return count_ > 0 ? sum_ / count_ : 0.0F; }

 private:
  float limit_, sum_ = 0, count_ = 0;
};

float block_inverse_depth(const cv::Mat& depth_m, int32_t corner, int block) {
  const int top = corner / depth_m.cols, left = corner % depth_m.cols;
  float nearest_m = std::numeric_limits<float>::infinity();
  for (int y = top; y < top + block; ++y) {
    const float* row = depth_m.ptr<float>(y);
    for (int x = left; x < left + block; ++x) {
      if (row[x] > 0 && row[x] < nearest_m) nearest_m = row[x];  // false for NaN
    }
  }
  SurfaceMean mean(1.0F / nearest_m);
  for (int y = top; y < top + block; ++y) {
    const float* row = depth_m.ptr<float>(y);
    for (int x = left; x < left + block; ++x) mean.add(row[x] > 0 ? 1.0F / row[x] : 0.0F);
  }
  return mean.value();
}

/// Returns the inverse depths of the finest grid.
std::vector<float> sample_depth(const IcpCamera& camera, const cv::Mat& depth_m) {
  std::vector<float> inverse;
  inverse.reserve(camera.block_corner.size());
  for (const int32_t corner : camera.block_corner) {
    inverse.push_back(corner < 0 ? 0.0F : block_inverse_depth(depth_m, corner, camera.block));
  }
  return inverse;
}

/// Returns the inverse depths of the next coarser grid.
std::vector<float> halve(const std::vector<float>& fine, int fine_width, int width, int height) {
  std::vector<float> coarse;
  coarse.reserve(grid_index(width, 0, height));
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const float* top = fine.data() + 2 * y * fine_width + 2 * x;
      const float* bottom = top + fine_width;
      SurfaceMean mean(std::max({top[0], top[1], bottom[0], bottom[1]}));
      for (const float inverse : {top[0], top[1], bottom[0], bottom[1]}) mean.add(inverse);
      coarse.push_back(mean.value());
    }
  }
  return coarse;
}

/// Returns the normal at a grid point. The inverse depth of a plane n.p = d is n.(x, y, 1) / d, so a linear
/// fit of inverse depth over the grid gives n without computing 3D points.
Eigen::Vector3f fit_normal(const PinholeCamera& grid, const std::vector<float>& inverse, int cx, int cy) {
  const float centre = inverse[grid_index(grid.width, cx, cy)];
  if (!(centre > 0)) return Eigen::Vector3f::Zero();
  float n = 0, sx = 0, sy = 0, sxx = 0, sxy = 0, syy = 0, sw = 0, sxw = 0, syw = 0;
  for (int dy = -kNormalRadius; dy <= kNormalRadius; ++dy) {
    const float* row = inverse.data() + (cy + dy) * grid.width + cx;
    for (int dx = -kNormalRadius; dx <= kNormalRadius; ++dx) {
      const float step = row[dx] - centre;
      if (!(row[dx] > 0) || std::abs(step) > kMaxInverseDepthStep_per_m) continue;
      const auto x = static_cast<float>(dx), y = static_cast<float>(dy);
      n += 1, sx += x, sy += y, sw += step;
      sxx += x * x, sxy += x * y, syy += y * y, sxw += x * step, syw += y * step;
    }
  }
  if (n < kMinNormalPoints) return Eigen::Vector3f::Zero();
  Eigen::Matrix3f moments;
  moments << sxx, sxy, sx, sxy, syy, sy, sx, sy, n;
  const Eigen::Vector3f fit = moments.inverse() * Eigen::Vector3f(sxw, syw, sw);
  const float a = fit.x() * static_cast<float>(grid.fx), b = fit.y() * static_cast<float>(grid.fy);
  const float x = (static_cast<float>(cx) - static_cast<float>(grid.cx)) / static_cast<float>(grid.fx);
  const float y = (static_cast<float>(cy) - static_cast<float>(grid.cy)) / static_cast<float>(grid.fy);
  const Eigen::Vector3f normal(a, b, centre + fit.z() - a * x - b * y);
  if (!normal.allFinite() || !(normal.norm() > 0)) return Eigen::Vector3f::Zero();
  return -normal.normalized();  // n.p = d > 0 points away from the camera
}

cv::Mat grid_gray(const IcpCamera::Level& level, const cv::Mat& gray) {
  cv::Mat small, grid;
  cv::resize(gray, small, {level.camera.width, level.camera.height}, 0, 0, cv::INTER_AREA);
  small.convertTo(grid, CV_32F);
  if (level.map_x.empty()) return grid;
  cv::Mat undistorted;
  cv::remap(grid, undistorted, level.map_x, level.map_y, cv::INTER_LINEAR, cv::BORDER_REPLICATE);
  return undistorted;
}

IcpFrame::Level make_frame_level(const IcpCamera::Level& camera, const std::vector<float>& inverse,
                                 const cv::Mat& gray) {
  IcpFrame::Level level;
  level.width = camera.camera.width;
  level.height = camera.camera.height;
  level.points.assign(inverse.size(), Eigen::Vector3f::Zero());
  level.normals.assign(inverse.size(), Eigen::Vector3f::Zero());
  for (size_t i = 0; i < inverse.size(); ++i) {
    if (!(inverse[i] > 0)) continue;
    level.points[i] = Eigen::Vector3f(camera.rays[i].x(), camera.rays[i].y(), 1) / inverse[i];
  }
  for (int y = kNormalRadius; y < level.height - kNormalRadius; ++y) {
    for (int x = kNormalRadius; x < level.width - kNormalRadius; ++x) {
      level.normals[grid_index(level.width, x, y)] = fit_normal(camera.camera, inverse, x, y);
    }
  }
  if (!gray.empty()) level.gray = grid_gray(camera, gray);
  return level;
}

}  // namespace

IcpCamera make_icp_camera(const Sensor& sensor, const IcpOptions& options) {
  constexpr int kMinSide = 8;  // px; smaller grids are useless
  const PinholeCamera& camera = sensor.camera;
  IcpCamera icp;
  icp.noise = sensor.noise.surface;
  icp.width = camera.width;
  icp.height = camera.height;
  icp.block =
      std::max(1, static_cast<int>(std::lround(camera.width / static_cast<double>(options.finest_width))));
  int block = icp.block;
  for (int i = 0; i < options.levels && std::min(camera.width, camera.height) / block >= kMinSide; ++i) {
    icp.levels.push_back(make_level(camera, block));
    block *= 2;
  }
  require(!icp.levels.empty(), "make_icp_camera: the image is too small");
  choose_blocks(camera, icp);
  return icp;
}

IcpFrame make_icp_frame(const IcpCamera& camera, const cv::Mat& depth_m, const cv::Mat& gray) {
  require(depth_m.type() == CV_32FC1 && depth_m.cols == camera.width && depth_m.rows == camera.height,
          "make_icp_frame: depth must be 32FC1 of the camera's size");
  require(gray.empty() || (gray.type() == CV_8UC1 && gray.size() == depth_m.size()),
          "make_icp_frame: grey must be 8UC1 of the camera's size");
  IcpFrame frame;
  std::vector<float> inverse = sample_depth(camera, depth_m);
  for (size_t i = 0; i < camera.levels.size(); ++i) {
    const PinholeCamera& grid = camera.levels[i].camera;
    if (i > 0) inverse = halve(inverse, camera.levels[i - 1].camera.width, grid.width, grid.height);
    frame.levels.push_back(make_frame_level(camera.levels[i], inverse, gray));
  }
  return frame;
}

}  // namespace kinloop
