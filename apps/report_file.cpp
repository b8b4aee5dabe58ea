#include "apps/report_file.hpp"

#include <algorithm>
#include <limits>
#include <string>

#include <fmt/format.h>
#include <opencv2/imgcodecs.hpp>

#include "kinloop/base/errors.hpp"
#include "kinloop/base/text_file.hpp"
#include "kinloop/dense/cloud_picture.hpp"
#include "kinloop/eval/report.hpp"
#include "kinloop/geometry/up_direction.hpp"
#include "kinloop/output/ply.hpp"
#include "viewer/scene/growing_cloud.hpp"

namespace kinloop {
namespace {

namespace fs = std::filesystem;

constexpr size_t kMostCloudPoints = 100000;  // 1.6 MB of the page
constexpr int kJpegQuality = 85;

Trajectory read_if_there(const fs::path& path) {
  return fs::exists(path) ? read_tum_trajectory(path) : Trajectory();
}

/// One looks into a room past its ceiling: points higher than the camera ever was, by an arm's length, are
/// cut off.
double highest_shown_m(const Trajectory& path, const Eigen::Vector3d& up) {
  constexpr double kCutAboveCameraM = 0.3;
  if (path.empty()) return std::numeric_limits<double>::infinity();
  double highest_m = -std::numeric_limits<double>::infinity();
  for (const auto& pose : path) highest_m = std::max(highest_m, up.dot(pose.T_world_camera.translation));
  return highest_m + kCutAboveCameraM;
}

CloudView view_of(const Trajectory& path, const nlohmann::json& figures) {
  CloudView view;
  view.up = up_direction(path);
  view.cut_above_m = highest_shown_m(path, view.up);
  const nlohmann::json::json_pointer voxel("/map/voxel_m");
  if (figures.contains(voxel) && figures[voxel].is_number() && figures[voxel] > 0)
    view.point_m = figures[voxel];
  return view;
}

/// The picture on white, since it is printed too.
ReportPicture picture_of(const ColoredCloud& cloud, const CloudView& view, const char* caption) {
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
  std::vector<uint8_t> bytes;
  cv::imencode(".jpg", page, bytes, {cv::IMWRITE_JPEG_QUALITY, kJpegQuality});
  return {caption, {bytes.begin(), bytes.end()}};
}

/// An even choice of the points below the cut, in the order in which the page draws them.
std::string decimated(const ColoredCloud& cloud, const CloudView& view) {
  CloudPiece piece;
  const ColoredCloud mixed = shuffled(cloud);
  const Eigen::Vector3f up = view.up.cast<float>();
  for (size_t i = 0; i < mixed.size() && piece.cloud.size() < kMostCloudPoints; ++i) {
    if (up.dot(mixed.points[i]) > view.cut_above_m) continue;
    piece.cloud.points.push_back(mixed.points[i]);
    piece.cloud.colors.push_back(mixed.colors[i]);
  }
  const Bytes bytes = encode_cloud(piece);
  return {bytes.begin(), bytes.end()};
}

void add_map(RunReport& run, const fs::path& map) {
  if (!fs::exists(map)) return;
  constexpr double kFromAboveDeg = 90;
  const ColoredCloud cloud = read_ply(map);
  if (cloud.size() == 0) return;
  CloudView view = view_of(run.estimate, run.figures);
  run.cloud = decimated(cloud, view);
  run.map_pictures.push_back(
      picture_of(cloud, view, "At a slant; what is higher than the camera is cut off"));
  view.elevation_deg = kFromAboveDeg;
  run.map_pictures.push_back(picture_of(cloud, view, "From above"));
}

std::vector<ReportPicture> read_loop_pictures(const fs::path& folder) {
  std::vector<fs::path> files;
  if (fs::is_directory(folder)) {
    for (const auto& entry : fs::directory_iterator(folder)) files.push_back(entry.path());
  }
  std::sort(files.begin(), files.end());
  std::vector<ReportPicture> pictures;
  for (const fs::path& file : files) {
    const std::string name = file.stem().string();
    const size_t between = name.find('_');
    if (file.extension() != ".jpg" || between == std::string::npos) continue;
    pictures.push_back({fmt::format("seen at {} s, met again at {} s; matches that agree",
                                    name.substr(0, between), name.substr(between + 1)),
                        read_file(file)});
  }
  return pictures;
}

RunReport read_run(const RunFolder& folder) {
  if (!fs::exists(folder.figures())) {
    throw InputError(fmt::format("{}: has no run.json; give the folder that kinloop run -o wrote",
                                 folder.path().string()));
  }
  RunReport run;
  run.figures = read_figures(folder.figures());
  run.name = run.figures.value("input", folder.path().string());
  run.estimate = read_tum_trajectory(folder.trajectory());
  run.keyframes = read_if_there(folder.keyframes());
  run.truth = read_if_there(folder.ground_truth());
  if (fs::exists(folder.frames())) run.frames = read_frame_table(folder.frames());
  return run;
}

/// What is large, and shown of the first run only.
void add_pictures(RunReport& run, const RunFolder& folder) {
  add_map(run, folder.map());
  run.loop_pictures = read_loop_pictures(folder.loop_pictures());
}

}  // namespace

void write_report(const RunFolder& folder) {
  RunReport run = read_run(folder);
  add_pictures(run, folder);
  write_file(folder.report(), render_report({&run, 1}));
}

void write_comparison(const std::vector<fs::path>& paths, const fs::path& page) {
  std::vector<RunReport> runs;
  for (const fs::path& path : paths) {
    if (fs::is_directory(path)) {
      const auto folder = RunFolder::of_earlier_run(path);
      runs.push_back(read_run(folder));
      if (runs.size() == 1) add_pictures(runs.front(), folder);
    } else {
      runs.emplace_back().estimate = read_tum_trajectory(path);
    }
    runs.back().name = path.string();
  }
  const auto known =
      std::find_if(runs.begin(), runs.end(), [](const RunReport& run) { return !run.truth.empty(); });
  for (RunReport& run : runs) {
    if (run.truth.empty() && known != runs.end()) run.truth = known->truth;
  }
  write_file(page, render_report(runs));
}

}  // namespace kinloop
