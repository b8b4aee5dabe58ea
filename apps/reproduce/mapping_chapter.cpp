#include <array>

#include <fmt/format.h>

#include "apps/reproduce/chapters.hpp"
#include "apps/reproduce/trajectory_picture.hpp"
#include "kinloop/core/files/text_file.hpp"
#include "kinloop/io/run_folder.hpp"
#include "tools/evaluation/evaluate.hpp"

namespace kinloop {
namespace {

/// A run, and what is different in it.
struct Variant {
  const char* name;
  const char* folder;
  const char* color;
  std::vector<std::string> words;
};

const std::array<Variant, 4>& variants() {
  static const std::array<Variant, 4> list = {
      {{"with loops", "with_loops", "#0a7f74", {}},
       {"without loops", "without_loops", "#d1495b", {"--no-loop"}},
       {"global shutter assumed", "global_shutter", "", {"--set", "self_calibration.enabled=false"}},
       {"voxels of 6 mm", "fine", "", {"--set", "dense.voxel_m=0.006"}}}};
  return list;
}

std::string metres(const nlohmann::json& run, const char* which) {
  const nlohmann::json::json_pointer value(std::string("/evaluation/ate/") + which);
  return run.contains(value) ? fmt::format("{:.4f}", run[value].get<double>()) : std::string();
}

std::vector<std::string> result_row(const char* name, const nlohmann::json& run) {
  return {name,
          fmt::format("{} of {}", run.value("tracked", 0), run.value("frames", 0)),
          std::to_string(run.value("keyframes", 0)),
          std::to_string(run["loops"].size()),
          metres(run, "rmse_m"),
          metres(run, "max_m"),
          run["map"].is_object() ? std::to_string(run["map"].value("points", 0)) : std::string(),
          fmt::format("{:.1f}", run.value("cpu_s", 0.0))};
}

/// The estimate in the frame of the truth; as it is if they cannot be aligned.
Trajectory aligned(Trajectory path, const Trajectory& truth) {
  const auto error = absolute_trajectory_error(path, truth);
  if (!error) return path;
  for (auto& pose : path) pose.T_world_camera = error->T_truth_estimate * pose.T_world_camera;
  return path;
}

/// Figs. 5 and 7: the trajectories against the truth, if the sequence has one.
void draw_trajectories(Chapter& chapter, const ReproduceFolder& folder) {
  const RunFolder first = RunFolder::open_existing(folder.at(variants()[0].folder));
  if (!std::filesystem::exists(first.ground_truth())) return;
  const Trajectory truth = read_tum_trajectory(first.ground_truth());
  std::vector<DrawnPath> paths{{"ground truth", "#333333", truth}};
  for (size_t i = 0; i < 2; ++i) {
    const Variant& variant = variants().at(i);
    const RunFolder run = RunFolder::open_existing(folder.at(variant.folder));
    paths.push_back({variant.name, variant.color, aligned(read_tum_trajectory(run.trajectory()), truth)});
  }
  write_file(folder.at("trajectories.svg"), trajectory_picture(paths));
  chapter.pictures.emplace_back("Trajectories with and without loops, and the truth", "trajectories.svg");
}

}  // namespace

Chapter mapping_chapter(const ReproduceFolder& folder) {
  Chapter chapter;
  chapter.title = "Maps and loops: Figures 5 and 7; rolling shutter";
  chapter.text =
      "The paper shows a room with and without loop closing, a map of a million points and the trajectory "
      "against "
      "the truth. Errors are the ATE in metres. The third row assumes a global shutter; the last "
      "has smaller voxels.";
  MarkdownTable table{{"", "tracked", "keyframes", "loops", "ATE, m", "largest, m", "points", "CPU s"}};
  for (const Variant& variant : variants()) {
    const std::string output = folder.at(variant.folder);
    std::vector<std::string> words{"run", folder.sequence, "-q", "-o", output};
    words.insert(words.end(), variant.words.begin(), variant.words.end());
    run_program(chapter, words);
    const auto run = nlohmann::json::parse(read_file(std::filesystem::path(output) / "run.json"));
    table.push_back(result_row(variant.name, run));
    chapter.figures[variant.name] = run;
    chapter.links.emplace_back(fmt::format("Report: {}", variant.name),
                               fmt::format("{}/report.html", variant.folder));
  }
  chapter.tables.push_back(table);
  draw_trajectories(chapter, folder);
  run_program(chapter, {"report", folder.at("with_loops"), folder.at("without_loops"), "-o",
                        folder.at("comparison.html")});
  chapter.links.emplace_back("With and without loops side by side", "comparison.html");
  return chapter;
}

}  // namespace kinloop
