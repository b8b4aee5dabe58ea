#include <algorithm>
#include <cmath>

#include <opencv2/imgproc.hpp>

#include "simulator/paint/paint.hpp"

namespace kinloop::sim {
namespace {

void bevel(cv::Mat& image, const cv::Rect& panel, const cv::Scalar& color) {
  cv::rectangle(image, panel, color * 0.6, 3, cv::LINE_AA);
  cv::rectangle(image, panel - cv::Point(2, 2), color * 1.15, 1, cv::LINE_AA);
}

}  // namespace

cv::Mat paint_paper(Random& random) {
  cv::Mat image(256, 256, CV_8UC3, random_hsv(random, {30, 60}, {0, 0.1}, {0.88, 0.97}));
  write_lines(image, {20, 8, 210, 36}, 28, cv::Scalar::all(40), random);
  if (random.index(2) == 0) {
    const cv::Rect figure(20, 60, 100, 70);
    cv::rectangle(image, figure, random_color(random, 0.7, 0.3, 0.9), -1);
    for (int i = 0; i < 12; ++i) {
      const cv::Scalar color = random_color(random, 0.8, 0.2, 1);
      const cv::Point end = figure.tl() + random_point(random, figure.size());
      const cv::Point begin = figure.tl() + random_point(random, figure.size());
      cv::line(image, begin, end, color, 2, cv::LINE_AA);
    }
    write_lines(image, {130, 56, 110, 76}, 10, cv::Scalar::all(60), random);
  }
  write_lines(image, {20, 138, 210, 108}, 11, cv::Scalar::all(50), random);
  return image;
}

cv::Mat paint_screen(Random& random) {
  const cv::Size size(512, 256);
  const cv::Mat noise = fractal_noise(size, {4, 2}, 5, 0.7, random);
  cv::Mat image = shaded(random_color(random, 0.7, 0.2, 0.5), noise, 0.3);
  for (int i = 0; i < 4; ++i) {
    const int height = 90 + random_below(random, 50), width = 180 + random_below(random, 70);
    const int top = 10 + random_below(random, 90), left = random_below(random, 250);
    const cv::Rect window(left, top, width, height);
    const bool dark = random.index(2) == 0;
    cv::rectangle(image, window, cv::Scalar::all(dark ? 35 : 235), -1);
    cv::rectangle(image, cv::Rect(window.tl(), cv::Size(window.width, 12)),
                  random_color(random, 0.6, 0.4, 0.8), -1);
    write_lines(image, {window.x + 6, window.y + 12, window.width - 10, window.height - 16}, 9,
                dark ? hsv(random.uniform(60, 200), 0.5, 0.9) : cv::Scalar::all(50), random);
  }
  cv::rectangle(image, {0, 0}, {511, 255}, cv::Scalar::all(18), 14);
  return image;
}

cv::Mat paint_keyboard(Random& random) {
  const bool dark = random.index(2) == 0;
  cv::Mat image(128, 256, CV_8UC3, cv::Scalar::all(dark ? 30 : 150));
  for (int row = 0; row < 5; ++row) {
    int x = 6;
    while (x < 244) {
      const int width =
          std::min(250 - x, row == 4 && x > 60 && x < 90 ? 90 : 13 + (random_below(random, 6) == 0 ? 10 : 0));
      const cv::Rect key(x, 8 + row * 23, width, 20);
      cv::rectangle(image, key, cv::Scalar::all(dark ? 62 : 225), -1);
      const std::string letter(1, static_cast<char>('A' + random_below(random, 26)));
      cv::putText(image, letter, key.tl() + cv::Point(3, 13), cv::FONT_HERSHEY_PLAIN, 0.7,
                  cv::Scalar::all(dark ? 220 : 40), 1, cv::LINE_AA);
      x += width + 3;
    }
  }
  return image;
}

cv::Mat paint_label(Random& random) {
  const cv::Scalar base = random_color(random, 0.9, 0.35, 1.0);
  cv::Mat image = shaded(base, fractal_noise({256, 256}, {4, 4}, 4, 0.6, random), 0.1);
  for (int i = 0; i < 26; ++i) {
    const cv::Scalar color = random_color(random, 0.9, 0.2, 1.0);
    const int radius = 3 + random_below(random, 26);
    cv::circle(image, random_point(random, {256, 256}), radius, color, -1, cv::LINE_AA);
  }
  cv::rectangle(image, cv::Rect(16, 40, 224, 76), cv::Scalar::all(random.uniform(200, 255)), -1);
  write_lines(image, {24, 34, 200, 80}, 40, random_color(random, 0.9, 0.0, 0.4), random);
  write_lines(image, {30, 170, 200, 74}, 12, cv::Scalar::all(random.index(2) == 0 ? 20 : 240), random);
  for (int x = 150; x < 230; x += 3 + random_below(random, 4))
    cv::line(image, {x, 130}, {x, 160}, cv::Scalar::all(10), 1 + random_below(random, 2));
  return image;
}

cv::Mat paint_book_spines(Random& random) {
  cv::Mat image(512, 1024, CV_8UC3);
  const cv::Size cell(image.cols / kSpineColumns, image.rows / kSpineRows);
  for (int i = 0; i < kSpineColumns * kSpineRows; ++i) {
    const cv::Scalar base = random_color(random, 0.8, 0.15, 0.9);
    const bool light = base[0] + base[1] + base[2] > 330;
    const cv::Scalar ink = light ? random_color(random, 0.8, 0.0, 0.3) : random_color(random, 0.4, 0.75, 1.0);
    // Drawn horizontally, then rotated to run along the spine.
    cv::Mat spine = shaded(base, fractal_noise({cell.height, cell.width}, {4, 2}, 5, 0.8, random), 0.06);
    const int line_px = 26 - random_below(random, 8), top = random_below(random, 4) - 6;
    write_lines(spine, {24, top, 150, 30}, line_px, ink, random);
    const int band = 190 + random_below(random, 40);
    cv::rectangle(spine, cv::Rect(band, 0, 6 + random_below(random, 18), cell.width), ink, -1);
    cv::line(spine, {8, 0}, {8, cell.width}, ink, 2);
    cv::rectangle(spine, cv::Rect(0, 0, cell.height, cell.width), base * 0.6, 2);
    cv::Mat upright;
    cv::rotate(spine, upright, cv::ROTATE_90_CLOCKWISE);
    upright.copyTo(
        image(cv::Rect({(i % kSpineColumns) * cell.width, (i / kSpineColumns) * cell.height}, cell)));
  }
  return image;
}

cv::Mat paint_drawers(Random& random) {
  const cv::Size size(256, 256);
  const cv::Scalar base = random.index(2) == 0 ? random_hsv(random, {20, 36}, 0.45, {0.4, 0.75})
                                               : random_color(random, 0.3, 0.5, 0.9);
  cv::Mat image = shaded(base, fractal_noise(size, {32, 4}, 4, 0.8, random), 0.06);
  const int rows = 2 + random_below(random, 3), columns = 1 + random_below(random, 2);
  for (int i = 0; i < rows * columns; ++i) {
    const cv::Size panel(size.width / columns - 12, size.height / rows - 12);
    const cv::Point corner((i % columns) * size.width / columns + 6, (i / columns) * size.height / rows + 6);
    bevel(image, {corner, panel}, base);
    const cv::Point knob = corner + cv::Point(panel.width / 2, panel.height / 2);
    cv::line(image, knob - cv::Point(12, 0), knob + cv::Point(12, 0), cv::Scalar::all(40), 6, cv::LINE_AA);
    cv::line(image, knob - cv::Point(11, 1), knob + cv::Point(11, -1), cv::Scalar::all(190), 2, cv::LINE_AA);
  }
  return image;
}

cv::Mat paint_door(Random& random) {
  const cv::Size size(256, 512);
  const cv::Scalar base = random.index(2) == 0 ? random_hsv(random, {20, 34}, 0.5, {0.4, 0.65})
                                               : random_color(random, 0.15, 0.8, 0.95);
  cv::Mat image = shaded(base, fractal_noise(size, {64, 8}, 4, 0.8, random), 0.06);
  for (int i = 0; i < 4; ++i) bevel(image, {28 + (i % 2) * 108, 40 + (i / 2) * 230, 90, 190}, base);
  cv::line(image, {226, 262}, {200, 262}, cv::Scalar::all(60), 8, cv::LINE_AA);
  cv::line(image, {226, 260}, {200, 260}, cv::Scalar::all(210), 3, cv::LINE_AA);
  cv::circle(image, {228, 290}, 5, cv::Scalar::all(30), -1, cv::LINE_AA);
  cv::rectangle(image, {0, 0}, {255, 511}, base * 0.75, 12);
  return image;
}

cv::Mat paint_clock(Random& random) {
  cv::Mat image(256, 256, CV_8UC3, cv::Scalar::all(242));
  const cv::Point center(128, 128);
  const auto hand = [&](double turn, double length, int thickness) {
    const cv::Point tip(static_cast<int>(128 + length * std::sin(turn)),
                        static_cast<int>(128 - length * std::cos(turn)));
    cv::line(image, center, tip, cv::Scalar::all(20), thickness, cv::LINE_AA);
  };
  for (int hour = 1; hour <= 12; ++hour) {
    const double a = hour * CV_PI / 6;
    const cv::Point at(static_cast<int>(116 + 92 * std::sin(a)), static_cast<int>(138 - 92 * std::cos(a)));
    cv::putText(image, std::to_string(hour), at, cv::FONT_HERSHEY_DUPLEX, 0.8, cv::Scalar::all(20), 2,
                cv::LINE_AA);
  }
  hand(random.uniform(0, 6.28), 52, 8);
  hand(random.uniform(0, 6.28), 86, 5);
  cv::circle(image, center, 122, random_color(random, 0.8, 0.1, 0.7), 11, cv::LINE_AA);
  return image;
}

cv::Mat paint_ball(Random& random) {
  cv::Mat image(128, 256, CV_8UC3);
  const double hue = random.uniform(0, 360);
  for (int i = 0; i < 8; ++i) {
    const cv::Scalar color = i % 2 == 0 ? cv::Scalar::all(235) : hsv(hue + 45 * i, 0.8, 0.8);
    cv::rectangle(image, cv::Rect(32 * i, 0, 32, 128), color, -1);
    cv::circle(image, {32 * i + 16, 40 + random_below(random, 50)}, 7, hsv(hue + 60 * i, 0.7, 0.6), -1,
               cv::LINE_AA);
  }
  cv::rectangle(image, cv::Rect(0, 0, 256, 14), hsv(hue, 0.8, 0.5), -1);
  cv::rectangle(image, cv::Rect(0, 114, 256, 14), hsv(hue, 0.8, 0.5), -1);
  return image;
}

}  // namespace kinloop::sim
