#include <algorithm>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "apps/map/map_commands.hpp"
#include "apps/shared/command_line/common_options.hpp"
#include "kinloop/core/errors.hpp"
#include "kinloop/core/files/byte_reader.hpp"
#include "kinloop/core/log.hpp"
#include "kinloop/core/quantile.hpp"
#include "kinloop/core/threads/parallel_for.hpp"
#include "kinloop/core/time.hpp"
#include "session/plan/run_plan.hpp"
#include "session/store/map_store.hpp"

namespace kinloop {
namespace {

struct LocateArguments {
  std::string sequence, chosen;
  std::vector<std::filesystem::path> maps;
  CameraOptions camera;
  std::string vocabulary;
  std::vector<std::string> assignments;
  bool quiet = false;
};

/// A map of the library: its keyframes are those before `end`, and from that of the map before on.
struct LoadedMap {
  std::filesystem::path file;
  KeyframeId end;
};

/// The rooms that frames are looked up in.
struct Library {
  std::unique_ptr<Slam> slam;
  std::vector<LoadedMap> maps;

  [[nodiscard]] const std::filesystem::path& file_of(KeyframeId keyframe) const {
    return std::upper_bound(maps.begin(), maps.end(), keyframe,
                            [](KeyframeId id, const LoadedMap& map) { return id < map.end; })
        ->file;
  }
};

/// Loads the maps as components of one, but for those of another camera, which are named. Throws InputError
/// if none is left.
Library open_library(const LocateArguments& arguments, const RgbdCamera& camera) {
  Library library;
  for (const auto& given : arguments.maps) {
    const std::filesystem::path file = map_file_of(given);
    const MapReader reader(file);
    SavedMap saved = read_map_with_warnings(reader, file);
    if (const std::string other = other_camera(saved, file, camera); !other.empty()) {
      log::warn("{}; it is skipped, specify its camera with --camera if it is that of the sequence", other);
      continue;
    }
    if (!library.slam) {
      RunOptions options = restore_options(saved, file);
      options.slam.localize_only = true;
      options = run_options_with(options, arguments.assignments);
      library.slam = std::make_unique<Slam>(camera, options.slam,
                                            open_vocabulary(arguments.vocabulary, options.slam.features));
    }
    library.slam->add_map(std::move(saved));
    library.maps.push_back({file, KeyframeId{static_cast<uint32_t>(library.slam->map().keyframes().size())}});
  }
  if (!library.slam)
    throw InputError(fmt::format("{}: no map is of this camera; see the warnings", arguments.sequence));
  return library;
}

/// The line of a frame: its stamp, position [m], orientation (x, y, z, w) and map.
std::string line_of(const LoggedFrame& frame, const Library& library) {
  if (frame.is_lost() || frame.is_doubtful())
    return fmt::format("{} unknown\n", format_stamp(frame.stamp_ns));
  const SE3 T_map_camera = frame.world(library.slam->map());
  const Eigen::Vector3d& p = T_map_camera.translation;
  const Eigen::Quaterniond& q = T_map_camera.rotation;
  return fmt::format("{} {:.6f} {:.6f} {:.6f} {:.6f} {:.6f} {:.6f} {:.6f} {}\n", format_stamp(frame.stamp_ns),
                     p.x(), p.y(), p.z(), q.x(), q.y(), q.z(), q.w(),
                     printable(library.file_of(frame.reference).string()));
}

void locate(const LocateArguments& arguments) {
  SourceRequest request;
  request.sequence = arguments.sequence;
  request.chosen = arguments.chosen;
  request.threads = hardware_threads();
  set_camera(request, arguments.camera);
  const auto source = open_frame_source(request);
  const Library library = open_library(arguments, source->camera());
  Slam& slam = *library.slam;
  while (const auto frame = source->next()) slam.process(*frame);
  fmt::print("# stamp [s], position [m], orientation (x, y, z, w), map\n");
  size_t located = 0;
  for (const LoggedFrame& frame : slam.session_log()) {
    fmt::print("{}", line_of(frame, library));
    if (!frame.is_lost() && !frame.is_doubtful()) ++located;
  }
  const std::vector<double>& frame_ms = slam.timings().frame_ms;
  if (arguments.quiet || frame_ms.empty()) return;
  constexpr double kMost = 0.99;
  fmt::print(
      stderr,
      "{} of {} frames located in {} map(s), {} keyframes; {:.0f} ms a frame (median), 99 % {:.0f} ms\n",
      located, slam.session_log().size(), library.maps.size(), slam.map().keyframes().size(),
      quantile(frame_ms, 0.5), quantile(frame_ms, kMost));
}

}  // namespace

void add_map_locate_command(CLI::App& map) {
  auto arguments = std::make_shared<LocateArguments>();
  CLI::App* command =
      map.add_subcommand("locate", "Say in which of several maps of one camera a sequence is, and where");
  command->add_option("SEQUENCE", arguments->sequence, "as of kinloop run; three frames of a place or more")
      ->required();
  command->add_option("MAP", arguments->maps, "map files, or folders of runs")->required();
  add_sequence_option(*command, arguments->chosen);
  add_camera_options(*command, arguments->camera);
  command->add_option("--vocabulary", arguments->vocabulary, "visual vocabulary (default: built-in)");
  add_set_option(*command, arguments->assignments);
  add_quiet_option(*command, arguments->quiet);
  command->callback([arguments] { locate(*arguments); });
}

}  // namespace kinloop
