#include "viewer/report/report.hpp"

#include <set>

#include <Eigen/Eigenvalues>

#include "kinloop/core/errors.hpp"
#include "kinloop/core/files/embedded_file.hpp"
#include "kinloop/core/text/base64.hpp"
#include "kinloop/core/text/json.hpp"
#include "kinloop/core/text/rounded_number.hpp"
#include "kinloop/core/time.hpp"
#include "tools/evaluation/evaluate.hpp"
#include "viewer/report/html_page.hpp"
#include "viewer/report/run_up_direction.hpp"
#include "viewer/saved/saved_loops.hpp"

KINLOOP_EMBED_FILE(embedded_report_page, KINLOOP_PAGE)

namespace kinloop {
namespace {

using nlohmann::json;

/// Rows: the direction of largest horizontal extent, across it, up.
Eigen::Matrix3d plot_axes(const Trajectory& path, const Eigen::Vector3d& up) {
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
  // A path without horizontal extent has no direction of its own.
  if (along.norm() < 0.5) along = up.unitOrthogonal();
  along.normalize();
  Eigen::Matrix3d axes;
  axes << along.transpose(), up.cross(along).transpose(), up.transpose();
  return axes;
}

/// Columns t (seconds since `start_ns`), x, y, z of positions in plot axes.
json path_json(const Trajectory& path, const SE3& T_plot_world, int64_t start_ns) {
  json columns = {{"t", json::array()}, {"x", json::array()}, {"y", json::array()}, {"z", json::array()}};
  for (const StampedPose& pose : path) {
    const Eigen::Vector3d p = T_plot_world * pose.T_world_camera.translation;
    columns["t"].push_back(rounded_number(to_seconds(pose.stamp_ns - start_ns)));
    columns["x"].push_back(rounded_number(p.x()));
    columns["y"].push_back(rounded_number(p.y()));
    columns["z"].push_back(rounded_number(p.z()));
  }
  return columns;
}

json errors_json(const AteResult& ate, int64_t start_ns) {
  constexpr double kMmPerM = 1000;
  json columns = {{"t", json::array()}, {"mm", json::array()}};
  for (const PoseError& pose : ate.poses) {
    columns["t"].push_back(rounded_number(to_seconds(pose.stamp_ns - start_ns)));
    columns["mm"].push_back(rounded_number(kMmPerM * pose.error_m));
  }
  return columns;
}

json frames_json(const FrameTable& frames, int64_t start_ns) {
  json columns = {{"t", json::array()},
                  {"status", json::array()},
                  {"features", json::array()},
                  {"tracked", json::array()},
                  {"ms", json::array()}};
  for (const FrameRow& row : frames) {
    columns["t"].push_back(rounded_number(to_seconds(row.stamp_ns - start_ns)));
    columns["status"].push_back(row.status);
    columns["features"].push_back(row.features);
    columns["tracked"].push_back(row.tracked);
    columns["ms"].push_back(rounded_number(row.ms));
  }
  return columns;
}

/// Pairs of keyframe indices of accepted loops.
json loops_json(const RunReport& run) {
  json pairs = json::array();
  for (const auto& [a, b] : accepted_pairs(loops_of(run.metrics, run.keyframes)))
    pairs.push_back({a.value, b.value});
  return pairs;
}

json images_json(const std::vector<ReportImage>& pictures) {
  json list = json::array();
  for (const auto& [caption, jpeg] : pictures) list.push_back({{"caption", caption}, {"jpeg", base64(jpeg)}});
  return list;
}

/// The last `count` components of a path.
std::string last_components(std::string_view path, size_t count) {
  while (path.size() > 1 && path.ends_with('/')) path.remove_suffix(1);
  size_t from = path.size();
  for (size_t i = 0; i < count && from != std::string_view::npos && from > 0; ++i)
    from = path.rfind('/', from - 1);
  const bool whole = from == std::string_view::npos || path.empty() || path == "/";
  return std::string(whole ? path : path.substr(from + 1));
}

/// `T_plot_world` for a run without ground truth, `T_plot_truth` for the others, so that all are aligned.
json run_json(const RunReport& run, const SE3& T_plot_world, const SE3& T_plot_truth) {
  const auto evaluation = evaluate(run.estimate, run.truth);
  const int64_t start_ns = start_stamp_ns(run);
  const SE3 T_plot_estimate = evaluation ? T_plot_truth * evaluation->ate.T_truth_estimate : T_plot_world;
  json data = {{"name", run.name},
               {"figures", run.metrics.is_object() ? run.metrics : json::object()},
               {"path", path_json(run.estimate, T_plot_estimate, start_ns)},
               {"keyframes", path_json(run.keyframes, T_plot_estimate, start_ns)},
               {"loops", loops_json(run)},
               {"startS", to_seconds(start_ns)},
               {"live", path_json(run.live, T_plot_estimate, start_ns)},
               {"frames", frames_json(run.frames, start_ns)},
               {"mapPictures", images_json(run.map_images)},
               {"loopPictures", images_json(run.loop_images)},
               {"cloud", base64(run.cloud)}};
  data["figures"].erase("keyframe_covariances");  // large, and not shown
  const Eigen::Vector3d up = read_up_direction(run.metrics, run.estimate);
  data["up"] = {up.x(), up.y(), up.z()};
  if (evaluation) {
    data["truth"] = path_json(run.truth, T_plot_truth, start_ns);
    data["errors"] = errors_json(evaluation->ate, start_ns);
    data["evaluation"] = to_json(*evaluation);
    if (const auto live = absolute_trajectory_error(run.live, run.truth))
      data["liveErrors"] = errors_json(*live, start_ns);
  }
  return data;
}

}  // namespace

int64_t start_stamp_ns(const RunReport& run) {
  if (!run.frames.empty()) return run.frames.front().stamp_ns;
  return run.estimate.empty() ? 0 : run.estimate.front().stamp_ns;
}

std::string input_name(std::string_view input) {
  return last_components(input, 1);
}

std::string run_name(const json& figures, const std::filesystem::path& path) {
  const auto input = figures.find("input");
  if (input == figures.end() || !input->is_string())
    return input_name(std::filesystem::absolute(path).string());
  return input_name(input->get<std::string>());
}

std::vector<std::string> unique_short_names(std::span<const std::string> paths) {
  constexpr size_t kMaxCount = 20;  // a path given twice stays ambiguous
  std::vector<std::string> names;
  for (size_t count = 1; count <= kMaxCount; ++count) {
    names.clear();
    for (const std::string& path : paths) names.push_back(last_components(path, count));
    if (std::set<std::string>(names.begin(), names.end()).size() == paths.size()) break;
  }
  return names;
}

json report_data(std::span<const RunReport> runs) {
  json data = {{"runs", json::array()}};
  if (runs.empty()) return data;
  // Drawn in the first estimate's world, whose up direction is known.
  const RunReport& first = runs.front();
  const SE3 T_plot_world{
      Eigen::Quaterniond(plot_axes(first.estimate, read_up_direction(first.metrics, first.estimate))),
      Eigen::Vector3d::Zero()};
  const auto ate = absolute_trajectory_error(first.estimate, first.truth);
  const SE3 T_plot_truth = ate ? T_plot_world * ate->T_truth_estimate.inverse() : T_plot_world;
  for (size_t i = 0; i < runs.size(); ++i) {
    data["runs"].push_back(run_json(runs[i], T_plot_world, T_plot_truth));
    if (i > 0) {
      data["runs"].back()["cloud"] = "";
      data["runs"].back()["mapPictures"] = data["runs"].back()["loopPictures"] = json::array();
    }
  }
  return data;
}

std::string render_report(std::span<const RunReport> runs) {
  constexpr std::string_view kSlot = "{\"runs\":[]}";
  std::string text = json_text(report_data(runs), -1, JsonCharacters::kAscii);
  // "</script>" in a name would end the element that holds the data.
  for (size_t at = text.find('<'); at != std::string::npos; at = text.find('<', at))
    text.replace(at, 1, "\\u003c");
  std::string page(embedded_report_page());
  const size_t slot = page.find(kSlot);
  require(slot != std::string::npos, "render_report: the page has no placeholder for its data");
  return page.replace(slot, kSlot.size(), text);
}

}  // namespace kinloop
