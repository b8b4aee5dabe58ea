#include <algorithm>
#include <cmath>

#include <opencv2/imgproc.hpp>

#include "drivers/image_files/fast_encoder.hpp"
#include "tools/floor_plan/drawing/drawing.hpp"
#include "tools/floor_plan/drawing/latin1.hpp"

namespace kinloop {
namespace {

constexpr int kFraction = 4;  ///< bits of coordinates
constexpr char kSquared = '\xB2';

cv::Scalar bgr(const DrawingColor& color) {
  return cv::Scalar(color.blue, color.green, color.red);
}

/// Cuts a line into dashes as long as the gaps between them.
std::vector<std::vector<Eigen::Vector2d>> dashes_of(const std::vector<Eigen::Vector2d>& line, double dash) {
  std::vector<std::vector<Eigen::Vector2d>> dashes;
  for (size_t i = 0; i + 1 < line.size(); ++i) {
    const Eigen::Vector2d way = line[i + 1] - line[i];
    const double length = way.norm();
    for (double s = 0; s < length; s += 2 * dash)
      dashes.push_back({line[i] + way * (s / length), line[i] + way * (std::min(s + dash, length) / length)});
  }
  return dashes;
}

/// A text in white on black, and its middle on the base line.
struct TextMask {
  cv::Mat mask;
  cv::Point2d middle;
};

/// OpenCV's letters are those of ASCII alone: a raised 2 is drawn smaller.
TextMask mask_of(const std::string& latin1, double height_px) {
  constexpr int kFont = cv::FONT_HERSHEY_DUPLEX;
  constexpr double kCapitals = 0.7, kFontHeight_px = 21, kRaised = 0.65;
  const double scale = kCapitals * height_px / kFontHeight_px;
  const int thickness = std::max(1, static_cast<int>(std::lround(scale * 1.4)));
  const int margin = static_cast<int>(std::ceil(height_px));
  TextMask text;
  const auto squared = latin1.find(kSquared);
  std::string plain = latin1.substr(0, squared);
  for (char& letter : plain) {
    if (static_cast<unsigned char>(letter) >= 0x80) letter = '?';
  }
  const cv::Size size = cv::getTextSize(plain, kFont, scale, thickness, nullptr);
  const int raised = squared == std::string::npos ? 0 : static_cast<int>(std::lround(height_px * 0.45));
  text.mask = cv::Mat::zeros(3 * margin, size.width + raised + 2 * margin, CV_8UC1);
  cv::putText(text.mask, plain, {margin, 2 * margin}, kFont, scale, 255, thickness, cv::LINE_AA);
  if (raised > 0) {
    cv::putText(text.mask, "2", {margin + size.width, 2 * margin - size.height / 2}, kFont, scale * kRaised,
                255, thickness, cv::LINE_AA);
  }
  text.middle = {margin + (size.width + raised) / 2.0, 2.0 * margin};
  return text;
}

class Sheet {
 public:
  Sheet(const Eigen::Vector2d& size_mm, double dpi)
      : px_per_mm_(dpi / 25.4),
        image_(static_cast<int>(std::lround(size_mm.y() * px_per_mm_)),
               static_cast<int>(std::lround(size_mm.x() * px_per_mm_)), CV_8UC3, cv::Scalar::all(255)) {}

  void draw(const DrawingShape& shape) {
    switch (shape.kind) {
      case DrawingShape::Kind::kArea:
        cv::fillPoly(image_, std::vector<std::vector<cv::Point>>{points(shape.points_mm)}, bgr(shape.color),
                     cv::LINE_AA, kFraction);
        break;
      case DrawingShape::Kind::kText:
        draw_text(shape);
        break;
      default:
        draw_line(shape);
    }
  }

  [[nodiscard]] const cv::Mat& image() const { return image_; }

 private:
  [[nodiscard]] std::vector<cv::Point> points(const std::vector<Eigen::Vector2d>& points_mm) const {
    constexpr double kUnit = 1 << kFraction;
    std::vector<cv::Point> out;
    for (const Eigen::Vector2d& p : points_mm) {
      out.emplace_back(static_cast<int>(std::lround((p.x() * px_per_mm_ - 0.5) * kUnit)),
                       static_cast<int>(std::lround((p.y() * px_per_mm_ - 0.5) * kUnit)));
    }
    return out;
  }

  void draw_line(const DrawingShape& shape) {
    const int width = std::max(1, static_cast<int>(std::lround(shape.width_mm * px_per_mm_)));
    auto parts = shape.dash_mm > 0 ? dashes_of(shape.points_mm, shape.dash_mm)
                                   : std::vector<std::vector<Eigen::Vector2d>>{shape.points_mm};
    for (const auto& part : parts)
      cv::polylines(image_, std::vector<std::vector<cv::Point>>{points(part)}, false, bgr(shape.color), width,
                    cv::LINE_AA, kFraction);
  }

  void draw_text(const DrawingShape& shape) {
    const TextMask text = mask_of(latin1_of(shape.text), shape.size_mm * px_per_mm_);
    const double c = std::cos(shape.angle_rad), s = std::sin(shape.angle_rad);
    const Eigen::Vector2d at = shape.points_mm.front() * px_per_mm_;
    const cv::Matx23d placed(c, s, at.x() - c * text.middle.x - s * text.middle.y, -s, c,
                             at.y() + s * text.middle.x - c * text.middle.y);
    cv::Mat mask;
    cv::warpAffine(text.mask, mask, placed, image_.size(), cv::INTER_LINEAR);
    const cv::Rect box = cv::boundingRect(mask);
    for (int row = box.y; row < box.y + box.height; ++row) {
      for (int col = box.x; col < box.x + box.width; ++col) {
        const int opacity = mask.at<uint8_t>(row, col);
        auto& pixel = image_.at<cv::Vec3b>(row, col);
        const cv::Scalar color = bgr(shape.color);
        for (int k = 0; k < 3; ++k)
          pixel[k] = cv::saturate_cast<uint8_t>(pixel[k] + (color[k] - pixel[k]) * opacity / 255.0);
      }
    }
  }

  double px_per_mm_;
  cv::Mat image_;
};

}  // namespace

std::string png_of(const Drawing& drawing, double dpi) {
  Sheet sheet(drawing.size_mm, dpi);
  for (const DrawingShape& shape : drawing.shapes) sheet.draw(shape);
  return encode_png(sheet.image());
}

}  // namespace kinloop
