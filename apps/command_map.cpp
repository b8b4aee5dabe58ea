// kinloop map: shows the content of a map file, merges maps, compares them, says in which of them a camera
// is, or takes false loops out of one.

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "apps/map/components_of.hpp"
#include "apps/map/map_commands.hpp"
#include "apps/map/merge_maps.hpp"
#include "apps/shared/command_line/commands.hpp"
#include "apps/shared/command_line/common_options.hpp"
#include "apps/shared/terminal/progress_bar.hpp"
#include "apps/shared/terminal/standard_output.hpp"
#include "kinloop/core/errors.hpp"
#include "kinloop/core/files/byte_reader.hpp"
#include "kinloop/core/log.hpp"
#include "kinloop/core/text/json.hpp"
#include "kinloop/core/threads/parallel_for.hpp"
#include "session/store/command_files.hpp"
#include "session/store/map_store.hpp"

namespace kinloop {
namespace {

using nlohmann::json;

json sessions_json(const SavedMap& saved) {
  json sessions = json::array();
  for (size_t i = 0; i < saved.sessions.size(); ++i) {
    const FrameId begin = saved.sessions[i].first_frame;
    const FrameId end = i + 1 < saved.sessions.size() ? saved.sessions[i + 1].first_frame : FrameId{};
    const auto in_session = [&](const FrameRecord& f) { return f.id >= begin && f.id < end; };
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
  require_outputs({.inputs = inputs_of(arguments.maps), .outputs = {{"-o", arguments.output}}});
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
  add_map_arguments(*command, arguments->maps);
  command->add_option("-o,--output", arguments->output, "the map file to write")->required();
  add_quiet_option(*command, arguments->quiet);
  command->callback([arguments] { merge(*arguments); });
}

}  // namespace

void add_map_command(CLI::App& app) {
  CLI::App* command =
      app.add_subcommand("map", "Inspect, merge, compare and correct map files, and locate frames in them");
  command->require_subcommand(1);
  add_info(*command);
  add_merge(*command);
  add_map_diff_command(*command);
  add_map_locate_command(*command);
  add_map_withdraw_command(*command);
}

}  // namespace kinloop
