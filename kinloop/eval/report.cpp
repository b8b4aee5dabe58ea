#include "kinloop/eval/report.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "kinloop/base/time.hpp"
#include "kinloop/eval/evaluate.hpp"
#include "kinloop/eval/report_page.hpp"
#include "kinloop/eval/report_plots.hpp"
#include "kinloop/eval/report_text.hpp"

namespace kinloop {
namespace {

using nlohmann::json;

/// The value at a path like "/map/points"; null where there is none.
json value_at(const json& figures, const char* pointer) {
  const json::json_pointer at(pointer);
  return figures.contains(at) ? figures.at(at) : json();
}

double number_at(const json& figures, const char* pointer) {
  const json value = value_at(figures, pointer);
  return value.is_number() ? value.get<double>() : 0;
}

std::string text_at(const json& figures, const char* pointer) {
  const json value = value_at(figures, pointer);
  return value.is_string() ? value.get<std::string>() : "";
}

std::string tile(const std::string& figure, const std::string& meaning) {
  return fmt::format("<div class=\"tile\"><b>{}</b><small>{}</small></div>\n", figure, meaning);
}

std::string tiles(const json& f) {
  std::string html;
  const double frames = number_at(f, "/frames");
  if (frames > 0) {
    html += tile(fmt::format("{:.1f} %", 100 * number_at(f, "/tracked") / frames),
                 fmt::format("tracked: {} of {} frames", with_thousands(number_at(f, "/tracked")),
                             with_thousands(frames)));
  }
  if (value_at(f, "/evaluation").is_object()) {
    html += tile(fmt::format("{:.1f} mm", 1e3 * number_at(f, "/evaluation/ate/rmse_m")), "ATE, rmse");
    html += tile(fmt::format("{:.1f} mm/s", 1e3 * number_at(f, "/evaluation/rpe_1s/translation/rmse_m")),
                 "RPE over 1 s, rmse");
    html += tile(fmt::format("{:.2f} &deg;/s", number_at(f, "/evaluation/rpe_1s/rotation/rmse_deg")),
                 "RPE over 1 s, rmse");
  }
  const auto count = [&](const char* pointer, const char* meaning) {
    if (value_at(f, pointer).is_number()) html += tile(with_thousands(number_at(f, pointer)), meaning);
  };
  count("/keyframes", "keyframes");
  if (f.contains("loops")) html += tile(std::to_string(f["loops"].size()), "loops closed");
  count("/landmarks", "landmarks");
  if (number_at(f, "/map/points") > 0) {
    html += tile(with_thousands(number_at(f, "/map/points")),
                 fmt::format("map points, voxels of {:g} mm", 1e3 * number_at(f, "/map/voxel_m")));
  }
  if (number_at(f, "/wall_s") > 0) {
    html += tile(fmt::format("{:.1f} s", number_at(f, "/wall_s")),
                 fmt::format("wall time, {:.1f} frames per second", frames / number_at(f, "/wall_s")));
  }
  if (number_at(f, "/frame_ms/median") > 0) {
    html += tile(fmt::format("{:.1f} ms", number_at(f, "/frame_ms/median")),
                 fmt::format("per frame, median; 95 %: {:.1f} ms", number_at(f, "/frame_ms/p95")));
  }
  if (number_at(f, "/peak_memory_mib") > 0) {
    html += tile(fmt::format("{:.0f} MiB", number_at(f, "/peak_memory_mib")), "memory at most");
  }
  return "<div class=\"tiles\">\n" + html + "</div>";
}

std::string picture(const std::string& png, const char* caption) {
  if (png.empty()) return "";
  return fmt::format(
      "<figure><img alt=\"{0}\" src=\"data:image/png;base64,{1}\"><figcaption>{0}</figcaption></figure>\n",
      caption, base64(png));
}

std::string loops_table(const json& figures) {
  const json loops = value_at(figures, "/loops");
  if (!loops.is_array() || loops.empty()) return "";
  std::string rows = "<tr><th>keyframe at</th><th>met again at</th><th class=\"number\">matches</th></tr>\n";
  for (const json& loop : loops) {
    rows += fmt::format("<tr><td>{} s</td><td>{} s</td><td class=\"number\">{}</td></tr>\n",
                        escape_html(text_at(loop, "/stamp_a")), escape_html(text_at(loop, "/stamp_b")),
                        with_thousands(number_at(loop, "/inliers")));
  }
  return fmt::format("<h2>Loops</h2>\n<div class=\"table\"><table>{}</table></div>", rows);
}

std::string times_table(const json& figures) {
  const json rooms = value_at(figures, "/rooms");
  const double frames = std::max(1.0, number_at(figures, "/frames"));
  if (!rooms.is_object() || rooms.empty()) return "";
  double most_s = 1e-9;
  for (const json& room : rooms) most_s = std::max(most_s, number_at(room, "/wall_s"));
  std::string rows =
      "<tr><th>room</th><th class=\"number\">ms a frame</th><th class=\"number\">s in all</th>"
      "<th class=\"number\">CPU s</th><th></th></tr>\n";
  for (const auto& [name, room] : rooms.items()) {
    const double wall_s = number_at(room, "/wall_s");
    rows += fmt::format(
        "<tr><td>{}</td><td class=\"number\">{:.2f}</td><td class=\"number\">{:.2f}</td>"
        "<td class=\"number\">{:.2f}</td><td class=\"share\"><i style=\"width:{:.1f}%\"></i></td></tr>\n",
        escape_html(name), 1e3 * wall_s / frames, wall_s, number_at(room, "/cpu_s"), 100 * wall_s / most_s);
  }
  return fmt::format("<h2>Where the time went</h2>\n<div class=\"table\"><table>{}</table></div>", rows);
}

std::string options_table(const json& figures) {
  const json options = value_at(figures, "/options");
  if (!options.is_object() || options.empty()) return "";
  std::string rows;
  for (const auto& [key, value] : options.items()) {
    const std::string text = value.is_string() ? value.get<std::string>() : value.dump();
    rows += fmt::format("<tr><td>{}</td><td>{}</td></tr>\n", escape_html(key), escape_html(text));
  }
  return fmt::format(
      "<h2>Options</h2>\n<details><summary>all {} as used</summary>\n<div "
      "class=\"table\"><table>{}</table></div>"
      "</details>",
      options.size(), rows);
}

std::string subtitle(const RunReport& report) {
  if (report.estimate.empty()) return "no frame was tracked";
  const double lasted_s = to_seconds(report.estimate.back().stamp_ns - report.estimate.front().stamp_ns);
  double path_m = 0;
  for (size_t i = 1; i < report.estimate.size(); ++i) {
    path_m +=
        (report.estimate[i].T_world_camera.translation - report.estimate[i - 1].T_world_camera.translation)
            .norm();
  }
  return fmt::format("{:.1f} s, a path of {:.2f} m", lasted_s, path_m);
}

}  // namespace

std::string render_report(const RunReport& report) {
  const json& f = report.figures;
  const auto ate = absolute_trajectory_error(report.estimate, report.truth);
  const std::string input = text_at(f, "/input");
  const std::string pictures =
      picture(report.map_picture_png, "The map at a slant; what is higher than the camera is cut off") +
      picture(report.map_top_png, "The map from above");
  const std::string version = text_at(f, "/version");
  return fill_in(
      kReportPage,
      {{"title", escape_html(input.empty() ? "A run" : input)},
       {"subtitle", subtitle(report)},
       {"tiles", tiles(f)},
       {"map", pictures.empty() ? "" : "<h2>Map</h2>\n<div class=\"pair\">" + pictures + "</div>"},
       {"path", path_section(report, ate)},
       {"errors", ate ? error_section(*ate) : ""},
       {"loops", loops_table(f)},
       {"times", times_table(f)},
       {"options", options_table(f)},
       {"versions", version.empty() ? "" : "<h2>Version</h2>\n<pre>" + escape_html(version) + "</pre>"}});
}

}  // namespace kinloop
