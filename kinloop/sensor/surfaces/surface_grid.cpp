#include "kinloop/sensor/surfaces/surface_grid.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "kinloop/core/errors.hpp"
#include "kinloop/geometry/pixel_grid.hpp"

namespace kinloop {
namespace {

constexpr float kMaxStep_per_m = 0.05F;  // of inverse depth between neighbouring points of one surface

/// Mean inverse depth of the nearest surface among samples around a pixel; 0 unless most of them show it.
float sample_inverse_depth(const cv::Mat& depth_m, const cv::Point& pixel, int spacing_px) {
  constexpr int kMinSamples = 4;
  const int step = std::max(spacing_px / 4, 1);
  std::array<float, 5> inverse{};
  size_t count = 0;
  for (const auto& [dx, dy] : {std::pair{0, 0}, {-step, 0}, {step, 0}, {0, -step}, {0, step}}) {
    const float z = depth_m.ptr<float>(pixel.y + dy)[pixel.x + dx];
    if (z > 0) inverse[count++] = 1 / z;  // false for NaN
  }
  const float nearest = *std::max_element(inverse.begin(), inverse.end());
  float sum = 0;
  int on_surface = 0;
  for (size_t i = 0; i < count; ++i) {
    if (inverse[i] < nearest - kMaxStep_per_m) continue;
    sum += inverse[i];
    ++on_surface;
  }
  return on_surface >= kMinSamples ? sum / static_cast<float>(on_surface) : 0;
}

/// Central differences; NaN unless both neighbours on each axis continue the surface.
Eigen::Vector2f gradient_at(const float* inverse, int width) {
  const auto continues = [&](int offset) {
    return inverse[offset] > 0 && std::abs(inverse[offset] - *inverse) <= kMaxStep_per_m;
  };
  if (!(*inverse > 0) || !continues(-1) || !continues(1) || !continues(-width) || !continues(width))
    return Eigen::Vector2f::Constant(std::numeric_limits<float>::quiet_NaN());
  return {(inverse[1] - inverse[-1]) / 2, (inverse[width] - inverse[-width]) / 2};
}

/// The surface of a view at a pixel of its grid: its inverse depth, 1/m; NaN if unknown.
float surface_at(const SurfaceGrid& view, float u, float v) {
  const PinholeCamera& grid = view.camera->grid;
  const bool in_view = u > -0.5F && v > -0.5F && u < static_cast<float>(grid.width) - 0.5F &&
                       v < static_cast<float>(grid.height) - 0.5F;
  if (!in_view) return std::numeric_limits<float>::quiet_NaN();
  const int x = static_cast<int>(std::lround(u)), y = static_cast<int>(std::lround(v));
  const size_t cell = grid_index(grid.width, x, y);
  const Eigen::Vector2f step(u - static_cast<float>(x), v - static_cast<float>(y));
  return view.inverse_depths_per_m[cell] + view.gradients[cell].dot(step);
}

/// A point of one view in the direction of a surface of another.
struct CommonPoint {
  size_t index = 0;
  float expected_per_m = 0;  ///< inverse depth of the point in the other view
  float surface_per_m = 0;   ///< that of the surface which the other view measures
};

template <typename Function>
void for_each_common_point(const SurfaceGrid& points, const SurfaceGrid& view, const SE3& T_view_points,
                           const Function& function) {
  require(points.gradients.size() == view.gradients.size(), "surface grids of two cameras");
  const SurfaceCamera& camera = *view.camera;
  const Eigen::Matrix3f R = T_view_points.R().cast<float>();
  const Eigen::Vector3f t = T_view_points.translation.cast<float>();
  const auto fx = static_cast<float>(camera.grid.fx), fy = static_cast<float>(camera.grid.fy);
  const auto cx = static_cast<float>(camera.grid.cx), cy = static_cast<float>(camera.grid.cy);
  for (size_t i = 0; i < camera.rays.size(); ++i) {
    if (!points.gradients[i].allFinite()) continue;
    const float source = points.inverse_depths_per_m[i];
    // The point in the view, divided by its depth at the source.
    const Eigen::Vector3f p = R * camera.rays[i].homogeneous() + source * t;
    if (!(p.z() > 0)) continue;
    const float surface = surface_at(view, fx * p.x() / p.z() + cx, fy * p.y() / p.z() + cy);
    if (surface > 0) function(CommonPoint{i, source / p.z(), surface});
  }
}

/// The state of a point at inverse depth `seen` before a surface, given the standard deviations of both, 1/m.
PointState state_before(double seen_per_m, double seen_sigma_per_m, double surface_per_m,
                        double surface_sigma_per_m) {
  constexpr double kSigmas = 4, kPositionSigma_m = 0.01;
  const double of_position = kPositionSigma_m * seen_per_m * seen_per_m;
  const double tolerance = kSigmas * std::hypot(seen_sigma_per_m, surface_sigma_per_m, of_position);
  const double before = seen_per_m - surface_per_m;
  return std::abs(before) <= tolerance ? PointState::kConsistent
         : before > 0                  ? PointState::kContradicted
                                       : PointState::kOccluded;
}

SurfaceAgreement count(const std::vector<PointState>& states) {
  const auto number = [&](PointState state) {
    return static_cast<int>(std::count(states.begin(), states.end(), state));
  };
  return {number(PointState::kConsistent), number(PointState::kContradicted), number(PointState::kOccluded)};
}

}  // namespace

std::shared_ptr<const SurfaceCamera> make_surface_camera(const Sensor& sensor) {
  constexpr int kMaxWidth = 64;
  const PinholeCamera& camera = sensor.camera;
  SurfaceCamera surfaces;
  surfaces.noise = sensor.noise.surface;
  surfaces.spacing_px = std::max(1, (camera.width + kMaxWidth - 1) / kMaxWidth);
  const int spacing = surfaces.spacing_px;
  surfaces.grid = grid_camera(camera, spacing);
  const PinholeCamera& grid = surfaces.grid;
  const int margin = std::max(spacing / 4, 1);
  const cv::Rect inside(margin, margin, camera.width - 2 * margin, camera.height - 2 * margin);
  for (int y = 0; y < grid.height; ++y) {
    for (int x = 0; x < grid.width; ++x) {
      const Eigen::Vector2d ideal(spacing * (x + 0.5) - 0.5, spacing * (y + 0.5) - 0.5);
      const Eigen::Vector2d raw = camera.distort(ideal);
      const cv::Point pixel(static_cast<int>(std::lround(raw.x())), static_cast<int>(std::lround(raw.y())));
      surfaces.rays.emplace_back(camera.unproject(ideal, 1.0).head<2>().cast<float>());
      surfaces.pixels.push_back(inside.contains(pixel) ? pixel : cv::Point(-1, -1));
    }
  }
  return std::make_shared<const SurfaceCamera>(std::move(surfaces));
}

SurfaceGrid make_surface_grid(std::shared_ptr<const SurfaceCamera> camera, const cv::Mat& depth_m) {
  require(depth_m.type() == CV_32FC1, "make_surface_grid: depth must be 32FC1");
  SurfaceGrid surfaces;
  surfaces.inverse_depths_per_m.reserve(camera->pixels.size());
  for (const cv::Point& pixel : camera->pixels) {
    surfaces.inverse_depths_per_m.push_back(
        pixel.x < 0 ? 0 : sample_inverse_depth(depth_m, pixel, camera->spacing_px));
  }
  const int width = camera->grid.width, height = camera->grid.height;
  surfaces.gradients.assign(camera->pixels.size(),
                            Eigen::Vector2f::Constant(std::numeric_limits<float>::quiet_NaN()));
  for (int y = 1; y + 1 < height; ++y) {
    for (int x = 1; x + 1 < width; ++x) {
      const size_t i = grid_index(width, x, y);
      surfaces.gradients[i] = gradient_at(&surfaces.inverse_depths_per_m[i], width);
    }
  }
  surfaces.camera = std::move(camera);
  return surfaces;
}

bool has_depth(const SurfaceGrid& surfaces) {
  constexpr int kMinPoints = 60;
  const auto& inverse = surfaces.inverse_depths_per_m;
  return std::count_if(inverse.begin(), inverse.end(), [](float value) { return value > 0; }) >= kMinPoints;
}

PointState state_in_view(const Eigen::Vector3d& p_view, const SurfaceGrid& view) {
  if (!(p_view.z() > 0)) return PointState::kUnknown;
  const Eigen::Vector2f pixel = view.camera->grid.project(p_view).cast<float>();
  const auto surface = static_cast<double>(surface_at(view, pixel.x(), pixel.y()));
  if (!(surface > 0)) return PointState::kUnknown;
  const DepthNoise& noise = view.camera->noise;
  const double seen = 1 / p_view.z();
  return state_before(seen, noise.inverse_sigma_per_m(seen), surface, noise.inverse_sigma_per_m(surface));
}

std::vector<PointState> states_in_view(const SurfaceGrid& points, const SurfaceGrid& view,
                                       const SE3& T_view_points) {
  const DepthNoise& noise = view.camera->noise;
  std::vector<PointState> states(view.camera->rays.size(), PointState::kUnknown);
  for_each_common_point(points, view, T_view_points, [&](const CommonPoint& point) {
    const auto source = static_cast<double>(points.inverse_depths_per_m[point.index]);
    const auto seen = static_cast<double>(point.expected_per_m);
    const auto surface = static_cast<double>(point.surface_per_m);
    const double depth_ratio = source / seen;
    // d(1/z) = dz / z^2 for the noise of the point and of the pose, plus the noise of the surface.
    const double of_source = noise.inverse_sigma_per_m(source) / (depth_ratio * depth_ratio);
    states[point.index] = state_before(seen, of_source, surface, noise.inverse_sigma_per_m(surface));
  });
  return states;
}

std::vector<float> log_depth_ratios(const SurfaceGrid& points, const SurfaceGrid& view,
                                    const SE3& T_view_points) {
  std::vector<float> ratios;
  for_each_common_point(points, view, T_view_points, [&](const CommonPoint& point) {
    ratios.push_back(std::log(point.expected_per_m / point.surface_per_m));
  });
  return ratios;
}

SurfaceAgreement& SurfaceAgreement::operator+=(const SurfaceAgreement& other) {
  consistent += other.consistent;
  contradicted += other.contradicted;
  occluded += other.occluded;
  return *this;
}

double SurfaceAgreement::contradicted_share() const {
  const int visible = consistent + contradicted;
  return visible > 0 ? static_cast<double>(contradicted) / visible : 0;
}

SurfaceAgreement compare_surfaces(const SurfaceGrid& a, const SurfaceGrid& b, const SE3& T_a_b) {
  SurfaceAgreement sum = count(states_in_view(b, a, T_a_b));
  sum += count(states_in_view(a, b, T_a_b.inverse()));
  return sum;
}

}  // namespace kinloop
