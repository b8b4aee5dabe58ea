#include "apps/report_file.hpp"

#include <algorithm>
#include <filesystem>
#include <string>

#include <opencv2/imgcodecs.hpp>

#include "kinloop/base/text_file.hpp"
#include "kinloop/dense/cloud_picture.hpp"
#include "kinloop/eval/report.hpp"
#include "kinloop/geometry/up_direction.hpp"
#include "kinloop/output/ply.hpp"

namespace kinloop {
namespace {

Trajectory read_if_there(const std::filesystem::path& path) {
  return std::filesystem::exists(path) ? read_tum_trajectory(path) : Trajectory();
}

/// Looks into a room past its ceiling: points higher than the camera ever was, by an arm's length, are cut
/// off.
CloudView view_of(const Trajectory& path, const nlohmann::json& figures) {
  constexpr double kCutAboveCameraM = 0.3;
  CloudView view;
  view.up = up_direction(path);
  double highest_m = -std::numeric_limits<double>::infinity();
  for (const auto& pose : path) highest_m = std::max(highest_m, view.up.dot(pose.T_world_camera.translation));
  if (!path.empty()) view.cut_above_m = highest_m + kCutAboveCameraM;
  const nlohmann::json::json_pointer voxel("/map/voxel_m");
  if (figures.contains(voxel) && figures[voxel].is_number() && figures[voxel] > 0)
    view.point_m = figures[voxel];
  return view;
}

std::string png_of(const cv::Mat& picture) {
  if (picture.empty()) return {};
  std::vector<uint8_t> bytes;
  cv::imencode(".png", picture, bytes);
  return {bytes.begin(), bytes.end()};
}

}  // namespace

void write_report(const RunFolder& folder) {
  RunReport report;
  report.figures = read_figures(folder.figures());
  report.estimate = read_tum_trajectory(folder.trajectory());
  report.keyframes = read_if_there(folder.keyframes());
  report.truth = read_if_there(folder.ground_truth());
  if (std::filesystem::exists(folder.map())) {
    const ColoredCloud cloud = read_ply(folder.map());
    constexpr double kFromAboveDeg = 90;
    CloudView view = view_of(report.estimate, report.figures);
    report.map_picture_png = png_of(render_cloud(cloud, view));
    view.elevation_deg = kFromAboveDeg;
    report.map_top_png = png_of(render_cloud(cloud, view));
  }
  write_file(folder.report(), render_report(report));
}

}  // namespace kinloop
