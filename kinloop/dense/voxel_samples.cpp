#include "kinloop/dense/voxel_samples.hpp"

#include "kinloop/base/errors.hpp"
#include "kinloop/dense/usable_depth.hpp"

namespace kinloop {
namespace {

constexpr int kStepBits = 8;
static_assert(kVoxelSteps == 1 << kStepBits);

/// Sums pixels up by voxel in a small table that fits the processor's cache. A voxel that finds its place
/// taken turns the other out, and that one may come back as a sample of its own.
class SampleCollector {
 public:
  SampleCollector() : slots_(size_t{1} << kSlotBits) {}

  void add(VoxelKey key, const std::array<uint32_t, 3>& steps, const cv::Vec3b& bgr) {
    constexpr int kKeyBits = 64;
    VoxelSample& slot = slots_[scatter(key) >> (kKeyBits - kSlotBits)];
    if (slot.key != key) {
      if (slot.pixels > 0) samples_.push_back(slot);
      slot = {};
      slot.key = key;
    }
    ++slot.pixels;
    for (size_t i = 0; i < 3; ++i) {
      slot.steps[i] += steps[i] % kVoxelSteps;
      slot.colors[i] += bgr[static_cast<int>(2 - i)];
    }
  }

  std::vector<VoxelSample> take() {
    for (const VoxelSample& slot : slots_) {
      if (slot.pixels > 0) samples_.push_back(slot);
    }
    return std::move(samples_);
  }

 private:
  static constexpr int kSlotBits = 13;

  std::vector<VoxelSample> slots_;
  std::vector<VoxelSample> samples_;
};

}  // namespace

RayTable ray_table(const PinholeCamera& camera) {
  RayTable table{.width = camera.width, .height = camera.height, .focal_px = camera.fx, .rays = {}};
  table.rays.reserve(static_cast<size_t>(camera.width) * static_cast<size_t>(camera.height));
  for (int row = 0; row < camera.height; ++row) {
    for (int col = 0; col < camera.width; ++col) {
      const Eigen::Vector3d ray = camera.unproject(camera.undistort(Eigen::Vector2d(col, row)), 1.0);
      table.rays.emplace_back(ray.head<2>().cast<float>());
    }
  }
  return table;
}

std::vector<VoxelSample> voxel_samples(const cv::Mat& color, const cv::Mat& depth_m,
                                       const SE3& T_world_camera, const RayTable& rays,
                                       const DenseOptions& options) {
  require(color.type() == CV_8UC3 && depth_m.type() == CV_32FC1 && color.size() == depth_m.size() &&
              color.cols == rays.width && color.rows == rays.height,
          "voxel_samples: images of the camera's size");
  // From camera to steps of voxels, counted from a corner so far away that all counts are positive.
  const double steps_per_m = kVoxelSteps / options.voxel_m;
  const Eigen::Matrix3d A = T_world_camera.R() * steps_per_m;
  const Eigen::Vector3d b =
      (T_world_camera.translation * steps_per_m).array() + static_cast<double>(kVoxelOrigin * kVoxelSteps);
  constexpr double kEnd = 2.0 * static_cast<double>(kVoxelOrigin * kVoxelSteps);

  const DepthLimits limits{options.min_m, options.max_m, options.max_slope_deg};
  SampleCollector samples;
  std::vector<uint8_t> usable(static_cast<size_t>(depth_m.cols));
  for (int row = kDepthMarginPx; row < depth_m.rows - kDepthMarginPx; row += options.stride_px) {
    mark_usable(depth_m, row, rays.focal_px, limits, usable.data());
    const float* depths = depth_m.ptr<float>(row);
    const auto* colors = color.ptr<cv::Vec3b>(row);
    const Eigen::Vector2f* row_rays = &rays.rays[static_cast<size_t>(row) * static_cast<size_t>(rays.width)];
    for (int col = kDepthMarginPx; col < depth_m.cols - kDepthMarginPx; col += options.stride_px) {
      if (usable[static_cast<size_t>(col)] == 0) continue;
      const double z = depths[col];
      const Eigen::Vector3d p = A * Eigen::Vector3d(row_rays[col].x() * z, row_rays[col].y() * z, z) + b;
      if (!((p.array() >= 0).all() && (p.array() < kEnd).all())) continue;
      const std::array<uint32_t, 3> steps{static_cast<uint32_t>(p.x()), static_cast<uint32_t>(p.y()),
                                          static_cast<uint32_t>(p.z())};
      const auto voxel = [&](size_t axis) { return static_cast<VoxelKey>(steps[axis] >> kStepBits); };
      samples.add(voxel(2) << (2 * kVoxelAxisBits) | voxel(1) << kVoxelAxisBits | voxel(0), steps,
                  colors[col]);
    }
  }
  return samples.take();
}

}  // namespace kinloop
