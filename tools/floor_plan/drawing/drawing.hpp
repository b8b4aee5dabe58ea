#pragma once
// In: shapes on a sheet of paper. Out: files that show them.

#include <string>
#include <vector>

#include <Eigen/Core>

namespace kinloop {

/// Red, green, blue, 0 to 255.
struct DrawingColor {
  int red = 0, green = 0, blue = 0;
};

/// Lines through points, filled if closed and `filled`, or text.
struct DrawingShape {
  enum class Kind { kLine, kArea, kText };
  Kind kind = Kind::kLine;
  std::vector<Eigen::Vector2d> points_mm;  ///< x right, y down; of text the middle of its base line
  DrawingColor color;
  double width_mm = 0.25;  ///< of lines
  double dash_mm = 0;      ///< length of dashes and gaps, 0 = solid
  std::string text;        ///< UTF-8 with letters of Latin-1
  double size_mm = 3;      ///< of text: the height of its line
  double angle_rad = 0;    ///< of text: counterclockwise
};

/// A sheet; later shapes cover earlier ones.
struct Drawing {
  Eigen::Vector2d size_mm = {210, 297};
  std::string title;
  std::vector<DrawingShape> shapes;

  void line(std::vector<Eigen::Vector2d> points_mm, const DrawingColor& color, double width_mm,
            double dash_mm = 0);
  void area(std::vector<Eigen::Vector2d> points_mm, const DrawingColor& color);
  void text(const Eigen::Vector2d& at_mm, const std::string& text, double height_mm, double angle_rad = 0,
            const DrawingColor& color = {});
};

/// Returns the content of an SVG file whose size is that of the sheet.
std::string svg_of(const Drawing& drawing);

/// Returns the content of a PDF file of one page.
std::string pdf_of(const Drawing& drawing);

/// Returns the content of a PNG file with so many dots per inch.
std::string png_of(const Drawing& drawing, double dpi);

}  // namespace kinloop
