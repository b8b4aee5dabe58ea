// kinloop calibrate: calibrates cameras from images of a chessboard (Zhang's method).

#include <filesystem>
#include <memory>
#include <optional>

#include <fmt/format.h>

#include "apps/calibrate/calibrate_steps.hpp"
#include "apps/shared/command_line/commands.hpp"
#include "apps/shared/command_line/common_options.hpp"
#include "apps/shared/terminal/standard_output.hpp"
#include "drivers/datasets/folder_contents.hpp"
#include "drivers/image_files/image_file.hpp"
#include "kinloop/core/errors.hpp"
#include "kinloop/core/files/text_file.hpp"
#include "kinloop/core/log.hpp"
#include "kinloop/core/text/json.hpp"
#include "kinloop/sensor/camera/camera_file.hpp"
#include "session/store/command_files.hpp"

namespace kinloop {
namespace {

constexpr const char* kCalibrateFooter = R"(
DIR holds images (PNG, JPEG; 16-bit infrared too). --board counts inner corners, where four squares meet; --square is
the side of a square in metres. A ChArUco board is given by its squares, its dictionary and --marker, the side of a
marker; it may be partly out of view. For extrinsics and depth, DIR holds simultaneous images whose names differ only in
their ending: 0001_color.png (or _colour, _rgb), 0001_ir.png, 0001_depth.png.

Next to camera.yaml each command writes camera.json (all figures) and a report, camera.html; for depth
camera_depth.html.

Examples:
  kinloop calibrate intrinsics stills --board 5x7 --square 0.03 -o camera.yaml
  kinloop calibrate extrinsics pairs --color stills_color --infrared stills_ir --board 5x7 --square 0.03 -o camera.yaml
  kinloop calibrate intrinsics stills --board charuco:7x5:DICT_4X4_50 --square 0.04 --marker 0.028
  kinloop calibrate intrinsics new_folder --live kinect1 --viewer --board 5x7 --square 0.03
  kinloop calibrate depth pairs --camera camera.yaml --board 5x7 --square 0.03 -o camera.yaml)";

void write_results(const CalibrateArguments& arguments, const RgbdCamera& camera,
                   const nlohmann::json& figures, const std::string& sections, const char* page = ".html") {
  write_camera_file(arguments.output, camera);
  write_file(arguments.sibling_file(".json"), json_text(figures, 2) + "\n");
  const std::string subtitle = fmt::format("{}, board {}, squares of {} mm", arguments.folder.string(),
                                           arguments.board, 1000 * arguments.square_m);
  write_file(arguments.sibling_file(page), calibration_page("Calibration", subtitle, sections));
  print_text(fmt::format("written: {}, {}, {}\n", arguments.output.string(),
                         arguments.sibling_file(".json").string(), arguments.sibling_file(page).string()));
}

void warn_of(const LensCalibration& calibration) {
  for (const auto& warning : calibration.warnings) log::warn("{}", warning);
}

/// Captures the images first if --live is given.
void take_stills(const CalibrateArguments& arguments, StillKind kind) {
  if (arguments.live.source.empty()) return;
  capture_live_stills(arguments.live, arguments.folder, arguments.chosen_board(), kind);
}

void calibrate_intrinsics(const CalibrateArguments& arguments) {
  const CalibrationOptions options = arguments.options();
  take_stills(arguments, StillKind::kColor);
  const BoardSearch search = search_boards(list_stills(arguments.folder), arguments);
  const LensCalibration calibration = calibrate_lens(search.views, options);
  fmt::print("{}", to_text(calibration));
  warn_of(calibration);
  RgbdCamera camera;
  camera.color = calibration.camera;
  camera.depth_scale = arguments.depth_scale;
  camera.fps = arguments.fps;
  write_results(arguments, camera, to_json(calibration), lens_section("Camera", calibration));
}

void calibrate_extrinsics(const CalibrateArguments& arguments) {
  const CalibrationOptions options = arguments.options();
  take_stills(arguments, StillKind::kPairs);
  const auto pairs = find_pairs(arguments);
  const LensSource color =
      lens_source(arguments.color, arguments, [](const RgbdCamera& c) { return std::optional(c.color); });
  const LensSource infrared = lens_source(arguments.infrared, arguments, [](const RgbdCamera& c) {
    return c.depth ? c.depth : std::optional(c.color);
  });
  const RigCalibration rig = calibrate_rig(pairs, color, infrared, arguments.chosen_board(), options);
  fmt::print("{}", to_text(rig));
  for (const auto& alone : {rig.color_alone, rig.infrared_alone}) {
    if (alone) warn_of(*alone);
  }
  RgbdCamera camera;
  camera.color = rig.color;
  camera.depth = rig.infrared;
  camera.T_color_depth = rig.T_color_infrared;
  camera.depth_scale = arguments.depth_scale;
  camera.fps = arguments.fps;
  write_results(arguments, camera, to_json(rig), rig_section(rig));
}

/// Relative standard deviation of the depth camera's focal length from the camera's calibration results;
/// nullopt if these are missing.
std::optional<double> relative_focal_sigma(std::filesystem::path camera_file) {
  camera_file.replace_extension(".json");
  if (!std::filesystem::exists(camera_file)) return std::nullopt;
  const auto figures = parse_json(read_file(camera_file));
  const nlohmann::json::json_pointer fx("/infrared/fx");
  if (figures.is_discarded() || !figures.contains(fx)) return std::nullopt;
  const auto number = [&](const char* key) {
    const nlohmann::json& figure = figures[fx];
    return figure.is_object() && figure.contains(key) && figure[key].is_number() ? figure[key].get<double>()
                                                                                 : 0.0;
  };
  return number("value") > 0 ? std::optional(number("deviation") / number("value")) : std::nullopt;
}

/// The boards of all shots with depth, with poses from both cameras, which are held fixed.
std::vector<BoardDepthView> board_depth_views(const CalibrateArguments& arguments, const RgbdCamera& camera) {
  LensSource color, infrared;
  color.known = camera.color;
  infrared.known = camera.depth;
  const RigCalibration rig = calibrate_rig(find_pairs(arguments), color, infrared, arguments.chosen_board(),
                                           arguments.options(), camera.T_color_depth);
  std::vector<BoardDepthView> boards;
  for (const FittedPair& pair : rig.pairs) {
    const auto file = depth_path_of(pair.name, arguments);
    boards.push_back({pair.name, pair.T_infrared_board, read_depth_image(file, arguments.depth_scale)});
    const cv::Mat& depth_m = boards.back().depth_m;
    if (depth_m.cols != camera.depth->width || depth_m.rows != camera.depth->height) {
      throw InputError(fmt::format("{}: {} x {} pixels where the depth camera has {} x {}", file.string(),
                                   depth_m.cols, depth_m.rows, camera.depth->width, camera.depth->height));
    }
  }
  return boards;
}

void calibrate_depth(const CalibrateArguments& arguments) {
  RgbdCamera camera = read_camera_file(arguments.camera);
  if (!camera.depth) {
    throw InputError(fmt::format("{}: no 'depth' camera; create one with kinloop calibrate extrinsics",
                                 arguments.camera.string()));
  }
  const auto focal = relative_focal_sigma(arguments.camera);
  const DepthShift shift = estimate_depth_shift(board_depth_views(arguments, camera), *camera.depth,
                                                arguments.chosen_board(), focal.value_or(0));
  fmt::print("{}", to_text(shift));
  if (!focal)
    log::warn("{} has no .json file next to it: the standard deviation ignores that of the focal length",
              arguments.camera.string());
  if (std::abs(shift.shift_m) < 2 * shift.sigma_m) {
    log::warn("the depth shift is not significantly different from 0: take more images, near and far");
  }
  camera.depth_shift_m = shift.shift_m;
  camera.depth_scale = arguments.depth_scale;
  auto figures = std::filesystem::exists(arguments.sibling_file(".json"))
                     ? parse_json(read_file(arguments.sibling_file(".json")))
                     : nlohmann::json::object();
  if (!figures.is_object()) figures = nlohmann::json::object();
  figures["depth_shift"] = to_json(shift);
  write_results(arguments, camera, figures, depth_section(shift), "_depth.html");
}

/// What the command reads and writes. The camera file that `depth` extends may be the one that it writes.
CommandFiles command_files(const CalibrateArguments& arguments) {
  CommandFiles files{
      .outputs = outputs_of("-o", {arguments.output, arguments.sibling_file(".json"),
                                   arguments.sibling_file(".html"), arguments.sibling_file("_depth.html")})};
  const std::vector<std::filesystem::path> folders = {arguments.folder, arguments.color, arguments.infrared};
  for (const auto& stills : folders) {
    files.inputs.push_back(stills);
    std::error_code error;
    for (std::filesystem::directory_iterator still(stills, error), end; !error && still != end;
         still.increment(error)) {
      if (is_color_name(still->path()) || is_depth_name(still->path())) files.inputs.push_back(still->path());
    }
  }
  return files;
}

/// Throws before any work is done if one of the results could not be written, or would replace another or an
/// input.
void check_outputs(const CalibrateArguments& arguments) {
  const std::string extension = arguments.output.extension().string();
  if (extension == ".json" || extension == ".html")
    throw UsageError(
        fmt::format("-o {}: a result of that name is written beside the camera file; its name must end in "
                    ".yaml",
                    arguments.output.string()));
  require_outputs(command_files(arguments));
}

void add_common(CLI::App& command, const std::shared_ptr<CalibrateArguments>& a) {
  command.add_option("DIR", a->folder, "folder of images")->required();
  command.add_option("--board", a->board, "inner corners, columns x rows; or charuco:SQUARES:DICTIONARY")
      ->capture_default_str();
  command.add_option("--square", a->square_m, "side of a square, m")->required();
  command.add_option("--marker", a->marker_m, "side of a marker of a ChArUco board, m");
  command.add_option("-o,--output", a->output, "the camera file to write")->capture_default_str();
  command.add_option("--depth-scale", a->depth_scale, "units of the depth images per metre")
      ->capture_default_str()
      ->check(positive_number());
  command.add_option("--fps", a->fps, "frames per second of the camera")->capture_default_str();
  add_threads_option(command, a->threads, "number of threads for corner detection");
  add_set_option(command, a->assignments, "change an option, key=value");
  CalibrationOptions defaults;
  command.footer("Options for --set:\n" + options_help(option_entries(defaults)));
}

}  // namespace

void add_calibrate_command(CLI::App& app) {
  constexpr double kTumUnits = 5000, kMillimetres = 1000;
  CLI::App* command =
      app.add_subcommand("calibrate", "Calibrate cameras from images of a chessboard (Zhang's method)");
  command->require_subcommand(1);
  command->footer(kCalibrateFooter);
  const auto add = [&](const char* name, const char* help, double depth_scale, auto work) {
    auto arguments = std::make_shared<CalibrateArguments>();
    arguments->depth_scale = depth_scale;
    CLI::App* sub = command->add_subcommand(name, help);
    add_common(*sub, arguments);
    sub->callback([arguments, work] {
      check_outputs(*arguments);
      work(*arguments);
    });
    return std::pair(sub, arguments);
  };
  const auto [intrinsics, i] =
      add("intrinsics", "Calibrate one camera: focal lengths, principal point, distortion", kTumUnits,
          calibrate_intrinsics);
  add_live_options(*intrinsics, i->live);
  const auto [extrinsics, e] =
      add("extrinsics", "Calibrate the colour and the infrared camera, and the transform between them",
          kMillimetres, calibrate_extrinsics);
  add_live_options(*extrinsics, e->live);
  extrinsics->add_option("--color", e->color,
                         "more images of the colour camera, or its camera.yaml to keep fixed");
  extrinsics->add_option("--infrared", e->infrared, "the same for the infrared camera");
  const auto [depth, d] =
      add("depth", "Calibrate the constant to add to measured depth", kMillimetres, calibrate_depth);
  depth->add_option("--camera", d->camera, "camera.yaml of kinloop calibrate extrinsics")->required();
}

}  // namespace kinloop
