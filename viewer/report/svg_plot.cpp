#include "viewer/report/svg_plot.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <Eigen/Geometry>
#include <fmt/format.h>

namespace kinloop {
namespace {

// In drawing units; the page scales it.
constexpr double kWidth = 460, kHeight = 320;
constexpr double kLeft = 46, kRight = 10, kTop = 30, kBottom = 40;
constexpr double kPlotWidth = kWidth - kLeft - kRight, kPlotHeight = kHeight - kTop - kBottom;
constexpr size_t kMaxPoints = 2000;  ///< per line: more are indistinguishable

/// The visible range.
struct Window {
  Eigen::Vector2d low, high;

  [[nodiscard]] double x(double value) const {
    return kLeft + (value - low.x()) / (high.x() - low.x()) * kPlotWidth;
  }
  [[nodiscard]] double y(double value) const {
    return kTop + (high.y() - value) / (high.y() - low.y()) * kPlotHeight;
  }
};

Window window_of(const PlotAxes& frame, std::span<const PlotSeries> series) {
  constexpr double kMargin = 0.04;
  constexpr double kSmallest = 1e-6;
  Eigen::AlignedBox<double, 2> box;
  for (const auto& s : series) {
    for (const auto& p : s.points) box.extend(p);
  }
  if (box.isEmpty()) box.extend(Eigen::Vector2d(0, 0));
  Eigen::Vector2d low = box.min(), high = box.max();
  if (frame.y_from_zero) low.y() = 0;
  Eigen::Vector2d size = (high - low).cwiseMax(kSmallest * (1 + high.cwiseAbs().maxCoeff()));
  if (frame.equal_axes) {
    const double unit = std::max(size.x() / kPlotWidth, size.y() / kPlotHeight);
    size = Eigen::Vector2d(kPlotWidth, kPlotHeight) * unit;
  }
  const Eigen::Vector2d middle = (low + high) / 2;
  Window window{middle - size / 2 * (1 + kMargin), middle + size / 2 * (1 + kMargin)};
  if (frame.y_from_zero) window = {{window.low.x(), 0}, {window.high.x(), size.y() * (1 + kMargin)}};
  return window;
}

/// 1, 2 or 5 times a power of ten, giving about `count` steps over `range`.
double round_step(double range, double count) {
  const double rough = range / count;
  const double power = std::pow(10.0, std::floor(std::log10(rough)));
  for (const double factor : {1.0, 2.0, 5.0}) {
    if (factor * power >= rough) return factor * power;
  }
  return 10 * power;
}

/// Formats a tick's value with the decimals that its step needs.
std::string tick_text(double value, double step) {
  const int decimals = std::max(0, static_cast<int>(-std::floor(std::log10(step))));
  const double clean = std::abs(value) < step / 2 ? 0 : value;  // no "-0"
  return fmt::format("{:.{}f}", clean, decimals);
}

std::string grid(const PlotAxes& frame, const Window& window) {
  constexpr double kTicksX = 6, kTicksY = 5, kLabelGap = 6, kTextDrop = 4, kTickRow = 15, kNameRow = 34;
  std::string svg;
  double step_x = round_step(window.high.x() - window.low.x(), kTicksX);
  double step_y = round_step(window.high.y() - window.low.y(), kTicksY);
  if (frame.equal_axes) step_x = step_y = std::max(step_x, step_y);
  for (double v = std::ceil(window.low.x() / step_x) * step_x; v <= window.high.x(); v += step_x) {
    svg += fmt::format(R"(<path class="grid" d="M{:.1f} {}V{}"/>)", window.x(v), kTop, kHeight - kBottom);
    svg += fmt::format(R"(<text class="axis" x="{:.1f}" y="{}" text-anchor="middle">{}</text>)", window.x(v),
                       kHeight - kBottom + kTickRow, tick_text(v, step_x));
  }
  for (double v = std::ceil(window.low.y() / step_y) * step_y; v <= window.high.y(); v += step_y) {
    svg += fmt::format(R"(<path class="grid" d="M{} {:.1f}H{}"/>)", kLeft, window.y(v), kWidth - kRight);
    svg += fmt::format(R"(<text class="axis" x="{}" y="{:.1f}" text-anchor="end">{}</text>)",
                       kLeft - kLabelGap, window.y(v) + kTextDrop, tick_text(v, step_y));
  }
  svg += fmt::format(R"(<text class="axis" x="{}" y="{}" text-anchor="end">{}</text>)", kWidth - kRight,
                     kHeight - kBottom + kNameRow, frame.x_label);
  svg += fmt::format(R"(<text class="axis" x="4" y="{}">{}</text>)", kTop - 2 * kLabelGap, frame.y_label);
  return svg;
}

std::string line_path(const PlotSeries& series, const Window& window) {
  const size_t stride = std::max<size_t>(1, series.points.size() / kMaxPoints);
  std::string path;
  for (size_t i = 0; i < series.points.size(); i += stride) {
    const auto& p = series.points[i];
    path += fmt::format("{}{:.1f} {:.1f}", path.empty() ? "M" : "L", window.x(p.x()), window.y(p.y()));
  }
  return path;
}

std::string draw(const PlotSeries& series, const Window& window) {
  if (series.kind == SeriesKind::kLine) {
    return fmt::format(R"(<path class="{}" d="{}"/>)", series.style, line_path(series, window));
  }
  std::string svg;
  if (series.kind == SeriesKind::kDots) {
    for (const auto& p : series.points) {
      svg += fmt::format(R"(<circle class="{}" cx="{:.1f}" cy="{:.1f}" r="2.2"/>)", series.style,
                         window.x(p.x()), window.y(p.y()));
    }
    return svg;
  }
  for (size_t i = 0; i + 1 < series.points.size(); i += 2) {
    const auto &a = series.points[i], &b = series.points[i + 1];
    svg += fmt::format(R"(<path class="{}" d="M{:.1f} {:.1f}L{:.1f} {:.1f}"/>)", series.style,
                       window.x(a.x()), window.y(a.y()), window.x(b.x()), window.y(b.y()));
  }
  return svg;
}

/// Names from the right end of the top row leftwards, each with a sample of its line.
std::string legend(std::span<const PlotSeries> series) {
  constexpr double kPerLetter = 6.6, kMark = 16, kGap = 14, kRow = 16, kHalfLetter = 4;
  std::string svg;
  double x = kWidth - kRight;
  for (auto s = series.rbegin(); s != series.rend(); ++s) {
    if (s->name.empty() || s->points.empty()) continue;
    x -= kPerLetter * static_cast<double>(s->name.size());
    svg += fmt::format(R"(<text class="axis" x="{:.1f}" y="{}">{}</text>)", x, kRow, s->name);
    x -= kMark;
    if (s->kind == SeriesKind::kDots) {
      svg += fmt::format(R"(<circle class="{}" cx="{:.1f}" cy="{}" r="3"/>)", s->style, x + kMark / 2,
                         kRow - kHalfLetter);
    } else {
      svg +=
          fmt::format(R"(<path class="{}" d="M{:.1f} {}h{}"/>)", s->style, x, kRow - kHalfLetter, kMark - 4);
    }
    x -= kGap;
  }
  return svg;
}

std::string svg_of(const std::string& title, const std::string& content) {
  return fmt::format(R"(<svg viewBox="0 0 {} {}" role="img" aria-label="{}">{}</svg>)", kWidth, kHeight,
                     title, content);
}

}  // namespace

std::string svg_plot(const PlotAxes& frame, std::span<const PlotSeries> series) {
  const Window window = window_of(frame, series);
  std::string content = grid(frame, window);
  for (const PlotSeries& s : series) content += draw(s, window);
  return svg_of(frame.title, content + legend(series));
}

}  // namespace kinloop
