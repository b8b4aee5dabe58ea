#include "apps/map/map_withdraw.hpp"

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "apps/map/components_of.hpp"
#include "apps/map/withdraw_loops.hpp"
#include "apps/shared/common_options.hpp"
#include "apps/shared/progress_bar.hpp"
#include "apps/shared/standard_output.hpp"
#include "kinloop/core/errors.hpp"
#include "kinloop/core/files/writable_check.hpp"
#include "kinloop/core/threads/parallel_for.hpp"
#include "kinloop/core/time.hpp"
#include "kinloop/sensor/sensor_estimate.hpp"
#include "kinloop/slam/saved_session.hpp"
#include "session/map_store.hpp"
#include "session/run_plan.hpp"

namespace kinloop {
namespace {

struct WithdrawArguments {
  std::filesystem::path map, output;
  std::vector<std::string> loops;  // "STAMP,STAMP"
  bool quiet = false;
};

/// The stamps of the keyframes of a loop, the earlier one first.
struct LoopStamps {
  int64_t earlier_ns = 0, later_ns = 0;

  bool operator==(const LoopStamps&) const = default;
};

LoopStamps stamps_of(const LoopClosure& loop, const MapData& map) {
  const auto [earlier_ns, later_ns] =
      std::minmax(map.keyframes[loop.a.value].stamp_ns, map.keyframes[loop.b.value].stamp_ns);
  return {earlier_ns, later_ns};
}

LoopStamps parse_stamps(const std::string& text) {
  const size_t comma = text.find(',');
  const auto a_ns = parse_stamp_ns(text.substr(0, comma));
  const auto b_ns = comma == std::string::npos ? std::nullopt : parse_stamp_ns(text.substr(comma + 1));
  if (!a_ns || !b_ns)
    throw UsageError(fmt::format("--loop {}: expected the stamps of two keyframes, as 12.3,45.6", text));
  return {std::min(*a_ns, *b_ns), std::max(*a_ns, *b_ns)};
}

/// Those loops whose ends are nearest in time, as arguments of --loop.
std::string nearest_to(const LoopStamps& wanted, const MapData& map) {
  constexpr size_t kListed = 3;
  std::vector<LoopStamps> all;
  for (const LoopClosure& loop : map.loop_closures) all.push_back(stamps_of(loop, map));
  const auto distance_s = [&](const LoopStamps& stamps) {
    return std::abs(to_seconds(stamps.earlier_ns) - to_seconds(wanted.earlier_ns)) +
           std::abs(to_seconds(stamps.later_ns) - to_seconds(wanted.later_ns));
  };
  std::stable_sort(all.begin(), all.end(),
                   [&](const auto& a, const auto& b) { return distance_s(a) < distance_s(b); });
  std::string text;
  for (size_t i = 0; i < std::min(kListed, all.size()); ++i) {
    text += fmt::format("{}{},{}", i > 0 ? " " : "", format_stamp(all[i].earlier_ns),
                        format_stamp(all[i].later_ns));
  }
  return text;
}

/// The loops with these stamps. Throws InputError naming the nearest ones if there are none.
std::vector<LoopEnds> find_loops(const WithdrawArguments& arguments, const MapData& map) {
  const std::string file = arguments.map.string();
  if (map.loop_closures.empty()) throw InputError(fmt::format("{}: has no loops", file));
  std::set<LoopEnds> found;
  for (const std::string& text : arguments.loops) {
    const LoopStamps wanted = parse_stamps(text);
    const size_t before = found.size();
    bool named_before = false;
    for (const LoopClosure& loop : map.loop_closures) {
      if (stamps_of(loop, map) == wanted) named_before |= !found.insert(loop.ends()).second;
    }
    if (found.size() == before && !named_before) {
      throw InputError(
          fmt::format("{}: no loop joins {}; the nearest: {}", file, text, nearest_to(wanted, map)));
    }
  }
  return {found.begin(), found.end()};
}

void withdraw(const WithdrawArguments& arguments) {
  const auto path = map_file_of(arguments.map);
  require_different_file("-o", arguments.output, path);
  require_writable_file(arguments.output);
  const MapReader reader(path);
  SavedMap saved = read_map_with_warnings(reader, path);
  const std::vector<LoopEnds> loops = find_loops(arguments, saved.map);

  RunOptions options = restore_options(saved, path);
  options.slam.global_ba.threads = hardware_threads();
  options.slam.localize_only = false;
  const RgbdCamera camera = saved.camera;
  const Sensor sensor = sensor_estimate(saved.sensor, make_sensor(camera, options.slam.noise)).sensor;
  withdraw_loops(saved, loops, sensor, {options.slam.tracking, options.slam.local_map, options.slam.loop});
  Slam slam(camera, options.slam, open_vocabulary({}, options.slam.features));
  DenseRecorder recorder(camera, options.dense);
  load_images(reader, path, slam.add_map(std::move(saved)), recorder);
  slam.finish(make_progress_bar(arguments.quiet));
  MapSaver(arguments.output, {slam, recorder, options, {}}, 0).save();
  if (arguments.quiet) return;
  fmt::print(message_stream(arguments.output),
             "{} loops withdrawn, {} left; {} keyframes in {} component(s), in {}\n", loops.size(),
             slam.map().loop_closures().size(), slam.map().keyframes().size(),
             components_of(slam.map().keyframes()), arguments.output.string());
}

}  // namespace

void add_map_withdraw_command(CLI::App& map) {
  auto arguments = std::make_shared<WithdrawArguments>();
  CLI::App* command = map.add_subcommand("withdraw", "Take false loops out of a map and solve it again");
  add_map_argument(*command, arguments->map);
  command
      ->add_option("--loop", arguments->loops,
                   "the stamps of its two keyframes, s, as 'loops' in run.json lists them; may be repeated")
      ->type_name("STAMP_A,STAMP_B")
      ->required()
      ->allow_extra_args(false);
  command->add_option("-o,--output", arguments->output, "the map file to write")->required();
  add_quiet_option(*command, arguments->quiet);
  command->footer(
      "Components that only these loops joined are parted, and the landmarks that only they\n"
      "identified are split. Several loops often join the same places: name all that are\n"
      "false. 'kinloop view' shows each loop with its pictures, and this command for it.");
  command->callback([arguments] { withdraw(*arguments); });
}

}  // namespace kinloop
