// Error of the estimated up direction.
//
//   bench_up paths FIRST COUNT [FILE...]   simulated rooms, the camera rolled at random along the path
//   bench_up level SEED [FILE]             same without roll
//   bench_up sequence DIR X Y Z            a recorded sequence at its true poses; (X, Y, Z) is up there
//   bench_up planes DIR                    the largest planes of a sequence at its true poses, to find up
//
// Rendered at 160x120 with Kinect noise and the true poses. FILE: paths in TUM format, used in turn with the
// built-in one.

#include <cstdlib>
#include <numbers>
#include <optional>

#include <Eigen/Eigenvalues>
#include <fmt/format.h>

#include "bench/up/planes.hpp"
#include "dense/surfels/fuse_surfels.hpp"
#include "dense/surfels/voxel_samples.hpp"
#include "dense/up_direction.hpp"
#include "drivers/datasets/tum_source.hpp"
#include "kinloop/core/random.hpp"
#include "kinloop/core/threads/parallel_for.hpp"
#include "simulator/camera_path.hpp"
#include "simulator/simulated_source.hpp"

namespace kinloop {
namespace {

constexpr double kDegree = std::numbers::pi / 180;
constexpr size_t kFrames = 40;

double angle_deg(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  return std::atan2(a.cross(b).norm(), a.dot(b)) / kDegree;
}

/// The former method: perpendicular to the image rows of all poses.
Eigen::Vector3d up_from_image_rows(std::span<const SE3> cameras) {
  Eigen::Matrix3d rows = Eigen::Matrix3d::Zero();
  Eigen::Vector3d camera_up = Eigen::Vector3d::Zero();
  for (const SE3& pose : cameras) {
    rows += pose.R().col(0) * pose.R().col(0).transpose();
    camera_up -= pose.R().col(1);
  }
  camera_up.normalize();
  rows -= 0.02 * static_cast<double>(cameras.size()) * camera_up * camera_up.transpose();
  const Eigen::Vector3d up = Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(rows).eigenvectors().col(0);
  return up.dot(camera_up) < 0 ? Eigen::Vector3d(-up) : up;
}

/// Images at their true poses.
struct Views {
  std::vector<ImageSurfels> surfels;
  std::vector<PosedImage> posed;
};

void add(Views& views, const Frame& frame, const SE3& T_world_camera, double focal_px) {
  const size_t index = views.surfels.size();
  views.surfels.push_back(extract_surfels({frame.color.bgr(), frame.depth_m}, {focal_px}, {}));
  views.posed.push_back({index, T_world_camera});
}

void print(const std::string& name, const Views& views, const PinholeCamera& camera,
           const Eigen::Vector3d& truth) {
  std::vector<SE3> cameras;
  for (const PosedImage& view : views.posed) cameras.push_back(view.T_world_camera);
  const auto normals =
      surface_normals([&](size_t i) { return views.surfels[i]; }, views.posed, {.color = camera});
  const UpEstimate up = estimate_up_direction(normals, cameras);
  fmt::print("{:40} {:6.1f} {:6.1f} {:7.2f}  {:7} {:.3f}  {} normals\n", name,
             angle_deg(up_from_image_rows(cameras), truth),
             angle_deg(mean_camera_up(cameras).direction, truth), angle_deg(up.direction, truth),
             to_string(up.source), up.confidence, normals.size());
}

/// Rolls the cameras by a smooth random angle along the path, up to half a turn either way.
Trajectory rolled(Trajectory path, uint64_t seed) {
  Random random(hash(seed, 0x4011));
  const double start = random.uniform(-180, 180) * kDegree, swing = random.uniform(0, 180) * kDegree;
  const double swings = random.uniform(0.3, 3), phase = random.uniform(0, 360) * kDegree;
  for (size_t i = 0; i < path.size(); ++i) {
    const double s = static_cast<double>(i) / static_cast<double>(path.size());
    const double roll = start + swing * std::sin(2 * std::numbers::pi * swings * s + phase);
    path[i].T_world_camera = path[i].T_world_camera * SE3{exp_so3({0, 0, roll}), Eigen::Vector3d::Zero()};
  }
  return path;
}

void judge_room(const std::string& name, uint64_t seed, const Trajectory& path) {
  SimulationOptions options;
  options.width = 160, options.height = 120;
  const SimulatedSource source("sim:room", seed, options, hardware_threads(), path);
  Views views;
  const size_t frames = source.info().frames;
  for (size_t i = 0; i < kFrames; ++i) {
    const size_t index = i * frames / kFrames;
    add(views, source.frame(index), source.info().ground_truth[index].T_world_camera,
        source.camera().color.fx);
  }
  print(name, views, source.camera().color, sim::estimate_up_direction(path));
}

/// About 40 frames at their true poses.
Views views_of(TumSource& source) {
  Views views;
  const Trajectory& truth = source.info().ground_truth;
  const size_t step = source.info().frames / kFrames + 1;
  for (size_t i = 0; const auto frame = source.next(); ++i) {
    const auto pose = pose_at(truth, frame->stamp_ns, 100'000'000);
    if (i % step == 0 && pose) add(views, *frame, *pose, source.camera().color.fx);
  }
  return views;
}

void judge_sequence(const char* folder, const Eigen::Vector3d& up) {
  TumSource source(folder);
  const Views views = views_of(source);
  print(folder, views, source.camera().color, up);
}

void print_planes(const char* folder) {
  TumSource source(folder);
  const Views views = views_of(source);
  const DenseCamera camera{.color = source.camera().color};
  const RayTable rays = ray_table(camera.color);
  std::vector<Eigen::Vector3d> points;
  for (const PosedImage& view : views.posed) {
    const auto samples = voxel_samples(views.surfels[view.image], view, camera, rays, 0.01);
    for (size_t i = 0; i < samples.size(); i += 20) {
      points.push_back(0.01 * (voxel_of(samples[i].key).cast<double>() + samples[i].offset.cast<double>()));
    }
  }
  for (const Plane& plane : largest_planes(points, 14)) {
    const Eigen::Vector3d& n = plane.normal;
    fmt::print("normal {:7.4f} {:7.4f} {:7.4f}  offset {:6.3f} m  {:4.1f} % of points, RMS {:.1f} mm\n",
               n.x(), n.y(), n.z(), plane.offset_m, 100 * plane.share, 1000 * plane.rms_m);
  }
}

int main_of(int argc, char** argv) {
  const std::string what = argc > 1 ? argv[1] : "";
  fmt::print("{:40} {:>6} {:>6} {:>7}\n", "degrees off", "rows", "mean", "now");
  if (what == "paths" && argc >= 4) {
    const uint64_t first = std::strtoull(argv[2], nullptr, 10), count = std::strtoull(argv[3], nullptr, 10);
    for (uint64_t seed = first; seed < first + count; ++seed) {
      const size_t kind = seed % static_cast<size_t>(argc - 3);
      const std::string file = kind == 0 ? "" : argv[3 + kind];
      const Trajectory path = kind == 0 ? sim::handheld_path(seed) : read_tum_trajectory(file);
      judge_room(fmt::format("{} {}", seed, kind == 0 ? "sim:room" : file.substr(file.rfind('/') + 1)), seed,
                 rolled(path, seed));
    }
  } else if (what == "level" && argc >= 3) {
    const uint64_t seed = std::strtoull(argv[2], nullptr, 10);
    judge_room(argc > 3 ? argv[3] : fmt::format("sim:room:{}", seed), seed,
               argc > 3 ? read_tum_trajectory(argv[3]) : sim::handheld_path(seed));
  } else if (what == "sequence" && argc == 6) {
    judge_sequence(argv[2], {std::atof(argv[3]), std::atof(argv[4]), std::atof(argv[5])});
  } else if (what == "planes" && argc == 3) {
    print_planes(argv[2]);
  } else {
    return 2;
  }
  return 0;
}

}  // namespace
}  // namespace kinloop

int main(int argc, char** argv) {
  return kinloop::main_of(argc, argv);
}
