// kinloop map: shows the content of a map file, merges two maps, or compares them.

#include <set>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "apps/map/merge_maps.hpp"
#include "apps/shared/commands.hpp"
#include "apps/shared/common_options.hpp"
#include "apps/shared/interrupt.hpp"
#include "apps/shared/progress_bar.hpp"
#include "apps/shared/standard_output.hpp"
#include "kinloop/core/errors.hpp"
#include "kinloop/core/files/byte_reader.hpp"
#include "kinloop/core/files/writable_check.hpp"
#include "kinloop/core/log.hpp"
#include "kinloop/core/text/json.hpp"
#include "kinloop/core/threads/parallel_for.hpp"
#include "kinloop/io/point_cloud/ply.hpp"
#include "session/map_store.hpp"
#include "tools/map_difference/map_difference.hpp"

namespace kinloop {
namespace {

using nlohmann::json;

size_t components_of(const std::vector<Keyframe>& keyframes) {
  std::set<uint32_t> components;
  for (const Keyframe& keyframe : keyframes) components.insert(keyframe.component);
  return components.size();
}

json sessions_json(const SavedMap& saved) {
  json sessions = json::array();
  for (size_t i = 0; i < saved.sessions.size(); ++i) {
    const FrameId begin = saved.sessions[i].first_frame;
    const FrameId end = i + 1 < saved.sessions.size() ? saved.sessions[i + 1].first_frame : FrameId{};
    const auto in_session = [&](const TrackedFrame& f) { return f.id >= begin && f.id < end; };
    sessions.push_back({{"input", saved.sessions[i].input},
                        {"frames", std::count_if(saved.frames.begin(), saved.frames.end(), in_session)}});
  }
  return sessions;
}

json map_info(const std::filesystem::path& path) {
  const MapReader reader(path);
  auto [saved, damage] = reader.read();
  size_t images = 0, image_bytes = 0;
  damage.images = reader.read_images([&](const SavedImages& image) {
    ++images;
    image_bytes += image.images.color.size() + image.images.depth.size();
  });
  const auto landmarks = std::count_if(saved.map.landmarks.begin(), saved.map.landmarks.end(),
                                       [](const auto& landmark) { return landmark.has_value(); });
  const PinholeCamera& lens = saved.camera.color;
  return {{"file", path.string()},
          {"bytes", std::filesystem::file_size(path)},
          {"program", saved.program},
          {"sessions", sessions_json(saved)},
          {"frames", saved.frames.size()},
          {"keyframes", saved.map.keyframes.size()},
          {"components", components_of(saved.map.keyframes)},
          {"landmarks", landmarks},
          {"loops", saved.map.loop_closures.size()},
          {"images", images},
          {"image_bytes", image_bytes},
          {"camera", {{"width", lens.width}, {"height", lens.height}, {"fx", lens.fx}, {"fy", lens.fy}}},
          {"lost", describe(damage)}};
}

std::string text_of(const json& info) {
  constexpr double kMebi = 1 << 20;
  std::string text =
      fmt::format("file       {}, {:.1f} MiB, by {}\n", info["file"].get<std::string>(),
                  info["bytes"].get<double>() / kMebi, printable(info["program"].get<std::string>()));
  for (const json& session : info["sessions"]) {
    text += fmt::format("session    {}, {} frames\n", printable(session["input"].get<std::string>()),
                        session["frames"].get<long>());
  }
  const std::string lost = info["lost"];
  return text + fmt::format(
                    "keyframes  {} in {} component(s), landmarks {}, loops {}\n"
                    "images     {}, {:.1f} MiB\n"
                    "camera     {}x{}, fx {}, fy {}\n"
                    "damage     {}\n",
                    info["keyframes"].get<long>(), info["components"].get<long>(),
                    info["landmarks"].get<long>(), info["loops"].get<long>(), info["images"].get<long>(),
                    info["image_bytes"].get<double>() / kMebi, info["camera"]["width"].get<int>(),
                    info["camera"]["height"].get<int>(), info["camera"]["fx"].get<double>(),
                    info["camera"]["fy"].get<double>(), lost.empty() ? "none" : "lost: " + lost);
}

struct MergeArguments {
  MergeRequest maps;
  std::filesystem::path output;
  bool quiet = false;
};

void merge(const MergeArguments& arguments) {
  for (const auto& input : {arguments.maps.a, arguments.maps.b})
    require_different_file("-o", arguments.output, map_file_of(input));
  require_writable_file(arguments.output);
  const MergedMaps merged = merge_maps(arguments.maps, make_progress_bar(arguments.quiet));
  MapSaver(arguments.output, {*merged.slam, *merged.recorder, merged.options, {}}, 0).save();
  if (merged.loops_between == 0) {
    log::warn("no place of one map was recognised in the other: {} contains both as separate components",
              arguments.output.string());
  }
  if (!arguments.quiet) {
    const auto& keyframes = merged.slam->map().keyframes();
    fmt::print(message_stream(arguments.output),
               "{} keyframes in {} component(s), {} loops between the two maps, in {}\n", keyframes.size(),
               components_of(keyframes), merged.loops_between, arguments.output.string());
  }
}

struct DiffArguments {
  MergeRequest maps;
  std::filesystem::path output = "diff.ply";
  bool as_json = false;
  bool quiet = false;
};

/// Returns the views of the component that holds most images of both maps, split by the map they are of.
std::pair<std::vector<PosedImage>, std::vector<PosedImage>> views_of_both(const MergedMaps& merged) {
  std::pair<std::vector<PosedImage>, std::vector<PosedImage>> both;
  const Slam& slam = *merged.slam;
  const uint32_t component = main_component(slam.log(), slam.map());
  for (const PosedImage& view : merged.recorder->views(slam.log(), slam.map(), component)) {
    const bool is_of_a = merged.recorder->frame_of_image(view.image) < merged.first_of_b;
    (is_of_a ? both.first : both.second).push_back(view);
  }
  return both;
}

std::string text_of(const MapDifference& difference, const FileFrame& frame) {
  if (difference.objects.empty()) return "no object is gone, added or moved\n";
  const auto place = [&](const Eigen::Vector3d& p_world) {
    const Eigen::Vector3f p = frame.to_file(p_world.cast<float>());
    return fmt::format("({:.2f}, {:.2f}, {:.2f})", p.x(), p.y(), p.z());
  };
  std::string text;
  for (const ChangedObject& object : difference.objects) {
    text += fmt::format("{:6} {:5.2f} m²  at {}", to_string(object.change), object.surface_m2,
                        place(object.center_m));
    if (object.change == ObjectChange::kMoved) {
      text += fmt::format(", by {:.2f} m to {}", (object.moved_to_m - object.center_m).norm(),
                          place(object.moved_to_m));
    }
    text += '\n';
  }
  return text;
}

void diff(const DiffArguments& arguments) {
  for (const auto& input : {arguments.maps.a, arguments.maps.b})
    require_different_file("-o", arguments.output, map_file_of(input));
  require_writable_file(arguments.output);
  install_interrupt_handler();
  const Progress progress = interruptible(make_progress_bar(arguments.quiet || arguments.as_json));
  const MergedMaps merged = merge_maps(arguments.maps, progress);
  throw_if_interrupted();
  if (merged.loops_between == 0) {
    throw InputError(fmt::format("{}: no place of {} was recognised in it, so they cannot be compared",
                                 arguments.maps.b.string(), arguments.maps.a.string()));
  }
  const auto [views_a, views_b] = views_of_both(merged);
  require_images(views_a.size(), arguments.maps.a);
  require_images(views_b.size(), arguments.maps.b);
  DenseRecorder& recorder = *merged.recorder;
  const DenseOptions& dense = merged.options.dense;
  const ComparisonOptions options{dense_camera(merged.camera, merged.slam->sensor_estimate()), dense.limits,
                                  dense.voxel_m, hardware_threads()};
  const ColoredCloud before = recorder.fuse_views(views_a, options.camera, options.threads, progress);
  const ColoredCloud after = recorder.fuse_views(views_b, options.camera, options.threads, progress);
  const Visit visit_a{before, {recorder.images(), views_a}}, visit_b{after, {recorder.images(), views_b}};
  const MapDifference difference = compare_visits_of_place(visit_a, visit_b, options, progress);
  throw_if_interrupted();
  const FileFrame frame = file_frame("z-up", recorder.up(views_a, options.camera), views_a);
  write_ply(arguments.output, color_difference(visit_a, visit_b, difference), frame);
  if (arguments.as_json) {
    json numbers = to_json(difference, frame.T_file_world().rotation);
    numbers["cloud"] = arguments.output.string();
    fmt::print("{}\n", json_text(numbers, 2));
  } else if (!arguments.quiet) {
    fmt::print(message_stream(arguments.output), "{}{}: red is gone, green was added\n",
               text_of(difference, frame), arguments.output.string());
  }
}

void add_info(CLI::App& map) {
  CLI::App* command = map.add_subcommand("info", "Show the contents of a map file and check it for damage");
  auto path = std::make_shared<std::filesystem::path>();
  auto as_json = std::make_shared<bool>(false);
  command->add_option("FILE", *path, "a map file, or the folder of a run")->required();
  command->add_flag("--json", *as_json, "print as JSON");
  command->callback([path, as_json] {
    const json info = map_info(map_file_of(*path));
    fmt::print("{}", *as_json ? json_text(info, 2) + "\n" : text_of(info));
  });
}

void add_maps(CLI::App& command, MergeRequest& maps) {
  command.add_option("A", maps.a, "a map file, or the folder of a run; its world frame is kept")->required();
  command.add_option("B", maps.b, "another map file or folder of a run")->required();
  command.add_option("--vocabulary", maps.vocabulary, "visual vocabulary (default: built-in)");
  add_set_option(command, maps.assignments);
}

void add_merge(CLI::App& map) {
  auto arguments = std::make_shared<MergeArguments>();
  CLI::App* command = map.add_subcommand(
      "merge", "Merge two maps of one camera: join them where a place is recognised, then optimise");
  add_maps(*command, arguments->maps);
  command->add_option("-o,--output", arguments->output, "the map file to write")->required();
  add_quiet_option(*command, arguments->quiet);
  command->callback([arguments] { merge(*arguments); });
}

void add_diff(CLI::App& map) {
  auto arguments = std::make_shared<DiffArguments>();
  CLI::App* command = map.add_subcommand(
      "diff",
      "Compare two maps of one place: what is gone in B, was added or was moved, as a cloud and a list");
  add_maps(*command, arguments->maps);
  command->add_option("-o,--output", arguments->output, "cloud of both: red is gone, green was added")
      ->capture_default_str();
  command->add_flag("--json", arguments->as_json, "print the list as JSON");
  add_quiet_option(*command, arguments->quiet);
  command->footer(
      "The maps are joined as by 'kinloop map merge'. Something counts as gone if B saw through its place; "
      "where\n"
      "B did not look, nothing is said. Changes of less than some 5 cm in depth or 300 cm² are not found.\n\n"
      "Examples:\n"
      "  kinloop map diff monday tuesday -o diff.ply\n"
      "  kinloop map diff monday tuesday --json");
  command->callback([arguments] { diff(*arguments); });
}

}  // namespace

void add_map_command(CLI::App& app) {
  CLI::App* command = app.add_subcommand("map", "Inspect, merge and compare map files");
  command->require_subcommand(1);
  add_info(*command);
  add_merge(*command);
  add_diff(*command);
}

}  // namespace kinloop
