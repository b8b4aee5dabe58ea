// kinloop bench: baselines to compare a run with.

#include <algorithm>
#include <cmath>
#include <memory>
#include <unordered_map>
#include <unordered_set>

#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <sys/resource.h>

#include "apps/shared/command_line/commands.hpp"
#include "apps/shared/command_line/common_options.hpp"
#include "dense/cloud/colored_cloud.hpp"
#include "dense/files/ply.hpp"
#include "dense/surfels/voxel_samples.hpp"
#include "kinloop/core/errors.hpp"
#include "kinloop/core/quantile.hpp"
#include "kinloop/core/stopwatch.hpp"
#include "kinloop/core/text/json.hpp"
#include "kinloop/core/threads/parallel_for.hpp"
#include "session/source/open_frame_source.hpp"
#include "simulator/simulated_source.hpp"
#include "tools/evaluation/evaluate.hpp"

namespace kinloop {
namespace {

struct CloudQuality {
  size_t points = 0;
  double accuracy_median_m = 0;  ///< distance from a point to the nearest surface
  double accuracy_p95_m = 0;
  double completeness = 0;  ///< share of the visible surface that has a point within 1 cm
};

constexpr double kNearM = 0.01;

Eigen::Vector3i cell_of(const Eigen::Vector3d& p) {
  return (p / kNearM).array().floor().cast<int>();
}

uint64_t key_of(const Eigen::Vector3i& cell) {
  constexpr int64_t kOffset = 1 << 20;
  const auto part = [&](int axis) { return static_cast<uint64_t>(cell(axis) + kOffset); };
  return part(0) | part(1) << 21 | part(2) << 42;
}

/// Points by grid cell.
using Cells = std::unordered_map<uint64_t, std::vector<Eigen::Vector3d>>;

bool has_near(const Cells& cells, const Eigen::Vector3d& p) {
  const Eigen::Vector3i home = cell_of(p);
  for (int k = 0; k < 27; ++k) {
    const auto found = cells.find(key_of(home + Eigen::Vector3i(k % 3 - 1, k / 3 % 3 - 1, k / 9 - 1)));
    if (found == cells.end()) continue;
    for (const Eigen::Vector3d& other : found->second) {
      if ((other - p).norm() <= kNearM) return true;
    }
  }
  return false;
}

/// One point per cell of the visible surface.
std::vector<Eigen::Vector3d> visible_surface(const SimulatedSource& room) {
  constexpr size_t kEvery = 10;
  constexpr float kMinM = 0.5F, kMaxM = 4;
  const RayTable rays = ray_table(room.camera().color);
  std::unordered_set<uint64_t> seen;
  std::vector<Eigen::Vector3d> points;
  for (size_t f = 0; f < room.info().frames; f += kEvery) {
    const cv::Mat depth_m = room.frame(f).depth_m;
    const SE3& T_world_camera = room.info().ground_truth[f].T_world_camera;
    for (int i = 0; i < static_cast<int>(depth_m.total()); ++i) {
      const float z = depth_m.at<float>(i / depth_m.cols, i % depth_m.cols);
      if (!(z >= kMinM && z <= kMaxM)) continue;
      const Eigen::Vector2f& ray = rays.rays[static_cast<size_t>(i)];
      const Eigen::Vector3f p_camera(ray.x() * z, ray.y() * z, z);
      const Eigen::Vector3d p = T_world_camera * p_camera.cast<double>();
      if (seen.insert(key_of(cell_of(p))).second) points.push_back(p);
    }
  }
  return points;
}

/// Evaluates a cloud; `room` must be noise-free. Visible is what every tenth of its frames sees at up to 4 m.
CloudQuality cloud_quality(const ColoredCloud& cloud, const SimulatedSource& room, const SE3& T_truth_map) {
  constexpr size_t kMaxJudged =
      100'000;  // limit, since the distance to a surface is searched among all of the room's
  const size_t step = cloud.size() / kMaxJudged + 1;
  std::vector<double> distances_m((cloud.size() + step - 1) / step);
  parallel_for(distances_m.size(), hardware_threads(), [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) {
      distances_m[i] = room.distance_to_surface(T_truth_map * cloud.points[i * step].cast<double>());
    }
  });
  Cells cells;
  for (const Eigen::Vector3f& point : cloud.points) {
    const Eigen::Vector3d p = T_truth_map * point.cast<double>();
    cells[key_of(cell_of(p))].push_back(p);
  }
  const auto surface = visible_surface(room);
  const auto covered = std::count_if(surface.begin(), surface.end(),
                                     [&](const Eigen::Vector3d& p) { return has_near(cells, p); });
  CloudQuality quality;
  quality.points = cloud.size();
  quality.accuracy_median_m = quantile(distances_m, 0.5);
  quality.accuracy_p95_m = quantile(distances_m, 0.95);
  quality.completeness =
      surface.empty() ? 0 : static_cast<double>(covered) / static_cast<double>(surface.size());
  return quality;
}

/// Only reads and decodes every frame.
void bench_decode(const std::string& sequence, const std::string& chosen, const CameraOptions& camera) {
  const Stopwatch watch;
  SourceRequest request;
  request.sequence = sequence;
  request.chosen = chosen;
  set_camera(request, camera);
  request.threads = hardware_threads();
  const auto source = open_frame_source(request);
  size_t frames = 0;
  while (source->next()) ++frames;
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  fmt::print("{} frames decoded in {:.2f} s wall, {:.2f} s CPU, peak memory {:.0f} MiB\n", frames,
             watch.wall_s(), watch.cpu_s(), static_cast<double>(usage.ru_maxrss) / 1024.0);
}

struct CloudArguments {
  std::filesystem::path cloud, trajectory;
  std::string scene = "sim:room";
  std::vector<std::string> assignments;
};

void bench_cloud(const CloudArguments& arguments) {
  SimulationOptions options = with_assignments(SimulationOptions(), arguments.assignments);
  options.remove_noise();
  const auto source = make_simulated_source(arguments.scene, options, hardware_threads());
  SE3 T_truth_map;
  if (!arguments.trajectory.empty()) {
    const auto ate =
        absolute_trajectory_error(read_tum_trajectory(arguments.trajectory), source->info().ground_truth);
    if (!ate)
      throw InputError(fmt::format("{}: does not belong to this scene", arguments.trajectory.string()));
    T_truth_map = ate->T_truth_estimate;
  }
  const CloudQuality quality = cloud_quality(read_ply(arguments.cloud), *source, T_truth_map);
  fmt::print("{}\n", json_text({{"points", quality.points},
                                {"accuracy_median_m", quality.accuracy_median_m},
                                {"accuracy_p95_m", quality.accuracy_p95_m},
                                {"completeness", quality.completeness}}));
}

void add_cloud(CLI::App& bench) {
  auto arguments = std::make_shared<CloudArguments>();
  CLI::App* command = bench.add_subcommand(
      "cloud",
      "Compare a cloud of a simulated room with its exact surfaces: distance from cloud to surface, and\n"
      "the fraction of the visible surface that has a point within 1 cm");
  command->add_option("CLOUD", arguments->cloud, "map.ply of kinloop run or kinloop export")->required();
  command->add_option("--scene", arguments->scene, "the room that was mapped")->capture_default_str();
  command->add_option(
      "--trajectory", arguments->trajectory,
      "estimated poses, used to align the cloud with the room (default: the cloud is in the room's frame)");
  add_set_option(*command, arguments->assignments, "options of the simulation, key=value");
  command->callback([arguments] { bench_cloud(*arguments); });
}

}  // namespace

void add_bench_command(CLI::App& app) {
  CLI::App* bench = app.add_subcommand("bench", "Measure baselines that a run can be compared with");
  bench->require_subcommand(1);
  add_cloud(*bench);
  CLI::App* decode = bench->add_subcommand("decode", "Only read and decode every frame, on one thread");
  auto sequence = std::make_shared<std::string>(), chosen = std::make_shared<std::string>();
  auto camera = std::make_shared<CameraOptions>();
  decode->add_option("SEQUENCE", *sequence, "a folder in TUM layout, or sim:room")->required();
  add_sequence_option(*decode, *chosen);
  add_camera_options(*decode, *camera);
  decode->callback([sequence, chosen, camera] { bench_decode(*sequence, *chosen, *camera); });
}

}  // namespace kinloop
