#include <fmt/format.h>

#include "apps/calibrate/calibrate_steps.hpp"
#include "apps/shared/terminal/progress_bar.hpp"
#include "kinloop/core/errors.hpp"
#include "kinloop/core/log.hpp"
#include "kinloop/core/options.hpp"
#include "kinloop/sensor/camera/camera_file.hpp"
#include "tools/calibration/board/charuco.hpp"

namespace kinloop {

Board CalibrateArguments::chosen_board() const {
  Board chosen = parse_board(board, square_m, marker_m);
  if (chosen.has_markers()) require_charuco(chosen);
  return chosen;
}

CalibrationOptions CalibrateArguments::options() const {
  const auto chosen = with_assignments(CalibrationOptions{}, assignments);
  check_options(chosen);
  return chosen;
}

std::filesystem::path CalibrateArguments::sibling_file(const char* ending) const {
  auto path = output;
  path.replace_extension();
  path += ending;
  return path;
}

namespace {

/// Suffixes of the images of one shot; the first one found in the folder is used.
const std::vector<std::string> kColorEndings = {"_color", "_colour", "_rgb"};
const std::vector<std::string> kInfraredEndings = {"_ir"};

/// The stem without its suffix from `endings`; nullopt if it has none.
std::optional<std::string> shot_name(const std::filesystem::path& still,
                                     const std::vector<std::string>& endings) {
  const std::string stem = still.stem().string();
  for (const std::string& ending : endings) {
    if (stem.ends_with(ending)) return stem.substr(0, stem.size() - ending.size());
  }
  return std::nullopt;
}

std::vector<std::filesystem::path> stills_of(const std::filesystem::path& folder,
                                             const std::vector<std::string>& endings) {
  std::vector<std::filesystem::path> stills;
  for (const auto& still : list_stills(folder)) {
    if (shot_name(still, endings)) stills.push_back(still);
  }
  if (stills.empty()) {
    throw InputError(fmt::format("{}: no image is named like 0001{}.png", folder.string(), endings.front()));
  }
  return stills;
}

}  // namespace

BoardSearch search_boards(const std::vector<std::filesystem::path>& stills,
                          const CalibrateArguments& arguments) {
  BoardSearch search = find_boards(stills, arguments.chosen_board(), arguments.threads, make_progress_bar());
  for (const auto& name : search.without_board) log::warn("{}: no board found", name);
  fmt::print("{} of {} images show the board\n", search.views.size(), stills.size());
  return search;
}

std::vector<PairedView> find_pairs(const CalibrateArguments& arguments) {
  const BoardSearch color = search_boards(stills_of(arguments.folder, kColorEndings), arguments);
  const BoardSearch infrared = search_boards(stills_of(arguments.folder, kInfraredEndings), arguments);
  std::vector<PairedView> pairs;
  for (const BoardView& c : color.views) {
    for (const BoardView& i : infrared.views) {
      if (shot_name(c.name, kColorEndings) == shot_name(i.name, kInfraredEndings)) pairs.push_back({c, i});
    }
  }
  return pairs;
}

std::filesystem::path depth_path_of(const std::string& pair_name, const CalibrateArguments& arguments) {
  return arguments.folder / (*shot_name(pair_name, kColorEndings) + "_depth.png");
}

LensSource lens_source(const std::string& argument, const CalibrateArguments& arguments,
                       const std::function<std::optional<PinholeCamera>(const RgbdCamera&)>& pick) {
  LensSource source;
  if (argument.empty()) return source;
  if (std::filesystem::is_directory(argument)) {
    source.stills = search_boards(list_stills(argument), arguments).views;
    return source;
  }
  source.known = pick(read_camera_file(argument));
  return source;
}

}  // namespace kinloop
