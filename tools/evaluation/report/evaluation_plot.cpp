#include "tools/evaluation/report/evaluation_plot.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <limits>

#include <fmt/format.h>

#include "kinloop/core/text/escaped.hpp"
#include "kinloop/core/time.hpp"

namespace kinloop {
namespace {

using Points = std::vector<Eigen::Vector2d>;

// Colours that the colour blind can tell apart (Wong, Nature Methods 8, 2011).
constexpr std::array kColors = {"#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9"};
constexpr double kWidth = 1080, kHeight = 440;

/// Bounds of what is drawn.
struct Bounds {
  Eigen::Vector2d low = Eigen::Vector2d::Constant(std::numeric_limits<double>::max());
  Eigen::Vector2d high = -low;

  void add(const Points& points) {
    for (const Eigen::Vector2d& point : points) {
      low = low.cwiseMin(point);
      high = high.cwiseMax(point);
    }
  }

  [[nodiscard]] Eigen::Vector2d size() const { return (high - low).cwiseMax(1e-9); }
};

/// An area of the picture with axes.
struct Panel {
  double left, top, width, height;  ///< px
  Bounds bounds;
  const char* x_label;
  const char* y_label;

  [[nodiscard]] double x(double value) const {
    return left + width * (value - bounds.low.x()) / bounds.size().x();
  }
  [[nodiscard]] double y(double value) const {
    return top + height * (1 - (value - bounds.low.y()) / bounds.size().y());
  }
};

/// 1, 2 or 5 times a power of ten, of which about five fit into `span`.
double tick_step(double span) {
  const double power = std::pow(10, std::floor(std::log10(span / 5)));
  for (const double factor : {1.0, 2.0, 5.0}) {
    if (factor * power >= span / 6) return factor * power;
  }
  return 10 * power;
}

std::string text_at(double x, double y, const char* anchor, const std::string& text) {
  return fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"{}\">{}</text>\n", x, y, anchor,
                     escaped_markup(text));
}

std::string line(double x1, double y1, double x2, double y2) {
  return fmt::format("<line x1=\"{:.1f}\" y1=\"{:.1f}\" x2=\"{:.1f}\" y2=\"{:.1f}\" stroke=\"#ddd\"/>\n", x1,
                     y1, x2, y2);
}

std::string axes(const Panel& panel) {
  std::string svg;
  const auto& b = panel.bounds;
  const double step_x = tick_step(b.size().x()), step_y = tick_step(b.size().y());
  for (double i = std::ceil(b.low.x() / step_x); i * step_x <= b.high.x(); ++i) {
    const double x = panel.x(i * step_x);
    svg += line(x, panel.top, x, panel.top + panel.height);
    svg += text_at(x, panel.top + panel.height + 16, "middle", fmt::format("{:.6g}", i * step_x));
  }
  for (double i = std::ceil(b.low.y() / step_y); i * step_y <= b.high.y(); ++i) {
    const double y = panel.y(i * step_y);
    svg += line(panel.left, y, panel.left + panel.width, y);
    svg += text_at(panel.left - 6, y + 4, "end", fmt::format("{:.6g}", i * step_y));
  }
  svg += text_at(panel.left + panel.width / 2, panel.top + panel.height + 36, "middle", panel.x_label);
  return svg + text_at(panel.left, panel.top - 10, "middle", panel.y_label);
}

/// Every n-th point, so that a picture has at most some thousands.
std::string polyline(const Panel& panel, const Points& points, const char* color, bool dashed) {
  constexpr size_t kMostPoints = 2000;
  const size_t step = 1 + points.size() / kMostPoints;
  std::string list;
  for (size_t i = 0; i < points.size(); i += step)
    list += fmt::format("{:.1f},{:.1f} ", panel.x(points[i].x()), panel.y(points[i].y()));
  return fmt::format("<polyline points=\"{}\" fill=\"none\" stroke=\"{}\" stroke-width=\"1.5\"{}/>\n", list,
                     color, dashed ? " stroke-dasharray=\"5 3\"" : "");
}

/// The two axes of the world along which the path extends most, in order.
std::array<Eigen::Index, 2> widest_axes(const Trajectory& path) {
  Eigen::Vector3d low = Eigen::Vector3d::Constant(std::numeric_limits<double>::max()), high = -low;
  for (const StampedPose& pose : path) {
    low = low.cwiseMin(pose.T_world_camera.translation);
    high = high.cwiseMax(pose.T_world_camera.translation);
  }
  Eigen::Index narrowest = 0;
  (high - low).minCoeff(&narrowest);
  if (narrowest == 0) return {1, 2};
  return {0, narrowest == 1 ? 2 : 1};
}

Points projected(const Trajectory& path, const Similarity& S_truth_path,
                 const std::array<Eigen::Index, 2>& axes) {
  Points points;
  for (const StampedPose& pose : path) {
    const Eigen::Vector3d position = S_truth_path.moved(pose.T_world_camera).translation;
    points.emplace_back(position[axes[0]], position[axes[1]]);
  }
  return points;
}

/// Errors of the poses, m, over time since `begin_ns`, s.
Points errors_over_time(const Evaluation& evaluation, int64_t begin_ns) {
  Points points;
  for (const PoseError& pose : evaluation.ate.poses)
    points.emplace_back(to_seconds(pose.stamp_ns + evaluation.offset_ns - begin_ns), pose.error_m);
  return points;
}

/// Widens the shorter direction, so that a metre is as long on both axes.
void make_isometric(Panel& panel) {
  const double m_per_px =
      std::max(panel.bounds.size().x() / panel.width, panel.bounds.size().y() / panel.height);
  const Eigen::Vector2d center = (panel.bounds.low + panel.bounds.high) / 2;
  const Eigen::Vector2d half = m_per_px * Eigen::Vector2d(panel.width, panel.height) / 2;
  panel.bounds.low = center - half;
  panel.bounds.high = center + half;
}

constexpr double kLegendRow = 18;

/// The names, one below the other, under the panels.
std::string legend(std::span<const PlottedEstimate> estimates) {
  std::string svg;
  double y = kHeight;
  const auto entry = [&](const std::string& name, const char* color) {
    svg += fmt::format("<rect x=\"70\" y=\"{:.1f}\" width=\"14\" height=\"4\" fill=\"{}\"/>\n", y - 6, color);
    svg += text_at(90, y, "start", name);
    y += kLegendRow;
  };
  entry("truth", "#888");
  for (size_t i = 0; i < estimates.size(); ++i)
    entry(fmt::format("{} (ATE {:.4f} m)", estimates[i].name, estimates[i].evaluation.ate.error_m.rmse),
          kColors[i % kColors.size()]);
  return svg;
}

}  // namespace

std::string evaluation_plot(std::span<const PlottedEstimate> estimates, const Trajectory& truth) {
  constexpr std::array kAxisNames = {"x, m", "y, m", "z, m"};
  const auto shown = widest_axes(truth);
  const int64_t begin_ns = truth.empty() ? 0 : truth.front().stamp_ns;
  Panel paths{70,
              40,
              420,
              340,
              {},
              kAxisNames[static_cast<size_t>(shown[0])],
              kAxisNames[static_cast<size_t>(shown[1])]};
  Panel errors{580, 40, 470, 340, {}, "time, s", "error, m"};
  const Points true_path = projected(truth, {}, shown);
  std::vector<Points> estimated, over_time;
  paths.bounds.add(true_path);
  errors.bounds.add({{0, 0}});
  for (const PlottedEstimate& plotted : estimates) {
    const AteResult& ate = plotted.evaluation.ate;
    estimated.push_back(projected(plotted.estimate, {ate.scale, ate.T_truth_estimate}, shown));
    over_time.push_back(errors_over_time(plotted.evaluation, begin_ns));
    paths.bounds.add(estimated.back());
    errors.bounds.add(over_time.back());
  }
  make_isometric(paths);

  std::string svg = fmt::format(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {0} {1}\" width=\"{0}\" height=\"{1}\" "
      "font-family=\"sans-serif\" font-size=\"12\">\n<rect width=\"100%\" height=\"100%\" fill=\"#fff\"/>\n",
      kWidth, kHeight + kLegendRow * static_cast<double>(estimates.size() + 1));
  svg += legend(estimates) + axes(paths) + axes(errors) + polyline(paths, true_path, "#888", true);
  for (size_t i = 0; i < estimates.size(); ++i) {
    svg += polyline(paths, estimated[i], kColors[i % kColors.size()], false);
    svg += polyline(errors, over_time[i], kColors[i % kColors.size()], false);
  }
  return svg + "</svg>\n";
}

}  // namespace kinloop
