#pragma once
// In: series of numbers. Out: plots as SVG elements for a page whose style sheet colours the classes
// "estimate", "loop", "grid" and "axis".

#include <span>
#include <string>
#include <vector>

#include <Eigen/Core>

namespace kinloop {

/// What is drawn: a line through the points, a dot at each, or a stroke between each two.
enum class SeriesKind { kLine, kDots, kSegments };

struct PlotSeries {
  std::string style;  ///< class of the style sheet
  std::string name;   ///< in the legend; no entry when empty
  SeriesKind kind = SeriesKind::kLine;
  std::vector<Eigen::Vector2d> points;
};

struct PlotAxes {
  std::string title;  ///< for those who cannot see it
  std::string x_label, y_label;
  bool equal_axes = false;  ///< one unit is as long on both axes
  bool y_from_zero = false;
};

/// Series over one pair of axes.
std::string svg_plot(const PlotAxes& frame, std::span<const PlotSeries> series);

}  // namespace kinloop
