#include "kinloop/eval/report_plots.hpp"

#include <Eigen/Eigenvalues>
#include <fmt/format.h>

#include "kinloop/base/time.hpp"
#include "kinloop/eval/svg_plot.hpp"
#include "kinloop/geometry/up_direction.hpp"

namespace kinloop {
namespace {

using Points = std::vector<Eigen::Vector3d>;

/// Rows: along the path's longest level extent, across it, up.
Eigen::Matrix3d plot_axes(const Trajectory& path) {
  const Eigen::Vector3d up = up_direction(path);
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (const auto& pose : path) mean += pose.T_world_camera.translation / static_cast<double>(path.size());
  Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
  for (const auto& pose : path) {
    Eigen::Vector3d d = pose.T_world_camera.translation - mean;
    d -= up * up.dot(d);
    spread += d * d.transpose();
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(spread);
  Eigen::Vector3d along = solver.eigenvectors().col(2);
  along -= up * up.dot(along);
  // A path without level extent has no direction of its own.
  if (along.norm() < 0.5) along = up.unitOrthogonal();
  along.normalize();
  Eigen::Matrix3d axes;
  axes << along.transpose(), up.cross(along).transpose(), up.transpose();
  return axes;
}

std::vector<Eigen::Vector2d> seen(const Points& points, int horizontal, int vertical) {
  std::vector<Eigen::Vector2d> plane;
  for (const auto& p : points) plane.emplace_back(p[horizontal], p[vertical]);
  return plane;
}

/// Positions in the axes of the plot.
Points positions(const Eigen::Matrix3d& axes, const Trajectory& trajectory, const SE3& T) {
  Points points;
  for (const auto& pose : trajectory) points.emplace_back(axes * (T * pose.T_world_camera.translation));
  return points;
}

/// Pairs of positions of the keyframes that loops join, one after the other.
Points loop_ends(const RunReport& report, const Points& keyframes) {
  const auto at = [&](const nlohmann::json& loop, const char* key) -> const Eigen::Vector3d* {
    if (!loop.contains(key) || !loop[key].is_string()) return nullptr;
    const auto stamp_ns = parse_stamp_ns(loop[key].get<std::string>());
    for (size_t i = 0; i < keyframes.size(); ++i) {
      if (report.keyframes[i].stamp_ns == stamp_ns) return &keyframes[i];
    }
    return nullptr;
  };
  Points ends;
  const auto loops = report.figures.find("loops");
  if (loops == report.figures.end() || !loops->is_array()) return ends;
  for (const auto& loop : *loops) {
    const auto *a = at(loop, "stamp_a"), *b = at(loop, "stamp_b");
    if (a != nullptr && b != nullptr) ends.insert(ends.end(), {*a, *b});
  }
  return ends;
}

}  // namespace

std::string path_section(const RunReport& report, const std::optional<AteResult>& ate) {
  if (report.estimate.empty()) return "";
  // Drawn in the estimate's own world: its up is known from how the camera was held.
  const Eigen::Matrix3d axes = plot_axes(report.estimate);
  const SE3 T_estimate_truth = ate ? ate->T_truth_estimate.inverse() : SE3();
  const Points truth = positions(axes, ate ? report.truth : Trajectory(), T_estimate_truth);
  const Points estimate = positions(axes, report.estimate, {});
  const Points keyframes = positions(axes, report.keyframes, {});
  const Points loops = loop_ends(report, keyframes);
  const auto view = [&](const char* title, int horizontal, int vertical) {
    const std::vector<PlotSeries> series = {
        {"truth", "truth", SeriesKind::kLine, seen(truth, horizontal, vertical)},
        {"estimate", "estimate", SeriesKind::kLine, seen(estimate, horizontal, vertical)},
        {"keyframe", "keyframes", SeriesKind::kDots, seen(keyframes, horizontal, vertical)},
        {"loop", "loops", SeriesKind::kStrokes, seen(loops, horizontal, vertical)}};
    return fmt::format("<figure>{}<figcaption>{}</figcaption></figure>\n",
                       svg_plot({title, "m", "m", true, false}, series), title);
  };
  return "<h2>Path</h2>\n<div class=\"pair\">" + view("From above", 0, 1) + view("From the side", 0, 2) +
         "</div>";
}

std::string error_section(const AteResult& ate) {
  constexpr double kMmPerM = 1000;
  PlotSeries error{"error", "", SeriesKind::kLine, {}};
  std::vector<double> errors_mm;
  for (const PoseError& pose : ate.poses) {
    errors_mm.push_back(kMmPerM * pose.error_m);
    error.points.emplace_back(to_seconds(pose.stamp_ns - ate.poses.front().stamp_ns), errors_mm.back());
  }
  const double end_s = error.points.back().x(), rmse_mm = kMmPerM * ate.error_m.rmse;
  const PlotSeries level{"level", "rmse", SeriesKind::kLine, {{0, rmse_mm}, {end_s, rmse_mm}}};
  return fmt::format(
      "<h2>Error</h2>\n<div class=\"pair\"><figure>{}<figcaption>Distance from the truth over "
      "time</figcaption>"
      "</figure>\n<figure>{}<figcaption>How often which distance: median {:.1f} mm, mean {:.1f} mm, rmse "
      "{:.1f} mm, at "
      "most {:.1f} mm, {} poses</figcaption></figure></div>",
      svg_plot({"Distance from the truth over time", "s", "mm", false, true}, std::vector{error, level}),
      svg_histogram({"Histogram of the distance from the truth", "mm", "poses", false, true}, errors_mm),
      kMmPerM * ate.error_m.median, kMmPerM * ate.error_m.mean, rmse_mm, kMmPerM * ate.error_m.max,
      ate.error_m.count);
}

}  // namespace kinloop
