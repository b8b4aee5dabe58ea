#include <algorithm>
#include <cmath>
#include <string>

#include <opencv2/imgproc.hpp>

#include "simulator/paint/paint.hpp"

namespace kinloop::sim {
namespace {

const cv::Size kPicture(512, 512);

/// A ridge line from left to right, filled down to the lower border.
void fill_ridge(cv::Mat& image, double level, double height, const cv::Scalar& color, Random& random) {
  std::vector<cv::Point> ridge{{image.cols, image.rows}, {0, image.rows}};
  double y = level;
  for (int x = 0; x <= image.cols; x += 4 + random_below(random, 14)) {
    y += random.uniform(-1, 1) * height * 0.25 + (level - y) * 0.05;
    ridge.emplace_back(x, static_cast<int>(y));
  }
  ridge.emplace_back(image.cols, static_cast<int>(y));
  cv::fillPoly(image, std::vector{ridge}, color, cv::LINE_AA);
}

void draw_tree(cv::Mat& image, cv::Point foot, int height, Random& random) {
  cv::line(image, foot, foot - cv::Point(0, height), hsv(25, 0.5, random.uniform(0.15, 0.35)),
           std::max(1, height / 12), cv::LINE_AA);
  const double hue = random.uniform(60, 130);
  for (int i = 0; i < 24; ++i) {
    const int up = height / 2 + random_below(random, height);
    const int left = random_below(random, height) - height / 2;
    const cv::Scalar color = random_hsv(random, {-15, 15}, {0.3, 0.8}, {0.15, 0.6}, hue);
    const int radius = 2 + random_below(random, std::max(2, height / 6));
    cv::circle(image, foot - cv::Point(left, up), radius, color, -1, cv::LINE_AA);
  }
}

void draw_house(cv::Mat& image, cv::Point foot, int size, Random& random) {
  const cv::Rect wall(foot.x, foot.y - size, size, size);
  cv::rectangle(image, wall, random_color(random, 0.5, 0.5, 0.95), -1);
  const std::vector<cv::Point> roof{{wall.x - size / 8, wall.y},
                                    {wall.x + size / 2, wall.y - size / 2},
                                    {wall.x + size + size / 8, wall.y}};
  cv::fillPoly(image, std::vector{roof}, random_hsv(random, {0, 30}, 0.7, {0.3, 0.6}), cv::LINE_AA);
  for (int i = 0; i < 4; ++i) {
    const cv::Rect pane(wall.x + size / 8 + (i % 2) * size / 2, wall.y + size / 8 + (i / 2) * size / 2,
                        size / 4, size / 4);
    cv::rectangle(image, pane, hsv(210, 0.4, random.uniform(0.15, 0.5)), -1);
    cv::rectangle(image, pane, cv::Scalar::all(240), 1);
  }
}

void paint_sky(cv::Mat& image, double top_hue, Random& random) {
  const cv::Mat clouds = fractal_noise(image.size(), {4, 8}, 6, 0.6, random);
  for (int y = 0; y < image.rows; ++y) {
    const double s = static_cast<double>(y) / image.rows;
    const cv::Scalar blue = hsv(top_hue, 0.6 * (1 - s), 0.75 + 0.2 * s);
    for (int x = 0; x < image.cols; ++x) {
      const double cloud = std::clamp(1.2 * static_cast<double>(clouds.at<float>(y, x)), 0.0, 0.8);
      for (int c = 0; c < 3; ++c) {
        image.at<cv::Vec3b>(y, x)[c] = cv::saturate_cast<uint8_t>(blue[c] + cloud * (245 - blue[c]));
      }
    }
  }
}

void add_frame(cv::Mat& image, Random& random) {
  const cv::Scalar color = random_color(random, 0.5, 0.1, 0.9);
  const int thickness = 8 + random_below(random, 14);
  cv::rectangle(image, {0, 0}, {image.cols - 1, image.rows - 1}, color, 2 * thickness);
  cv::rectangle(image, {thickness, thickness}, {image.cols - 1 - thickness, image.rows - 1 - thickness},
                color * 0.5, 2);
}

void scatter_shapes(cv::Mat& image, int count, int largest, Random& random) {
  for (int i = 0; i < count; ++i) {
    const cv::Point p = random_point(random, image.size());
    const cv::Scalar color = random_color(random, 0.9, 0.1, 1.0);
    // Sizes uniform in octaves, like details in photographs.
    const int size = std::max(3, static_cast<int>(largest * std::exp2(-random.uniform(0, 4))));
    switch (random.index(4)) {
      case 0:
        cv::circle(image, p, size, color, -1, cv::LINE_AA);
        break;
      case 1:
        cv::ellipse(image, p, {size, size / 3 + 1}, random.uniform(0, 180), 0, 360, color, -1, cv::LINE_AA);
        break;
      case 2: {
        const auto corner = [&] {
          const int dy = random_below(random, 2 * size) - size, dx = random_below(random, 2 * size) - size;
          return p + cv::Point(dx, dy);
        };
        cv::fillPoly(image, std::vector{std::vector{corner(), corner(), corner(), corner()}}, color,
                     cv::LINE_AA);
        break;
      }
      default: {
        const int dy = random_below(random, 3 * size) - size, dx = random_below(random, 3 * size) - size;
        cv::line(image, p, p + cv::Point(dx, dy), color, 1 + size / 12, cv::LINE_AA);
      }
    }
  }
}

std::string made_up_word(Random& random) {
  static constexpr const char* kSyllables[] = {"ka", "ro",  "min", "tel", "su", "von",
                                               "ar", "del", "qui", "bo",  "fe", "lan"};
  std::string word;
  const int length = 1 + random_below(random, 3);
  for (int i = 0; i < length; ++i) word += kSyllables[random.index(std::size(kSyllables))];
  return word;
}

}  // namespace

void write_lines(cv::Mat& image, const cv::Rect& area, double line_px, const cv::Scalar& ink,
                 Random& random) {
  const double scale = line_px / 34;
  for (double y = area.y + line_px; y < area.br().y; y += line_px) {
    const double end = area.x + area.width * random.uniform(0.6, 1.0);
    std::string line;
    while (area.x + static_cast<double>(line.size()) * line_px * 0.52 < end)
      line += made_up_word(random) + " ";
    line.resize(static_cast<size_t>((end - area.x) / (line_px * 0.52)));
    cv::putText(image, line, {area.x, static_cast<int>(y)}, cv::FONT_HERSHEY_SIMPLEX, scale, ink,
                line_px > 24 ? 2 : 1, cv::LINE_AA);
  }
}

cv::Mat paint_landscape(Random& random) {
  cv::Mat image(kPicture, CV_8UC3);
  paint_sky(image, random.uniform(190, 230), random);
  if (random.index(2) == 0)
    cv::circle(image, {random_below(random, 512), 60 + random_below(random, 80)}, 26, {170, 230, 250}, -1,
               cv::LINE_AA);
  const double hue = random.uniform(60, 260);
  constexpr int kRidges = 5;
  for (int i = 0; i < kRidges; ++i) {
    const double near = static_cast<double>(i) / kRidges;
    fill_ridge(image, 200 + 60 * i, 60 - 8 * i,
               hsv(hue + (100 - hue) * near, 0.25 + 0.4 * near, 0.7 - 0.35 * near), random);
  }
  for (int i = 0; i < 3; ++i) {
    const int size = 30 + random_below(random, 30);
    draw_house(image, cv::Point(40, 400) + random_point(random, {420, 60}), size, random);
  }
  for (int i = 0; i < 22; ++i) {
    const int height = 16 + random_below(random, 50);
    draw_tree(image, cv::Point(0, 350) + random_point(random, {512, 150}), height, random);
  }
  add_frame(image, random);
  return image;
}

cv::Mat paint_abstract(Random& random) {
  const cv::Mat noise = fractal_noise(kPicture, {4, 4}, 7, 0.7, random);
  cv::Mat image = shaded(random_color(random, 0.5, 0.3, 0.9), noise, 0.2);
  scatter_shapes(image, 160, 110, random);
  if (random.index(2) == 0) add_frame(image, random);
  return image;
}

cv::Mat paint_poster(Random& random) {
  const cv::Scalar paper = random_color(random, 0.5, 0.6, 1.0), ink = random_color(random, 0.6, 0.0, 0.3);
  cv::Mat image = shaded(paper, fractal_noise(kPicture, {4, 4}, 4, 0.7, random), 0.04);
  cv::Mat head = image(cv::Rect(24, 20, 464, 90));
  write_lines(head, {0, 0, 464, 80}, 60, ink, random);
  cv::Mat picture = image(cv::Rect(24, 120, 464, 190));
  paint_sky(picture, random.uniform(0, 360), random);
  scatter_shapes(picture, 70, 50, random);
  write_lines(image, {24, 320, 220, 170}, 17, ink, random);
  write_lines(image, {264, 320, 220, 100}, 13, ink, random);
  for (int i = 0; i < 9; ++i) {  // a bar chart
    const cv::Scalar color = random_color(random, 0.9, 0.3, 0.9);
    cv::rectangle(image, {270 + 22 * i, 490}, {286 + 22 * i, 430 + random_below(random, 50)}, color, -1);
  }
  return image;
}

cv::Mat paint_map(Random& random) {
  const cv::Mat noise = fractal_noise(kPicture, {4, 4}, 6, 0.7, random);
  cv::Mat image = shaded(hsv(random.uniform(40, 120), 0.15, 0.9), noise, 0.06);
  for (int i = 0; i < 40; ++i) {  // fields and lakes
    const double value = random.uniform(0.65, 0.95), saturation = random.uniform(0.1, 0.4);
    const double hue = random.index(4) == 0 ? 210 : random.uniform(50, 140);
    const double turn_deg = random.uniform(0, 180);
    const cv::Size axes = cv::Size(10, 6) + cv::Size(random_point(random, {60, 30}));
    cv::ellipse(image, random_point(random, kPicture), axes, turn_deg, 0, 360, hsv(hue, saturation, value),
                -1, cv::LINE_AA);
  }
  for (int i = 0; i < 30; ++i) {  // roads
    cv::Point p = random_point(random, kPicture);
    const int width = 1 + random_below(random, 4);
    const cv::Scalar color = i % 3 == 0 ? cv::Scalar(60, 140, 230) : cv::Scalar::all(random.uniform(80, 250));
    double heading = random.uniform(0, 6.28);
    for (int k = 0; k < 14; ++k) {
      heading += random.uniform(-0.5, 0.5);
      const cv::Point q =
          p + cv::Point(static_cast<int>(34 * std::cos(heading)), static_cast<int>(34 * std::sin(heading)));
      cv::line(image, p, q, color, width, cv::LINE_AA);
      p = q;
    }
  }
  for (int i = 0; i < 60; ++i) {
    const cv::Point p = random_point(random, kPicture);
    cv::circle(image, p, 2 + random_below(random, 3), {30, 30, 160}, -1, cv::LINE_AA);
    cv::putText(image, made_up_word(random), p + cv::Point(5, 3), cv::FONT_HERSHEY_SIMPLEX, 0.35,
                cv::Scalar::all(30), 1, cv::LINE_AA);
  }
  return image;
}

cv::Mat paint_whiteboard(Random& random) {
  cv::Mat image = shaded({238, 240, 240}, fractal_noise(kPicture, {4, 4}, 5, 0.7, random), 0.02);
  const cv::Scalar pens[] = {{40, 30, 30}, {180, 60, 20}, {40, 40, 190}, {60, 130, 30}};
  for (int i = 0; i < 7; ++i) {
    const int height = 60 + random_below(random, 40), width = 90 + random_below(random, 80);
    const int top = 20 + random_below(random, 400), left = 20 + random_below(random, 330);
    const cv::Rect note(left, top, width, height);
    const cv::Scalar& pen = pens[random.index(4)];
    write_lines(image, note, 16 + random_below(random, 12), pen, random);
    if (random.index(2) == 0) cv::rectangle(image, note, pens[random.index(4)], 2, cv::LINE_AA);
  }
  for (int i = 0; i < 10; ++i) {
    const cv::Scalar& pen = pens[random.index(4)];
    const cv::Point tip = random_point(random, kPicture);
    cv::arrowedLine(image, random_point(random, kPicture), tip, pen, 2, cv::LINE_AA, 0, 0.05);
  }
  for (int i = 0; i < 6; ++i) {  // sticky notes
    const cv::Rect note(random_point(random, {460, 460}), cv::Size(44, 44));
    cv::rectangle(image, note, hsv(random.uniform(0, 360), 0.5, 0.95), -1);
    write_lines(image, note, 10, cv::Scalar::all(40), random);
  }
  cv::rectangle(image, {0, 0}, {511, 511}, cv::Scalar::all(150), 12);
  return image;
}

cv::Mat paint_window_view(Random& random) {
  cv::Mat image(kPicture, CV_8UC3);
  paint_sky(image, 210, random);
  fill_ridge(image, 330, 40, hsv(120, 0.25, 0.6), random);
  for (int i = 0; i < 9; ++i) {
    const int size = 40 + random_below(random, 60);
    draw_house(image, cv::Point(0, 400) + random_point(random, {480, 80}), size, random);
  }
  fill_ridge(image, 470, 20, hsv(100, 0.4, 0.5), random);
  for (int i = 0; i < 14; ++i) {
    const int height = 30 + random_below(random, 80);
    draw_tree(image, cv::Point(0, 440) + random_point(random, {512, 70}), height, random);
  }
  const cv::Scalar frame = cv::Scalar::all(225);
  cv::rectangle(image, {0, 0}, {511, 511}, frame, 36);
  cv::line(image, {256, 0}, {256, 512}, frame, 24);
  cv::line(image, {0, 150}, {512, 150}, frame, 14);
  cv::line(image, {244, 0}, {244, 512}, frame * 0.7, 2);
  return image;
}

}  // namespace kinloop::sim
