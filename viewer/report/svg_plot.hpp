#pragma once
// In: series of numbers. Out: plots as SVG elements; the page's style sheet colours the classes "estimate",
// "loop", "grid" and "axis".

#include <span>
#include <string>
#include <vector>

#include <Eigen/Core>

namespace kinloop {

/// How a series is drawn: a line through the points, a dot at each, or a segment between each two.
enum class SeriesKind { kLine, kDots, kSegments };

struct PlotSeries {
  std::string style;  ///< class in the style sheet
  std::string name;   ///< in the legend; no entry if empty
  SeriesKind kind = SeriesKind::kLine;
  std::vector<Eigen::Vector2d> points;
};

struct PlotAxes {
  std::string title;  ///< accessible description
  std::string x_label, y_label;
  bool equal_axes = false;  ///< same scale on both axes
  bool y_from_zero = false;
};

/// Draws series over one pair of axes.
std::string svg_plot(const PlotAxes& frame, std::span<const PlotSeries> series);

}  // namespace kinloop
