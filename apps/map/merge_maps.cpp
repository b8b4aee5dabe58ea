#include "apps/map/merge_maps.hpp"

#include <fmt/format.h>

#include "apps/shared/command_line/common_options.hpp"
#include "kinloop/core/errors.hpp"
#include "kinloop/core/threads/parallel_for.hpp"
#include "session/plan/run_plan.hpp"
#include "session/store/map_store.hpp"

namespace kinloop {

MergedMaps merge_maps(const MergeRequest& request, const Progress& progress) {
  const auto path_a = map_file_of(request.a), path_b = map_file_of(request.b);
  const MapReader reader_a(path_a), reader_b(path_b);
  SavedMap a = read_map_with_warnings(reader_a, path_a), b = read_map_with_warnings(reader_b, path_b);
  require_same_camera(a, path_a, b.camera);
  if (a.camera.depth_scale != b.camera.depth_scale)
    throw InputError(fmt::format("{}: depth in {} units per metre, but {} in {}", path_b.string(),
                                 b.camera.depth_scale, a.camera.depth_scale, path_a.string()));
  restore_surfaces(a, reader_a);
  restore_surfaces(b, reader_b);
  MergedMaps merged;
  merged.camera = a.camera;
  merged.options = restore_options(a, path_a);
  merged.options.slam.global_ba.threads = hardware_threads();
  merged.options.slam.localize_only = false;
  merged.options = run_options_with(merged.options, request.assignments);

  merged.slam = std::make_unique<Slam>(merged.camera, merged.options.slam,
                                       open_vocabulary(request.vocabulary, merged.options.slam.features));
  merged.recorder = std::make_unique<DenseRecorder>(merged.camera, merged.options.dense);
  Slam& slam = *merged.slam;
  load_images(reader_a, path_a, slam.add_map(std::move(a)), *merged.recorder);
  const size_t before = slam.map().loop_closures().size() + b.map.loop_closures.size();
  const uint32_t shift = slam.add_map(std::move(b));
  merged.first_of_b = FrameId{shift};
  load_images(reader_b, path_b, shift, *merged.recorder);
  merged.loops_between = slam.map().loop_closures().size() - before;
  slam.finish(progress);
  return merged;
}

std::vector<std::filesystem::path> inputs_of(const MergeRequest& request) {
  return {map_file_of(request.a), map_file_of(request.b), request.vocabulary};
}

void add_map_arguments(CLI::App& command, MergeRequest& maps) {
  command.add_option("A", maps.a, "a map file, or the folder of a run; its world frame is kept")->required();
  command.add_option("B", maps.b, "another map file or folder of a run")->required();
  command.add_option("--vocabulary", maps.vocabulary, "visual vocabulary (default: built-in)");
  add_set_option(command, maps.assignments);
}

}  // namespace kinloop
