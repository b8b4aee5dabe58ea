// kinloop bench: baselines to compare a run with.

#include <memory>

#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <sys/resource.h>

#include "apps/run/cloud_quality.hpp"
#include "apps/shared/commands.hpp"
#include "apps/shared/common_options.hpp"
#include "kinloop/core/errors.hpp"
#include "kinloop/core/stopwatch.hpp"
#include "kinloop/core/text/json.hpp"
#include "kinloop/core/threads/parallel_for.hpp"
#include "kinloop/io/point_cloud/ply.hpp"
#include "session/open_frame_source.hpp"
#include "tools/evaluation/evaluate.hpp"

namespace kinloop {
namespace {

/// Only reads and decodes every frame.
void bench_decode(const std::string& sequence, const std::optional<std::string>& camera) {
  const Stopwatch watch;
  SourceRequest request;
  request.sequence = sequence;
  request.camera = camera;
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
  auto sequence = std::make_shared<std::string>();
  auto camera = std::make_shared<std::string>();
  decode->add_option("SEQUENCE", *sequence, "a folder in TUM layout, or sim:room")->required();
  decode->add_option("--camera", *camera, "camera.yaml or preset, as for kinloop run");
  decode->callback([sequence, camera] {
    bench_decode(*sequence, camera->empty() ? std::nullopt : std::optional(*camera));
  });
}

}  // namespace kinloop
