#include <array>
#include <cmath>

#include <fmt/format.h>

#include "tools/floor_plan/drawing/drawing.hpp"
#include "tools/floor_plan/drawing/latin1.hpp"

namespace kinloop {
namespace {

constexpr double kPointsPerMm = 72 / 25.4;

/// Widths of Helvetica's letters from the space on, in thousandths of the size (Adobe's font metrics).
constexpr std::array<int, 95> kWidths = {
    278, 278, 355, 556, 556, 889, 667, 191, 333, 333, 389, 584, 278, 333,  278, 278, 556, 556, 556,
    556, 556, 556, 556, 556, 556, 556, 278, 278, 584, 584, 584, 556, 1015, 667, 667, 722, 722, 667,
    611, 778, 722, 278, 500, 667, 556, 833, 722, 778, 667, 778, 722, 667,  611, 722, 667, 944, 667,
    667, 611, 278, 278, 278, 469, 556, 333, 556, 556, 500, 556, 556, 278,  556, 556, 222, 222, 500,
    222, 833, 556, 556, 556, 556, 333, 500, 278, 556, 500, 722, 500, 500,  500, 334, 260, 334, 584};

/// Returns the width of a text for a size of 1.
double width_of(const std::string& latin1) {
  constexpr int kOther = 500;
  int sum = 0;
  for (const char letter : latin1) {
    const int index = static_cast<unsigned char>(letter) - ' ';
    sum +=
        index >= 0 && index < static_cast<int>(kWidths.size()) ? kWidths[static_cast<size_t>(index)] : kOther;
  }
  return sum / 1000.0;
}

std::string literal_of(const std::string& latin1) {
  std::string out;
  for (const char letter : latin1) {
    if (letter == '(' || letter == ')' || letter == '\\') out += '\\';
    out += static_cast<unsigned char>(letter) < ' ' ? ' ' : letter;
  }
  return out;
}

std::string color_of(const DrawingColor& color, const char* command) {
  constexpr double kFull = 255;
  return fmt::format("{:.3f} {:.3f} {:.3f} {} ", color.red / kFull, color.green / kFull, color.blue / kFull,
                     command);
}

/// Writes shapes in points from the lower left corner.
class PageContent {
 public:
  explicit PageContent(double height_mm) : height_mm_(height_mm) {}

  [[nodiscard]] std::string of(const DrawingShape& shape) const {
    if (shape.kind == DrawingShape::Kind::kText) return text(shape);
    std::string path;
    for (const Eigen::Vector2d& p : shape.points_mm) {
      const Eigen::Vector2d at = points(p);
      path += fmt::format("{:.3f} {:.3f} {} ", at.x(), at.y(), path.empty() ? 'm' : 'l');
    }
    if (shape.kind == DrawingShape::Kind::kArea) return color_of(shape.color, "rg") + path + "h f\n";
    const std::string dash =
        shape.dash_mm > 0 ? fmt::format("[{:.3f}] 0 d ", shape.dash_mm * kPointsPerMm) : "[] 0 d ";
    return color_of(shape.color, "RG") + fmt::format("{:.3f} w ", shape.width_mm * kPointsPerMm) + dash +
           path + "S\n";
  }

 private:
  [[nodiscard]] Eigen::Vector2d points(const Eigen::Vector2d& p_mm) const {
    return kPointsPerMm * Eigen::Vector2d(p_mm.x(), height_mm_ - p_mm.y());
  }

  [[nodiscard]] std::string text(const DrawingShape& shape) const {
    const std::string latin1 = latin1_of(shape.text);
    const double size = shape.size_mm * kPointsPerMm;
    const Eigen::Vector2d along(std::cos(shape.angle_rad), std::sin(shape.angle_rad));
    const Eigen::Vector2d begin = points(shape.points_mm.front()) - size * width_of(latin1) / 2 * along;
    return color_of(shape.color, "rg") +
           fmt::format("BT /F1 {:.3f} Tf {:.5f} {:.5f} {:.5f} {:.5f} {:.3f} {:.3f} Tm ({}) Tj ET\n", size,
                       along.x(), along.y(), -along.y(), along.x(), begin.x(), begin.y(), literal_of(latin1));
  }

  double height_mm_;
};

}  // namespace

std::string pdf_of(const Drawing& drawing) {
  const PageContent page(drawing.size_mm.y());
  std::string content = "1 J 1 j\n";
  for (const DrawingShape& shape : drawing.shapes) content += page.of(shape);
  const Eigen::Vector2d size = kPointsPerMm * drawing.size_mm;
  const std::vector<std::string> objects = {
      "<< /Type /Catalog /Pages 2 0 R >>",
      "<< /Type /Pages /Kids [3 0 R] /Count 1 >>",
      fmt::format("<< /Type /Page /Parent 2 0 R /MediaBox [0 0 {:.3f} {:.3f}] /Contents 4 0 R "
                  "/Resources << /Font << /F1 5 0 R >> >> >>",
                  size.x(), size.y()),
      fmt::format("<< /Length {} >>\nstream\n{}endstream", content.size(), content),
      "<< /Type /Font /Subtype /Type1 /BaseFont /Helvetica /Encoding /WinAnsiEncoding >>",
      fmt::format("<< /Title ({}) /Producer (kinloop) >>", literal_of(latin1_of(drawing.title)))};
  std::string pdf = "%PDF-1.4\n%\xE2\xE3\xCF\xD3\n", table = "0000000000 65535 f \n";
  for (size_t i = 0; i < objects.size(); ++i) {
    table += fmt::format("{:010} 00000 n \n", pdf.size());
    pdf += fmt::format("{} 0 obj\n{}\nendobj\n", i + 1, objects[i]);
  }
  const size_t table_at = pdf.size();
  return pdf +
         fmt::format(
             "xref\n0 {0}\n{1}trailer\n<< /Size {0} /Root 1 0 R /Info 6 0 R >>\nstartxref\n{2}\n%%EOF\n",
             objects.size() + 1, table, table_at);
}

}  // namespace kinloop
