#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "apps/reproduce/chapters.hpp"
#include "kinloop/core/files/text_file.hpp"
#include "kinloop/geometry/trajectory.hpp"
#include "kinloop/io/run_folder.hpp"
#include "tools/evaluation/evaluate.hpp"

namespace kinloop {
namespace {

/// A trajectory and how it is drawn.
struct DrawnPath {
  std::string name;
  std::string color;  ///< as in CSS
  Trajectory path;    ///< T_world_camera; all in one frame
};

constexpr double kPictureWidth = 720, kPictureHeight = 480, kPictureMargin = 40;

Eigen::AlignedBox3d extent_of(const std::vector<DrawnPath>& paths) {
  Eigen::AlignedBox3d box;
  for (const DrawnPath& drawn : paths) {
    for (const auto& pose : drawn.path) box.extend(pose.T_world_camera.translation);
  }
  return box;
}

/// The axes of the two largest extents, the larger first.
std::array<int, 2> drawn_axes(const Eigen::AlignedBox3d& box) {
  std::array<int, 3> axes{0, 1, 2};
  const Eigen::Vector3d size = box.sizes();
  std::stable_sort(axes.begin(), axes.end(), [&](int a, int b) { return size[a] > size[b]; });
  return {axes[0], axes[1]};
}

std::string points_of(const Trajectory& path, const std::array<int, 2>& axes, const Eigen::Vector3d& low,
                      double scale) {
  std::string points;
  for (const auto& pose : path) {
    const Eigen::Vector3d p = scale * (pose.T_world_camera.translation - low);
    points += fmt::format("{:.1f},{:.1f} ", kPictureMargin + p[axes[0]], kPictureMargin + p[axes[1]]);
  }
  return points;
}

/// Returns the picture: the two axes in which the first path extends most, a scale bar and the names.
std::string trajectory_picture(const std::vector<DrawnPath>& paths) {
  const Eigen::AlignedBox3d box = extent_of(paths);
  const auto axes = drawn_axes(box);
  const Eigen::Vector3d size = box.sizes().cwiseMax(0.01);
  const double scale = std::min((kPictureWidth - 2 * kPictureMargin) / size[axes[0]],
                                (kPictureHeight - 3 * kPictureMargin) / size[axes[1]]);
  std::string svg = fmt::format(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {0} {1}\" font-family=\"sans-serif\" "
      "font-size=\"15\"><rect width=\"{0}\" height=\"{1}\" fill=\"#fff\"/>\n",
      kPictureWidth, kPictureHeight);
  double name_x = kPictureMargin;
  for (const DrawnPath& drawn : paths) {
    svg += fmt::format("<polyline points=\"{}\" fill=\"none\" stroke=\"{}\" stroke-width=\"2\"/>\n",
                       points_of(drawn.path, axes, box.min(), scale), drawn.color);
    svg += fmt::format("<text x=\"{}\" y=\"{}\" fill=\"{}\">{}</text>\n", name_x, kPictureHeight - 12,
                       drawn.color, drawn.name);
    name_x += 40 + 8.5 * static_cast<double>(drawn.name.size());
  }
  const double bar_m = std::pow(10.0, std::floor(std::log10(size[axes[0]])));
  svg += fmt::format(
      "<path d=\"M{0:.1f} {2}H{1:.1f}\" stroke=\"#333\" stroke-width=\"3\"/><text x=\"{0:.1f}\" y=\"{3}\" "
      "fill=\"#333\">{4} m</text>\n",
      kPictureWidth - kPictureMargin - scale * bar_m, kPictureWidth - kPictureMargin, kPictureHeight - 34,
      kPictureHeight - 12, bar_m);
  return svg + "</svg>\n";
}

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
