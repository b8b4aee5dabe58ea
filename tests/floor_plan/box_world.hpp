#pragma once
// Flats of upright walls, and what a depth camera that turns about in them measures.

#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <optional>
#include <tuple>
#include <vector>

#include "dense/cloud/colored_cloud.hpp"
#include "dense/image_store.hpp"
#include "dense/posed_image.hpp"
#include "tools/floor_plan/floor_plan.hpp"

namespace kinloop::test {

/// An upright rectangle between two points of the floor.
struct Panel {
  Eigen::Vector2d a, b;
  double low_m = 0, high_m = 2.5;
};

/// The images and the cloud of a flat; z up, the floor at 0, the ceiling at 2.5 m.
class BoxWorld {
 public:
  explicit BoxWorld(std::vector<Panel> panels) : panels_(std::move(panels)) {}

  /// Adds panels between successive points, and from the last to the first.
  static std::vector<Panel> closed(const std::vector<Eigen::Vector2d>& corners) {
    std::vector<Panel> panels;
    for (size_t i = 0; i < corners.size(); ++i)
      panels.push_back({corners[i], corners[(i + 1) % corners.size()]});
    return panels;
  }

  /// Looks around from a place, 1.4 m above the floor.
  void look_around(const Eigen::Vector2d& from) {
    constexpr int kViews = 12;
    constexpr double kHeight_m = 1.4;
    for (int i = 0; i < kViews; ++i) {
      const double yaw = 2 * std::numbers::pi * i / kViews;
      Eigen::Matrix3d R;  // columns: right, down, forward
      R << std::sin(yaw), 0, std::cos(yaw), -std::cos(yaw), 0, std::sin(yaw), 0, -1, 0;
      for (const double sideways_m : {0.0, 0.05})
        add_view({Eigen::Quaterniond(R), {from.x() + sideways_m, from.y(), kHeight_m}});
    }
  }

  [[nodiscard]] FloorPlan plan() const {
    return make_floor_plan({.cloud = cloud_,
                            .images = images_,
                            .views = views_,
                            .camera = kCamera,
                            .R_file_world = Eigen::Quaterniond::Identity(),
                            .voxel_m = kVoxel_m,
                            .limits = {.min_depth_m = 0.1, .max_depth_m = 12, .max_incidence_deg = 89}});
  }

 private:
  static constexpr double kVoxel_m = 0.05, kCeiling_m = 2.5;
  inline static const PinholeCamera kCamera{120, 120, 60, 60, 59.5, 59.5, {}};

  struct Hit {
    double range = std::numeric_limits<double>::infinity();
    Eigen::Vector3d normal = Eigen::Vector3d::Zero();  ///< towards the camera
  };

  static void meet_level(Hit& hit, const Eigen::Vector3d& from, const Eigen::Vector3d& way) {
    if (std::abs(way.z()) < 1e-9) return;
    const double range = ((way.z() > 0 ? kCeiling_m : 0) - from.z()) / way.z();
    if (range < hit.range) hit = {range, {0, 0, way.z() > 0 ? -1.0 : 1.0}};
  }

  static void meet_panel(Hit& hit, const Panel& panel, const Eigen::Vector3d& from,
                         const Eigen::Vector3d& way) {
    const Eigen::Vector2d edge = panel.b - panel.a,
                          normal = Eigen::Vector2d(-edge.y(), edge.x()).normalized();
    const double speed = normal.dot(way.head<2>());
    if (std::abs(speed) < 1e-9) return;
    const double range = normal.dot(panel.a - from.head<2>()) / speed;
    if (range <= 0 || range >= hit.range) return;
    const Eigen::Vector3d p = from + range * way;
    const double along = edge.dot(p.head<2>() - panel.a) / edge.squaredNorm();
    if (along < 0 || along > 1 || p.z() < panel.low_m || p.z() > panel.high_m) return;
    const double sign = speed < 0 ? 1 : -1;
    hit = {range, {sign * normal.x(), sign * normal.y(), 0}};
  }

  void add_view(const SE3& T_world_camera) {
    RgbdImages images{cv::Mat::zeros(kCamera.height, kCamera.width, CV_8UC3),
                      cv::Mat::zeros(kCamera.height, kCamera.width, CV_32FC1)};
    for (int row = 0; row < kCamera.height; ++row) {
      for (int col = 0; col < kCamera.width; ++col) {
        const Eigen::Vector3d ray((col - kCamera.cx) / kCamera.fx, (row - kCamera.cy) / kCamera.fy, 1);
        const Eigen::Vector3d way = T_world_camera.rotation * ray;
        Hit hit;
        meet_level(hit, T_world_camera.translation, way);
        for (const Panel& panel : panels_) meet_panel(hit, panel, T_world_camera.translation, way);
        images.depth_m.at<float>(row, col) = static_cast<float>(hit.range);
        add_point(T_world_camera.translation + hit.range * way, hit.normal);
      }
    }
    views_.push_back({images_.add(images), T_world_camera});
  }

  /// Keeps one point of a voxel.
  void add_point(const Eigen::Vector3d& p, const Eigen::Vector3d& normal) {
    const Eigen::Vector3d voxel = (p / kVoxel_m).array().floor();
    if (!taken_.try_emplace({voxel.x(), voxel.y(), voxel.z()}, true).second) return;
    cloud_.points.push_back(p.cast<float>());
    cloud_.normals.push_back(normal.cast<float>());
    cloud_.colors.push_back({});
  }

  std::vector<Panel> panels_;
  ImageStore images_;
  std::vector<PosedImage> views_;
  ColoredCloud cloud_;
  std::map<std::tuple<double, double, double>, bool> taken_;
};

}  // namespace kinloop::test
