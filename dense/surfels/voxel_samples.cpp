#include "dense/surfels/voxel_samples.hpp"

#include <algorithm>
#include <cmath>

#include "kinloop/core/errors.hpp"
#include "kinloop/core/threads/parallel_for.hpp"

namespace kinloop {
namespace {

/// Bilinear interpolation of the ray.
Eigen::Vector2f ray_at(const RayTable& rays, const Surfel& point, int pixel_steps) {
  const float step = 1.0F / static_cast<float>(pixel_steps);
  const int col = std::min(point.col / pixel_steps, rays.width - 2);
  const int row = std::min(point.row / pixel_steps, rays.height - 2);
  const float right = static_cast<float>(point.col) * step - static_cast<float>(col);
  const float down = static_cast<float>(point.row) * step - static_cast<float>(row);
  const auto* above =
      &rays.rays[static_cast<size_t>(row) * static_cast<size_t>(rays.width) + static_cast<size_t>(col)];
  const auto* below = above + rays.width;
  return (1 - down) * ((1 - right) * above[0] + right * above[1]) +
         down * ((1 - right) * below[0] + right * below[1]);
}

/// Normal, towards the camera, of the plane whose inverse depth changes by `slope` (relative to itself) along
/// the ray: n p = d with p = z (x, y, 1) gives 1 / z = n (x, y, 1) / d.
Eigen::Vector3f normal_of(const Eigen::Vector2f& ray, const Eigen::Vector2f& slope) {
  return -Eigen::Vector3f(slope.x(), slope.y(), 1 - slope.dot(ray)).normalized();
}

float fourth_power(float x) {
  return x * x * x * x;
}

Rgb apply_gain(const Rgb& color, const Eigen::Vector3f& gain) {
  constexpr float kMaxCount = 255;
  const auto channel = [&](size_t i) {
    const float value = static_cast<float>(color[i]) * gain(static_cast<Eigen::Index>(i));
    return static_cast<uint8_t>(std::min(value + 0.5F, kMaxCount));
  };
  return {channel(0), channel(1), channel(2)};
}

/// Clipped intensities have lost their colour; they count only if no view is better.
float exposure_weight(const Rgb& color) {
  constexpr float kLost = 1e-3F;
  return *std::max_element(color.begin(), color.end()) < kSaturatedIntensity ? 1 : kLost;
}

}  // namespace

Eigen::Vector3i voxel_of(VoxelKey key) {
  constexpr VoxelKey kAxisMask = (VoxelKey{1} << kVoxelAxisBits) - 1;
  const auto part = [&](int axis) {
    return static_cast<int>(static_cast<int64_t>(key >> (axis * kVoxelAxisBits) & kAxisMask) - kVoxelOrigin);
  };
  return {part(0), part(1), part(2)};
}

RayTable ray_table(const PinholeCamera& camera, int threads) {
  RayTable table{.width = camera.width, .height = camera.height, .focal_px = camera.fx, .rays = {}};
  const auto width = static_cast<size_t>(camera.width), height = static_cast<size_t>(camera.height);
  table.rays.resize(width * height);
  parallel_for(height, threads, [&](size_t begin, size_t end) {
    for (size_t row = begin; row < end; ++row) {
      for (size_t col = 0; col < width; ++col) {
        const Eigen::Vector2d pixel(static_cast<double>(col), static_cast<double>(row));
        const Eigen::Vector3d ray = camera.unproject(camera.undistort(pixel), 1.0);
        table.rays[row * width + col] = ray.head<2>().cast<float>();
      }
    }
  });
  return table;
}

std::vector<VoxelSample> voxel_samples(const ImageSurfels& surfels, const PosedImage& view,
                                       const DenseCamera& camera, const RayTable& rays, double voxel_m) {
  require(rays.width == camera.color.width && rays.height == camera.color.height && rays.width > 1 &&
              rays.height > 1,
          "voxel_samples: the rays do not match the camera");
  const Eigen::Matrix3d R = view.T_world_camera.R();
  const Eigen::Matrix3f R_float = R.cast<float>();
  constexpr auto kEnd = static_cast<double>(kVoxelOrigin - 1);
  // Sharpness is edge energy, which grows with the square of the exposure.
  const float gain = view.color_gain.mean();
  const float sharpness = surfels.sharpness * gain * gain;

  std::vector<VoxelSample> samples;
  samples.reserve(surfels.points.size());
  for (const Surfel& point : surfels.points) {
    const Eigen::Vector2f ray = ray_at(rays, point, surfels.pixel_steps);
    const auto x = static_cast<double>(ray.x()), y = static_cast<double>(ray.y());
    const double inverse_depth = camera.correct_inverse_depth(static_cast<double>(point.inverse_depth), x, y);
    if (!(inverse_depth > 0)) continue;
    const double z = 1 / inverse_depth;
    const double row = static_cast<double>(point.row) / surfels.pixel_steps;
    const Eigen::Vector3d p =
        camera.deskew({x * z, y * z, z}, row, view.velocity, view.depth_stamp_difference_s);
    const Eigen::Vector3d p_voxels = (R * p + view.T_world_camera.translation) / voxel_m;
    if (!(p_voxels.cwiseAbs().maxCoeff() < kEnd)) continue;
    const Eigen::Vector3d corner = p_voxels.array().floor();
    const Eigen::Vector3f normal =
        normal_of(ray, Eigen::Vector2f(point.slope_x, point.slope_y) / kSlopeSteps);
    const float frontal = -normal.dot(ray.homogeneous().normalized());
    const double sigma_m = camera.noise.sigma_m(z);
    VoxelSample& sample = samples.emplace_back();
    sample.key = voxel_key(corner);
    sample.offset = (p_voxels - corner).cast<float>();
    sample.normal = R_float * normal;
    sample.pixels = point.pixels;
    sample.variance_m2 = static_cast<float>(sigma_m * sigma_m);
    // Pixels per square metre of surface. The fourth power makes the best few images dominate.
    sample.color_weight =
        exposure_weight(point.color) *
        fourth_power(sharpness * frontal * static_cast<float>(inverse_depth * inverse_depth));
    sample.color = apply_gain(point.color, view.color_gain);
  }
  return samples;
}

}  // namespace kinloop
