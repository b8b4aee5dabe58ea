#include "dense/occupancy.hpp"

#include <algorithm>
#include <cmath>

#include "dense/surfels/voxel_samples.hpp"
#include "dense/usable_depth.hpp"
#include "kinloop/core/errors.hpp"

#ifdef KINLOOP_WITH_OCTOMAP
#include <sstream>

#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wconversion"
#pragma GCC diagnostic ignored "-Wshadow"
#include <octomap/OcTree.h>
#pragma GCC diagnostic pop
#endif

namespace kinloop {
namespace {

/// Points of every few usable pixels of an image, in the camera frame.
std::vector<Eigen::Vector3d> points_of(const cv::Mat& depth_m, const RayTable& rays,
                                       const OccupancyOptions& options) {
  const cv::Mat usable = usable_pixels(depth_m, rays.focal_px, options.limits);
  std::vector<Eigen::Vector3d> points;
  for (int row = 0; row < depth_m.rows; row += options.stride_px) {
    for (int col = 0; col < depth_m.cols; col += options.stride_px) {
      if (usable.at<uint8_t>(row, col) == 0) continue;
      const double z = depth_m.at<float>(row, col);
      const Eigen::Vector2f& ray =
          rays.rays[static_cast<size_t>(row) * static_cast<size_t>(rays.width) + static_cast<size_t>(col)];
      points.emplace_back(ray.x() * z, ray.y() * z, z);
    }
  }
  return points;
}

}  // namespace

Floor find_floor(const ImageStore& images, std::span<const PosedImage> views, const PinholeCamera& camera,
                 const Eigen::Vector3d& up, const OccupancyOptions& options) {
  const RayTable rays = ray_table(camera);
  std::vector<double> heights_m;
  for (const PosedImage& view : views) {
    for (const Eigen::Vector3d& p : points_of(images.load(view.image).depth_m, rays, options)) {
      heights_m.push_back(up.dot(view.T_world_camera * p));
    }
  }
  Floor floor;
  floor.T_floor_world.rotation = Eigen::Quaterniond::FromTwoVectors(up, Eigen::Vector3d::UnitZ());
  if (heights_m.empty()) return floor;
  constexpr double kByChance = 0.01;  // share of points that may lie below the floor
  const auto lowest =
      heights_m.begin() + static_cast<long>(kByChance * static_cast<double>(heights_m.size()));
  std::nth_element(heights_m.begin(), lowest, heights_m.end());
  const Eigen::Vector3d first = floor.T_floor_world.rotation * views.front().T_world_camera.translation;
  floor.T_floor_world.translation = {-first.x(), -first.y(), -*lowest};
  return floor;
}

#ifdef KINLOOP_WITH_OCTOMAP

struct OccupancyMap::Tree {
  explicit Tree(double voxel_m) : tree(voxel_m) {}
  octomap::OcTree tree;
};

bool occupancy_available() {
  return true;
}

OccupancyMap::OccupancyMap(const ImageStore& images, std::span<const PosedImage> views,
                           const PinholeCamera& camera, const Floor& floor, const OccupancyOptions& options,
                           const Progress& progress)
    : options_(options), tree_(std::make_unique<Tree>(options.voxel_m)) {
  validate(options, "occupancy.");
  validate(options.limits, "occupancy.");
  const RayTable rays = ray_table(camera);
  for (size_t i = 0; i < views.size(); ++i) {
    if (!report(progress, "occupancy", i, views.size())) break;
    const SE3 T_floor_camera = floor.T_floor_world * views[i].T_world_camera;
    octomap::Pointcloud points;
    for (const Eigen::Vector3d& p : points_of(images.load(views[i].image).depth_m, rays, options)) {
      const Eigen::Vector3f q = (T_floor_camera * p).cast<float>();
      points.push_back(q.x(), q.y(), q.z());
    }
    const Eigen::Vector3f eye = T_floor_camera.translation.cast<float>();
    constexpr bool kAllBranchesLater = true, kOneRayPerVoxel = true;
    tree_->tree.insertPointCloud(points, {eye.x(), eye.y(), eye.z()}, options.limits.max_depth_m * 2,
                                 kAllBranchesLater, kOneRayPerVoxel);
  }
  report(progress, "occupancy", views.size(), views.size());
  tree_->tree.updateInnerOccupancy();
}

OccupancyMap::~OccupancyMap() = default;

std::string OccupancyMap::serialize_binary() const {
  std::ostringstream stream;
  tree_->tree.writeBinaryConst(stream);
  return stream.str();
}

std::string OccupancyMap::serialize_full() const {
  std::ostringstream stream;
  tree_->tree.write(stream);
  return stream.str();
}

OccupancyGrid OccupancyMap::grid() const {
  const octomap::OcTree& tree = tree_->tree;
  OccupancyGrid grid;
  grid.cell_m = options_.voxel_m;
  double low_x = 0, low_y = 0, low_z = 0, high_x = 0, high_y = 0, high_z = 0;
  tree.getMetricMin(low_x, low_y, low_z);
  tree.getMetricMax(high_x, high_y, high_z);
  grid.origin_x_m = low_x, grid.origin_y_m = low_y;
  grid.width = static_cast<int>(std::lround((high_x - low_x) / grid.cell_m));
  grid.height = static_cast<int>(std::lround((high_y - low_y) / grid.cell_m));
  grid.cells.assign(static_cast<size_t>(grid.width) * static_cast<size_t>(grid.height), Occupancy::kUnknown);
  for (auto leaf = tree.begin_leafs(); leaf != tree.end_leafs(); ++leaf) {
    const double half_m = leaf.getSize() / 2;
    if (leaf.getZ() + half_m <= options_.grid_min_height_m ||
        leaf.getZ() - half_m >= options_.grid_max_height_m)
      continue;
    const auto state = tree.isNodeOccupied(*leaf) ? Occupancy::kOccupied : Occupancy::kFree;
    const auto first = [&](double center, double origin) {
      return static_cast<int>(std::lround((center - half_m - origin) / grid.cell_m));
    };
    const int side = static_cast<int>(std::lround(leaf.getSize() / grid.cell_m));
    const int col = first(leaf.getX(), low_x), row = first(leaf.getY(), low_y);
    for (int y = std::max(row, 0); y < std::min(row + side, grid.height); ++y) {
      for (int x = std::max(col, 0); x < std::min(col + side, grid.width); ++x) {
        auto& cell =
            grid.cells[static_cast<size_t>(y) * static_cast<size_t>(grid.width) + static_cast<size_t>(x)];
        cell = std::max(cell, state);  // one obstacle in the column is enough
      }
    }
  }
  return grid;
}

#else

struct OccupancyMap::Tree {};

bool occupancy_available() {
  return false;
}

OccupancyMap::OccupancyMap(const ImageStore&, std::span<const PosedImage>, const PinholeCamera&, const Floor&,
                           const OccupancyOptions& options, const Progress&)
    : options_(options) {
  throw UsageError("occupancy: this build has no OctoMap; install liboctomap-dev and rebuild kinloop");
}

OccupancyMap::~OccupancyMap() = default;

std::string OccupancyMap::serialize_binary() const {
  return {};
}

std::string OccupancyMap::serialize_full() const {
  return {};
}

OccupancyGrid OccupancyMap::grid() const {
  return {};
}

#endif

}  // namespace kinloop
