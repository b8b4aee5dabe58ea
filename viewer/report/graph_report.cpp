#include "viewer/report/graph_report.hpp"

#include <algorithm>

#include <Eigen/Eigenvalues>
#include <fmt/format.h>

#include "kinloop/core/text/escaped.hpp"
#include "viewer/report/html_page.hpp"
#include "viewer/report/svg_plot.hpp"

namespace kinloop {
namespace {

using Pairs = std::vector<std::pair<uint32_t, uint32_t>>;
using Axes = Eigen::Matrix<double, 2, 3>;

constexpr size_t kMaxStrokes = 10000;  // per kind: more are indistinguishable

/// Rows: the directions of the largest and the second largest extent; x and y if the graph lies in their
/// plane.
Axes picture_axes(const std::vector<Eigen::Vector3d>& points) {
  const bool is_flat = std::all_of(points.begin(), points.end(), [](const auto& p) { return p.z() == 0; });
  if (is_flat) return Axes::Identity();
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (const auto& p : points) mean += p / static_cast<double>(points.size());
  Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
  for (const auto& p : points) spread += (p - mean) * (p - mean).transpose();
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(spread);
  Axes axes;
  axes << eigen.eigenvectors().col(2).transpose(), eigen.eigenvectors().col(1).transpose();
  return axes;
}

/// End points of the edges, pair by pair; thinned out if there are too many.
PlotSeries edge_segments(const char* style, const char* name, const Pairs& edges, const Axes& axes,
                         const std::vector<Eigen::Vector3d>& points) {
  PlotSeries series{style, edges.empty() ? "" : name, SeriesKind::kSegments, {}};
  const size_t stride = 1 + edges.size() / kMaxStrokes;
  for (size_t i = 0; i < edges.size(); i += stride) {
    series.points.emplace_back(axes * points[edges[i].first]);
    series.points.emplace_back(axes * points[edges[i].second]);
  }
  return series;
}

std::string figure(const char* caption, const GraphReport& report, const Axes& axes,
                   const std::vector<Eigen::Vector3d>& points) {
  const PlotSeries series[] = {edge_segments("loop", "loop edges", report.loops, axes, points),
                               edge_segments("estimate", "odometry", report.steps, axes, points)};
  const PlotAxes frame{caption, "m", "m", true, false};
  return fmt::format("<figure>{}<figcaption>{}</figcaption></figure>\n", svg_plot(frame, series), caption);
}

}  // namespace

std::string render_graph_report(const GraphReport& report) {
  std::string tiles;
  for (const auto& [value, meaning] : report.tiles) {
    tiles += fmt::format("<div class=\"tile\"><b>{}</b><small>{}</small></div>\n", escaped_markup(value),
                         escaped_markup(meaning));
  }
  const Axes axes = picture_axes(report.after);
  const std::string pictures = figure("The graph before", report, axes, report.before) +
                               figure("The graph after", report, axes, report.after);
  return fill_template(kHtmlPage, {{"title", escaped_markup(report.title)},
                                   {"subtitle", escaped_markup(report.subtitle)},
                                   {"body", "<div class=\"tiles\">\n" + tiles + "</div>\n<h2>Graph</h2>\n" +
                                                "<div class=\"pair\">" + pictures + "</div>"}});
}

}  // namespace kinloop
