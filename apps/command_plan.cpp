// kinloop plan: draws the floor plan of a map.

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "apps/shared/command_line/commands.hpp"
#include "apps/shared/command_line/common_options.hpp"
#include "apps/shared/terminal/interrupt.hpp"
#include "apps/shared/terminal/progress_bar.hpp"
#include "apps/shared/terminal/standard_output.hpp"
#include "kinloop/core/errors.hpp"
#include "kinloop/core/files/text_file.hpp"
#include "kinloop/core/log.hpp"
#include "kinloop/core/text/json.hpp"
#include "kinloop/core/threads/parallel_for.hpp"
#include "session/store/command_files.hpp"
#include "session/store/map_store.hpp"
#include "tools/floor_plan/drawing/draw_plan.hpp"

namespace kinloop {
namespace {

namespace fs = std::filesystem;

struct PlanArguments {
  fs::path map, poses;
  std::vector<fs::path> outputs = {"plan.svg"};
  std::string title;
  double dpi = 200;
  std::vector<std::string> assignments;
  int threads = hardware_threads();
  bool quiet = false;
};

bool is_plan_file(const fs::path& path) {
  const std::string extension = path.extension().string();
  return extension == ".svg" || extension == ".pdf" || extension == ".png" || extension == ".json";
}

void check(const PlanArguments& arguments) {
  for (const fs::path& output : arguments.outputs) {
    if (!is_plan_file(output)) {
      throw UsageError(fmt::format("-o {}: the name must end in .svg, .pdf, .png or .json", output.string()));
    }
  }
  require_outputs({.inputs = {map_file_of(arguments.map), arguments.poses},
                   .outputs = outputs_of("-o", arguments.outputs)});
}

/// Returns the name of the folder of a run, or of a map file elsewhere.
std::string name_of(const fs::path& map) {
  std::error_code unknown;
  fs::path path = fs::weakly_canonical(fs::absolute(map), unknown);
  if (path.filename() == "map.kinmap") path = path.parent_path();
  return path.extension() == ".kinmap" ? path.stem().string() : path.filename().string();
}

FloorPlan plan_of(const PlanArguments& arguments) {
  const Progress progress = interruptible(make_progress_bar(arguments.quiet));
  OpenMap open = open_map(arguments.map, arguments.assignments, arguments.poses);
  const auto views = open.views(0);
  require_images(views.size(), arguments.map);
  const ColoredCloud cloud = open.cloud(0, arguments.threads, progress);
  throw_if_interrupted();
  const UpEstimate up = open.up(0);
  if (up.source == UpSource::kCamera)
    log::warn("the surfaces do not determine the up direction; if walls are missing, use --up X,Y,Z");
  const FileFrame frame = file_frame("z-up", up, views);
  FloorPlan plan =
      make_floor_plan({cloud, open.recorder.images(), views, open.saved.camera.color, frame.R_file_world,
                       open.options.dense.voxel_m, open.options.dense.limits},
                      progress);
  throw_if_interrupted();
  return plan;
}

std::string content_of(const fs::path& output, const FloorPlan& plan, const PlanArguments& arguments) {
  const std::string extension = output.extension().string();
  if (extension == ".json") return json_text(to_json(plan), 2) + "\n";
  const Drawing drawing = draw_plan(plan, arguments.title.empty() ? name_of(arguments.map) : arguments.title);
  if (extension == ".pdf") return pdf_of(drawing);
  return extension == ".png" ? png_of(drawing, arguments.dpi) : svg_of(drawing);
}

std::string summary_of(const FloorPlan& plan) {
  std::string text;
  for (size_t i = 0; i < plan.rooms.size(); ++i) {
    const PlanRoom& room = plan.rooms[i];
    size_t openings = 0;
    for (const PlanWall& wall : room.walls) openings += wall.openings.size();
    text += fmt::format("room {}: {:.2f} m², perimeter {:.2f} m, {} walls, {} openings\n", i + 1,
                        room.area_m2, room.perimeter_m, room.walls.size(), openings);
  }
  if (plan.ceiling_m) text += fmt::format("ceiling {:.2f} m above the floor\n", *plan.ceiling_m);
  return text;
}

void make_plan(const PlanArguments& arguments) {
  check(arguments);
  install_interrupt_handler();
  const FloorPlan plan = plan_of(arguments);
  bool to_stdout = false;
  for (const fs::path& output : arguments.outputs) {
    write_file(output, content_of(output, plan, arguments));
    to_stdout = to_stdout || is_standard_output(output);
  }
  if (!arguments.quiet) print_text(summary_of(plan), to_stdout ? stderr : stdout);
}

}  // namespace

void add_plan_command(CLI::App& app) {
  constexpr double kLeastDpi = 50, kMostDpi = 600;
  auto arguments = std::make_shared<PlanArguments>();
  CLI::App* command =
      app.add_subcommand("plan", "Draw the floor plan of a map: rooms, walls, openings, lengths and areas");
  add_map_argument(*command, arguments->map);
  command
      ->add_option("-o,--output", arguments->outputs,
                   "FILE.svg, FILE.pdf (to scale), FILE.png, or FILE.json (the numbers); may be repeated")
      ->allow_extra_args(false)
      ->default_str("plan.svg");
  command->add_option("--title", arguments->title, "title of the sheet (default: name of the run's folder)");
  command->add_option("--dpi", arguments->dpi, "dots per inch of PNG files")
      ->check(number(kLeastDpi, kMostDpi))
      ->capture_default_str();
  add_poses_option(*command, arguments->poses);
  add_up_option(*command, arguments->assignments);
  add_set_option(*command, arguments->assignments);
  add_threads_option(*command, arguments->threads);
  add_quiet_option(*command, arguments->quiet);
  command->footer(
      "Walls are upright surfaces that enclose space seen free. The plan has the axes of map.ply. Film the\n"
      "corners, and the walls above furniture.\n\n"
      "Examples:\n"
      "  kinloop plan out -o plan.pdf\n"
      "  kinloop plan out -o plan.svg -o plan.json");
  command->callback([arguments] { make_plan(*arguments); });
}

}  // namespace kinloop
