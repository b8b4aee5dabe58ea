#include "tools/floor_plan/drawing/drawing.hpp"

#include <utility>

#include <fmt/format.h>

#include "kinloop/core/text/escaped.hpp"

namespace kinloop {
namespace {

std::string svg_color(const DrawingColor& color) {
  return fmt::format("#{:02x}{:02x}{:02x}", color.red, color.green, color.blue);
}

std::string svg_points(const DrawingShape& shape) {
  std::string points;
  for (const Eigen::Vector2d& p : shape.points_mm)
    points += fmt::format("{}{:.3f},{:.3f}", points.empty() ? "" : " ", p.x(), p.y());
  return points;
}

std::string svg_shape(const DrawingShape& shape) {
  constexpr double kDegrees = 57.29577951308232;
  switch (shape.kind) {
    case DrawingShape::Kind::kArea:
      return fmt::format("<polygon points=\"{}\" fill=\"{}\"/>\n", svg_points(shape), svg_color(shape.color));
    case DrawingShape::Kind::kText: {
      const Eigen::Vector2d& at = shape.points_mm.front();
      return fmt::format(
          "<text transform=\"translate({:.3f} {:.3f}) rotate({:.2f})\" font-size=\"{:.2f}\" "
          "text-anchor=\"middle\" fill=\"{}\">{}</text>\n",
          at.x(), at.y(), -shape.angle_rad * kDegrees, shape.size_mm, svg_color(shape.color),
          escaped_markup(shape.text));
    }
    default: {
      const std::string dash =
          shape.dash_mm > 0 ? fmt::format(" stroke-dasharray=\"{:.2f}\"", shape.dash_mm) : "";
      return fmt::format("<polyline points=\"{}\" fill=\"none\" stroke=\"{}\" stroke-width=\"{:.2f}\"{}/>\n",
                         svg_points(shape), svg_color(shape.color), shape.width_mm, dash);
    }
  }
}

}  // namespace

void Drawing::line(std::vector<Eigen::Vector2d> points_mm, const DrawingColor& color, double width_mm,
                   double dash_mm) {
  shapes.push_back({DrawingShape::Kind::kLine, std::move(points_mm), color, width_mm, dash_mm, {}, 0, 0});
}

void Drawing::area(std::vector<Eigen::Vector2d> points_mm, const DrawingColor& color) {
  shapes.push_back({DrawingShape::Kind::kArea, std::move(points_mm), color, 0, 0, {}, 0, 0});
}

void Drawing::text(const Eigen::Vector2d& at_mm, const std::string& text, double height_mm, double angle_rad,
                   const DrawingColor& color) {
  shapes.push_back({DrawingShape::Kind::kText, {at_mm}, color, 0, 0, text, height_mm, angle_rad});
}

std::string svg_of(const Drawing& drawing) {
  std::string svg = fmt::format(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{0:.2f}mm\" height=\"{1:.2f}mm\" "
      "viewBox=\"0 0 {0:.2f} {1:.2f}\" font-family=\"Helvetica, Arial, sans-serif\" role=\"img\">\n"
      "<title>{2}</title>\n<rect width=\"100%\" height=\"100%\" fill=\"#ffffff\"/>\n",
      drawing.size_mm.x(), drawing.size_mm.y(), escaped_markup(drawing.title));
  for (const DrawingShape& shape : drawing.shapes) svg += svg_shape(shape);
  return svg + "</svg>\n";
}

}  // namespace kinloop
