#include "apps/shared/files/report_file.hpp"

#include <algorithm>
#include <limits>
#include <string>

#include <fmt/format.h>

#include "apps/run/summary/loop_pictures.hpp"
#include "dense/files/ply.hpp"
#include "kinloop/core/errors.hpp"
#include "kinloop/core/files/text_file.hpp"
#include "kinloop/core/time.hpp"
#include "kinloop/sensor/images/jpeg_codec.hpp"
#include "viewer/report/render_cloud.hpp"
#include "viewer/report/report.hpp"
#include "viewer/report/run_up_direction.hpp"
#include "viewer/scene/incremental_cloud.hpp"

namespace kinloop {
namespace {

namespace fs = std::filesystem;

constexpr size_t kMaxCloudPoints = 100000;  // 1.6 MB of the page
constexpr int kJpegQuality = 85;

Trajectory read_if_there(const fs::path& path) {
  return fs::exists(path) ? read_tum_trajectory(path) : Trajectory();
}

/// To look into rooms with a ceiling, points more than an arm's length above the highest camera position are
/// cut off.
double highest_shown_m(const Trajectory& path, const Eigen::Vector3d& up) {
  constexpr double kCutAboveCameraM = 0.3;
  if (path.empty()) return std::numeric_limits<double>::infinity();
  double highest_m = -std::numeric_limits<double>::infinity();
  for (const auto& pose : path) highest_m = std::max(highest_m, up.dot(pose.T_world_camera.translation));
  return highest_m + kCutAboveCameraM;
}

CloudPictureOptions view_of(const Trajectory& path, const nlohmann::json& figures) {
  CloudPictureOptions view;
  view.up = read_up_direction(figures, path);
  view.cut_above_m = highest_shown_m(path, view.up);
  const nlohmann::json::json_pointer voxel("/map/voxel_m");
  if (figures.contains(voxel) && figures[voxel].is_number() && figures[voxel] > 0)
    view.point_m = figures[voxel];
  return view;
}

/// The picture on white, suitable for print.
ReportImage picture_of(const ColoredCloud& cloud, const CloudPictureOptions& view, const char* caption) {
  const cv::Mat drawn = render_cloud(cloud, view);
  if (drawn.empty()) return {caption, {}};
  cv::Mat page(drawn.size(), CV_8UC3, cv::Scalar::all(255));
  for (int row = 0; row < drawn.rows; ++row) {
    for (int col = 0; col < drawn.cols; ++col) {
      const auto& from = drawn.at<cv::Vec4b>(row, col);
      auto& to = page.at<cv::Vec3b>(row, col);
      for (int k = 0; k < 3; ++k)
        to[k] = static_cast<uint8_t>((from[k] * from[3] + to[k] * (255 - from[3])) / 255);
    }
  }
  const auto bytes = encode_jpeg(page, kJpegQuality);
  return {caption, {bytes.begin(), bytes.end()}};
}

/// An evenly spaced selection of the points below the cut, in the order in which the page draws them.
std::string decimated(const ColoredCloud& cloud, const CloudPictureOptions& view) {
  CloudPiece piece;
  const ColoredCloud mixed = shuffled(cloud);
  const Eigen::Vector3f up = view.up.cast<float>();
  for (size_t i = 0; i < mixed.size() && piece.cloud.size() < kMaxCloudPoints; ++i) {
    if (up.dot(mixed.points[i]) > view.cut_above_m) continue;
    piece.cloud.points.push_back(mixed.points[i]);
    piece.cloud.colors.push_back(mixed.colors[i]);
  }
  if (piece.cloud.size() == 0) return {};
  const WireBytes bytes = encode_cloud(piece);
  return {bytes.begin(), bytes.end()};
}

void add_map(RunReport& run, const fs::path& map) {
  if (!fs::exists(map)) return;
  constexpr double kFromAboveDeg = 90;
  const ColoredCloud cloud = read_ply(map);
  if (cloud.size() == 0) return;
  CloudPictureOptions view = view_of(run.estimate, run.metrics);
  run.cloud = decimated(cloud, view);
  run.map_images.push_back(
      picture_of(cloud, view, "Oblique view; points above the highest camera position are not shown"));
  view.elevation_deg = kFromAboveDeg;
  run.map_images.push_back(picture_of(cloud, view, "Top view"));
}

/// The caption, with times since the start of the run.
std::string caption_of(const LoopPicture& picture, int64_t start_ns) {
  const auto since_start = [&](int64_t stamp_ns) { return to_seconds(stamp_ns - start_ns); };
  std::string text = fmt::format(
      "{:.1f} s (left) and {:.1f} s (right), cameras {:.2f} m and {:.1f}\u00b0 apart. {} landmarks "
      "reprojected, {} "
      "of them observed in both images",
      since_start(picture.stamp_a_ns), since_start(picture.stamp_b_ns), picture.distance_m, picture.angle_deg,
      picture.reprojected, picture.observed);
  if (picture.observed > 0) text += fmt::format(", median error {:.2f} px", picture.median_error_px);
  if (picture.observed == 0) text += ": the final map has no landmark in common around this loop";
  return text + fmt::format(". Loop closure: {} inliers.", picture.inliers);
}

void add_loops(RunReport& run, const RunFolder& folder) {
  for (const LoopPicture& picture : read_loop_pictures(folder)) {
    run.loop_images.push_back(
        {caption_of(picture, start_stamp_ns(run)), read_file(folder.loop_images() / picture.file)});
  }
}

RunReport read_run(const RunFolder& folder) {
  if (!fs::exists(folder.run_json())) {
    throw InputError(fmt::format("{}: has no run.json; specify the output folder of kinloop run -o",
                                 folder.path().string()));
  }
  RunReport run;
  run.metrics = read_run_json(folder.run_json());
  run.name = run_name(run.metrics, folder.path());
  run.estimate = read_tum_trajectory(folder.trajectory());
  run.keyframes = read_if_there(folder.keyframes());
  run.live = read_if_there(folder.live());
  run.truth = read_if_there(folder.ground_truth());
  if (fs::exists(folder.frames())) run.frames = read_frame_table(folder.frames());
  return run;
}

/// Adds the large parts, which are shown for the first run only.
void add_pictures(RunReport& run, const RunFolder& folder) {
  add_map(run, folder.map());
  add_loops(run, folder);
}

}  // namespace

void write_report(const RunFolder& folder) {
  RunReport run = read_run(folder);
  add_pictures(run, folder);
  write_file(folder.report(), render_report({&run, 1}));
}

void write_comparison(const std::vector<fs::path>& paths, const fs::path& page) {
  std::vector<RunReport> runs;
  std::vector<std::string> names;
  for (const fs::path& path : paths) {
    if (fs::is_directory(path)) {
      const auto folder = RunFolder::open_existing(path);
      runs.push_back(read_run(folder));
      if (runs.size() == 1) add_pictures(runs.front(), folder);
    } else {
      runs.emplace_back().estimate = read_tum_trajectory(path);
    }
    names.push_back(fs::absolute(path).lexically_normal().string());
  }
  names = unique_short_names(names);
  for (size_t i = 0; i < runs.size(); ++i) runs[i].name = names[i];
  const auto known =
      std::find_if(runs.begin(), runs.end(), [](const RunReport& run) { return !run.truth.empty(); });
  for (RunReport& run : runs) {
    if (run.truth.empty() && known != runs.end()) run.truth = known->truth;
  }
  write_file(page, render_report(runs));
}

}  // namespace kinloop
