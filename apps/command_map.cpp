// kinloop map: shows the content of a map file, merges two maps, or says in which map a camera is.

#include <set>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "apps/map_locate.hpp"
#include "apps/shared/commands.hpp"
#include "apps/shared/common_options.hpp"
#include "apps/shared/progress_bar.hpp"
#include "apps/shared/standard_output.hpp"
#include "kinloop/core/errors.hpp"
#include "kinloop/core/files/byte_reader.hpp"
#include "kinloop/core/files/writable_check.hpp"
#include "kinloop/core/log.hpp"
#include "kinloop/core/text/json.hpp"
#include "kinloop/core/threads/parallel_for.hpp"
#include "session/map_store.hpp"
#include "session/run_plan.hpp"

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
  std::filesystem::path a, b, output;
  std::string vocabulary;
  std::vector<std::string> assignments;
  bool quiet = false;
};

void merge(const MergeArguments& arguments) {
  const auto path_a = map_file_of(arguments.a), path_b = map_file_of(arguments.b);
  for (const auto& input : {path_a, path_b}) require_different_file("-o", arguments.output, input);
  require_writable_file(arguments.output);
  const MapReader reader_a(path_a), reader_b(path_b);
  SavedMap a = read_map_with_warnings(reader_a, path_a), b = read_map_with_warnings(reader_b, path_b);
  require_same_camera(a, path_a, b.camera);
  if (a.camera.depth_scale != b.camera.depth_scale)
    throw InputError(fmt::format("{}: depth in {} units per metre, but {} in {}", path_b.string(),
                                 b.camera.depth_scale, a.camera.depth_scale, path_a.string()));
  RunOptions options = restore_options(a, path_a);
  options.slam.global_ba.threads = hardware_threads();
  options.slam.localize_only = false;
  options = run_options_with(options, arguments.assignments);

  Slam slam(a.camera, options.slam, open_vocabulary(arguments.vocabulary, options.slam.features));
  DenseRecorder recorder(a.camera, options.dense);
  load_images(reader_a, path_a, slam.add_map(std::move(a)), recorder);
  const size_t before = slam.map().loop_closures().size() + b.map.loop_closures.size();
  load_images(reader_b, path_b, slam.add_map(std::move(b)), recorder);
  const size_t found = slam.map().loop_closures().size() - before;
  slam.finish(make_progress_bar(arguments.quiet));
  MapSaver(arguments.output, {slam, recorder, options, {}}, 0).save();
  if (found == 0) {
    log::warn("no place of one map was recognised in the other: {} contains both as separate components",
              arguments.output.string());
  }
  if (!arguments.quiet) {
    fmt::print(message_stream(arguments.output),
               "{} keyframes in {} component(s), {} loops between the two maps, in {}\n",
               slam.map().keyframes().size(), components_of(slam.map().keyframes()), found,
               arguments.output.string());
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

void add_merge(CLI::App& map) {
  auto arguments = std::make_shared<MergeArguments>();
  CLI::App* command = map.add_subcommand(
      "merge", "Merge two maps of one camera: join them where a place is recognised, then optimise");
  command->add_option("A", arguments->a, "a map file, or the folder of a run; its world frame is kept")
      ->required();
  command->add_option("B", arguments->b, "another map file or folder of a run")->required();
  command->add_option("-o,--output", arguments->output, "the map file to write")->required();
  command->add_option("--vocabulary", arguments->vocabulary, "visual vocabulary (default: built-in)");
  add_set_option(*command, arguments->assignments);
  add_quiet_option(*command, arguments->quiet);
  command->callback([arguments] { merge(*arguments); });
}

}  // namespace

void add_map_command(CLI::App& app) {
  CLI::App* command = app.add_subcommand("map", "Inspect and merge map files");
  command->require_subcommand(1);
  add_info(*command);
  add_merge(*command);
  add_map_locate_command(*command);
}

}  // namespace kinloop
