#include "simulator/paint/paint.hpp"

#include <algorithm>
#include <cmath>

#include <opencv2/imgproc.hpp>

namespace kinloop::sim {

int random_below(Random& random, int count) {
  return static_cast<int>(random.index(static_cast<uint32_t>(count)));
}

cv::Scalar hsv(double hue_deg, double saturation, double value) {
  const auto channel = [&](double shift) {
    const double k = std::fmod(shift + hue_deg / 60, 6.0);
    return 255 * value * (1 - saturation * std::clamp(std::min(k, 4 - k), 0.0, 1.0));
  };
  return {channel(1), channel(3), channel(5)};
}

cv::Scalar random_color(Random& random, double max_saturation, double min_value, double max_value) {
  const double hue = random.uniform(0, 360);
  const double saturation = random.uniform(0, max_saturation);
  return hsv(hue, saturation, random.uniform(min_value, max_value));
}

cv::Scalar random_hsv(Random& random, Range hue_deg, Range saturation, Range value, double base_hue_deg) {
  const double v = random.uniform(value.low, value.high);
  const double s = random.uniform(saturation.low, saturation.high);
  return hsv(base_hue_deg + random.uniform(hue_deg.low, hue_deg.high), s, v);
}

cv::Scalar random_hsv(Random& random, Range hue_deg, double saturation, Range value) {
  const double v = random.uniform(value.low, value.high);
  return hsv(random.uniform(hue_deg.low, hue_deg.high), saturation, v);
}

cv::Point random_point(Random& random, cv::Size size) {
  const auto x = static_cast<int>(random.index(static_cast<uint32_t>(size.width)));
  return {x, static_cast<int>(random.index(static_cast<uint32_t>(size.height)))};
}

cv::Mat fractal_noise(cv::Size size, cv::Size cells, int octaves, double gain, Random& random) {
  cv::Mat sum = cv::Mat::zeros(size, CV_32F);
  double height = 1;
  for (int octave = 0; octave < octaves;
       ++octave, height *= gain, cells = {cells.width * 2, cells.height * 2}) {
    if (cells.width > size.width || cells.height > size.height) break;
    cv::Mat grid(cells, CV_32F);
    for (auto it = grid.begin<float>(); it != grid.end<float>(); ++it) {
      *it = static_cast<float>(random.uniform(-height, height));
    }
    constexpr int kPad = 2;
    cv::Mat padded, large;
    cv::copyMakeBorder(grid, padded, kPad, kPad, kPad, kPad, cv::BORDER_WRAP);
    const int sx = (size.width + cells.width - 1) / cells.width;
    const int sy = (size.height + cells.height - 1) / cells.height;
    cv::resize(padded, large, {}, sx, sy, cv::INTER_CUBIC);
    sum += large(cv::Rect(kPad * sx, kPad * sy, size.width, size.height));
  }
  return sum;
}

void shade(cv::Mat& image, const cv::Mat& noise, double contrast) {
  for (int y = 0; y < image.rows; ++y) {
    auto* row = image.ptr<cv::Vec3b>(y);
    const auto* n = noise.ptr<float>(y);
    for (int x = 0; x < image.cols; ++x) {
      const double factor = 1 + contrast * static_cast<double>(n[x]);
      for (int c = 0; c < 3; ++c) row[x][c] = cv::saturate_cast<uint8_t>(row[x][c] * factor);
    }
  }
}

cv::Mat shaded(const cv::Scalar& color, const cv::Mat& noise, double contrast) {
  cv::Mat image(noise.size(), CV_8UC3, color);
  shade(image, noise, contrast);
  return image;
}

}  // namespace kinloop::sim
