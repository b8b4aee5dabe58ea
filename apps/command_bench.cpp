// kinloop bench: floors that a run can be compared with.

#include <memory>

#include <fmt/format.h>
#include <sys/resource.h>

#include "apps/commands.hpp"
#include "apps/open_source.hpp"
#include "kinloop/base/parallel_for.hpp"
#include "kinloop/base/stopwatch.hpp"

namespace kinloop {
namespace {

/// Reads and decodes every frame and does nothing else.
void bench_decode(const std::string& sequence, const std::optional<std::string>& camera) {
  const Stopwatch watch;
  SourceRequest request;
  request.sequence = sequence;
  request.camera = camera;
  request.threads = hardware_threads();
  const auto source = open_source(request);
  size_t frames = 0;
  while (source->next()) ++frames;
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  fmt::print("{} frames decoded in {:.2f} s wall, {:.2f} s CPU, {:.0f} MiB at most\n", frames, watch.wall_s(),
             watch.cpu_s(), static_cast<double>(usage.ru_maxrss) / 1024.0);
}

}  // namespace

void add_bench_command(CLI::App& app) {
  CLI::App* bench = app.add_subcommand("bench", "Floors that a run can be compared with");
  bench->require_subcommand(1);
  CLI::App* decode =
      bench->add_subcommand("decode", "Read and decode every frame on one thread, and nothing else");
  auto sequence = std::make_shared<std::string>();
  auto camera = std::make_shared<std::string>();
  decode->add_option("SEQUENCE", *sequence, "a folder in TUM layout, or sim:room")->required();
  decode->add_option("--camera", *camera, "camera.yaml or preset, as for kinloop run");
  decode->callback([sequence, camera] {
    bench_decode(*sequence, camera->empty() ? std::nullopt : std::optional(*camera));
  });
}

}  // namespace kinloop
