#include <algorithm>
#include <cmath>

#include <opencv2/imgproc.hpp>

#include "simulator/paint/paint.hpp"

namespace kinloop::sim {
namespace {

const cv::Size kLarge(1024, 1024);
const cv::Size kFloor(2048, 2048);
const cv::Size kSmall(256, 256);

cv::Scalar vary(const cv::Scalar& color, double amount, Random& random) {
  const double factor = 1 + random.uniform(-amount, amount);
  return {color[0] * factor, color[1] * factor * (1 + random.uniform(-0.02, 0.02)), color[2] * factor};
}

void add_knot(cv::Mat& image, cv::Point at, double radius, const cv::Scalar& color, Random& random) {
  for (int ring = 3; ring >= 1; --ring) {
    const cv::Size axes(static_cast<int>(radius * ring * 0.8), static_cast<int>(radius * ring * 0.35));
    cv::ellipse(image, at, axes, random.uniform(-10, 10), 0, 360, color * (0.55 + 0.12 * ring),
                ring == 1 ? -1 : 1, cv::LINE_AA);
  }
}

}  // namespace

cv::Mat paint_plaster(Random& random) {
  const cv::Scalar color = random_hsv(random, {20, 60}, {0.02, 0.14}, {0.8, 0.92});
  cv::Mat image = shaded(color, fractal_noise(kLarge, {4, 4}, 8, 0.75, random), 0.012);
  constexpr int kSmears = 14;
  for (int i = 0; i < kSmears; ++i) {  // scuffs and filled holes
    const cv::Point p = random_point(random, kLarge);
    const double tint = random.uniform(0.86, 1.05), turn_deg = random.uniform(0, 180);
    cv::ellipse(image, p, {3 + random_below(random, 9), 2}, turn_deg, 0, 360, color * tint, -1, cv::LINE_AA);
  }
  return image;
}

cv::Mat paint_wallpaper(Random& random) {
  const cv::Scalar color = random_color(random, 0.25, 0.7, 0.9);
  cv::Mat image = shaded(color, fractal_noise(kLarge, {8, 8}, 7, 0.8, random), 0.02);
  const double hue = random.uniform(0, 360);
  constexpr int kSprigs = 260;
  for (int i = 0; i < kSprigs; ++i) {
    const cv::Point p = random_point(random, kLarge);
    const double turn = random.uniform(0, 360);
    const cv::Scalar ink = random_hsv(random, {-40, 40}, {0.1, 0.4}, {0.45, 0.8}, hue);
    const int petals = 3 + static_cast<int>(random.index(4));
    const int length = 6 + static_cast<int>(random.index(16));
    for (int k = 0; k < petals; ++k) {
      const double a = turn + 360.0 * k / petals;
      const cv::Point tip(p.x + static_cast<int>(length * std::cos(a * CV_PI / 180)),
                          p.y + static_cast<int>(length * std::sin(a * CV_PI / 180)));
      cv::ellipse(image, (p + tip) / 2, {length / 2, std::max(2, length / 5)}, a, 0, 360, ink, -1,
                  cv::LINE_AA);
    }
  }
  return image;
}

cv::Mat paint_bricks(Random& random) {
  const double hue = random.uniform(8, 24);
  cv::Mat image = shaded(hsv(40, 0.08, 0.68), fractal_noise(kLarge, {32, 32}, 6, 0.8, random), 0.06);
  constexpr int kHeight = 20, kWidth = 64, kJoint = 3;
  for (int row = 0; row * kHeight < kLarge.height; ++row) {
    for (int x = row % 2 == 0 ? 0 : -kWidth / 2; x < kLarge.width; x += kWidth) {
      const cv::Scalar color = random_hsv(random, {-6, 6}, {0.3, 0.55}, {0.4, 0.68}, hue);
      const int dy = random_below(random, 3) - 1, dx = random_below(random, 3) - 1;
      const cv::Point corner(x + dx, row * kHeight + dy);
      cv::rectangle(image, corner, corner + cv::Point(kWidth - kJoint, kHeight - kJoint), color, -1);
    }
  }
  shade(image, fractal_noise(kLarge, {16, 16}, 7, 0.85, random), 0.07);
  return image;
}

cv::Mat paint_planks(Random& random) {
  const cv::Scalar base = random_hsv(random, {22, 34}, {0.35, 0.6}, {0.5, 0.75});
  cv::Mat image(kFloor, CV_8UC3, base);
  constexpr int kPlank = 52;
  for (int y = 0; y < kFloor.height; y += kPlank) {
    int x = -static_cast<int>(random.index(300));
    while (x < kFloor.width) {
      const int length = 180 + static_cast<int>(random.index(320));
      const cv::Scalar color = vary(base, 0.16, random);
      cv::rectangle(image, {x, y}, {x + length, y + kPlank - 1}, color, -1);
      const auto knots = random.index(4);
      for (uint32_t k = 0; k < knots; ++k) {
        const int dy = 8 + random_below(random, kPlank - 16), dx = 10 + random_below(random, length);
        add_knot(image, {x + dx, y + dy}, random.uniform(2, 5), color, random);
      }
      cv::line(image, {x, y}, {x, y + kPlank}, base * 0.35, 1, cv::LINE_AA);
      x += length;
    }
    cv::line(image, {0, y}, {kFloor.width, y}, base * 0.4, 1, cv::LINE_AA);
  }
  shade(image, fractal_noise(kFloor, {16, 512}, 3, 0.7, random), 0.08);
  shade(image, fractal_noise(kFloor, {8, 8}, 3, 0.6, random), 0.05);
  return image;
}

cv::Mat paint_carpet(Random& random) {
  const cv::Scalar base = random_color(random, 0.4, 0.35, 0.6);
  cv::Mat image = shaded(base, fractal_noise(kFloor, {8, 8}, 3, 0.6, random), 0.05);
  shade(image, fractal_noise(kFloor, {256, 256}, 4, 1.0, random), 0.1);
  constexpr int kFlecks = 9000;
  for (int i = 0; i < kFlecks; ++i) {
    const cv::Point p = random_point(random, kFloor);
    const cv::Scalar color = vary(base, 0.55, random);
    cv::circle(image, p, 1 + random_below(random, 4), color, -1, cv::LINE_AA);
  }
  return image;
}

cv::Mat paint_tiles(Random& random) {
  const cv::Scalar base = random_hsv(random, {15, 50}, {0.08, 0.3}, {0.55, 0.8});
  cv::Mat image(kFloor, CV_8UC3, base);
  constexpr int kTile = 128;
  for (int y = 0; y < kFloor.height; y += kTile) {
    for (int x = 0; x < kFloor.width; x += kTile) {
      const cv::Rect tile(x, y, kTile, kTile);
      cv::rectangle(image, tile, vary(base, 0.12, random), -1);
      for (int vein = 0; vein < 4; ++vein) {
        cv::Point p = random_point(random, {kTile, kTile});
        for (int step = 0; step < 8; ++step) {
          const int dy = random_below(random, 31) - 15, dx = random_below(random, 31) - 15;
          const cv::Point q = p + cv::Point(dx, dy);
          const int thickness = 1 + random_below(random, 2);
          cv::Mat cut = image(tile);
          cv::line(cut, p, q, vary(base * 0.8, 0.2, random), thickness, cv::LINE_AA);
          p = q;
        }
      }
      cv::rectangle(image, tile, base * 0.55, 2);
    }
  }
  shade(image, fractal_noise(kFloor, {32, 32}, 5, 0.8, random), 0.04);
  return image;
}

cv::Mat paint_wood(Random& random) {
  const cv::Size size(512, 512);
  const cv::Scalar base = random_hsv(random, {18, 36}, {0.3, 0.65}, {0.35, 0.8});
  cv::Mat image = shaded(base, fractal_noise(size, {4, 64}, 4, 0.75, random), 0.14);
  shade(image, fractal_noise(size, {2, 8}, 3, 0.6, random), 0.08);
  constexpr int kMarks = 26;
  for (int i = 0; i < kMarks; ++i) {
    const cv::Point p = random_point(random, size);
    if (i % 3 == 0) {
      add_knot(image, p, random.uniform(2, 5), base, random);
    } else {  // a scratch
      const int dy = random_below(random, 9) - 4, dx = random_below(random, 50);
      cv::line(image, p, p + cv::Point(dx, dy), base * random.uniform(0.5, 1.3), 1, cv::LINE_AA);
    }
  }
  return image;
}

cv::Mat paint_fabric(Random& random) {
  const cv::Scalar base = random_color(random, 0.7, 0.3, 0.75);
  cv::Mat image = shaded(base, fractal_noise(kSmall, {64, 64}, 3, 0.9, random), 0.12);
  const bool striped = random.index(2) == 0;
  for (int i = 0; i < kSmall.width; i += 6 + static_cast<int>(random.index(26))) {
    const cv::Scalar thread = vary(base, 0.5, random);
    const int thickness = 1 + static_cast<int>(random.index(5));
    cv::line(image, {i, 0}, {i, kSmall.height}, thread, thickness);
    if (!striped) cv::line(image, {0, i}, {kSmall.width, i}, thread, thickness);
  }
  shade(image, fractal_noise(kSmall, {8, 8}, 6, 0.9, random), 0.05);
  return image;
}

cv::Mat paint_plain(Random& random) {
  const cv::Scalar base = random_color(random, 0.75, 0.25, 0.95);
  return shaded(base, fractal_noise({64, 64}, {4, 4}, 4, 0.8, random), 0.025);
}

cv::Mat paint_metal(Random& random) {
  const cv::Scalar base = random_color(random, 0.12, 0.1, 0.85);
  return shaded(base, fractal_noise({64, 64}, {4, 4}, 4, 0.8, random), 0.025);
}

cv::Mat paint_cardboard(Random& random) {
  const cv::Scalar base = random_hsv(random, {26, 36}, {0.35, 0.5}, {0.55, 0.75});
  cv::Mat image = shaded(base, fractal_noise(kSmall, {4, 16}, 5, 0.8, random), 0.05);
  cv::line(image, {0, 128}, {256, 128}, vary(base, 0.1, random) * 1.2, 26);  // tape
  const cv::Rect area(24 + static_cast<int>(random.index(90)), 150, 100, 80);
  cv::rectangle(image, area, cv::Scalar::all(235), -1);
  write_lines(image, area, 11, cv::Scalar::all(30), random);
  cv::putText(image, random.index(2) == 0 ? "FRAGILE" : "THIS SIDE UP", {20, 60}, cv::FONT_HERSHEY_DUPLEX,
              0.8, base * 0.4, 2, cv::LINE_AA);
  return image;
}

cv::Mat paint_leaf(Random& random) {
  const cv::Scalar base = random_hsv(random, {85, 135}, {0.4, 0.8}, {0.3, 0.6});
  cv::Mat image = shaded(base, fractal_noise(kSmall, {8, 8}, 5, 0.8, random), 0.15);
  for (int i = 0; i < kSmall.width; i += 16) {
    const cv::Scalar vein = vary(base, 0.1, random) * 1.5;
    cv::line(image, {128, i}, {0, i - 60}, vein, 2, cv::LINE_AA);
    cv::line(image, {128, i}, {256, i - 60}, vein, 2, cv::LINE_AA);
  }
  cv::line(image, {128, 0}, {128, 256}, base * 1.6, 4, cv::LINE_AA);
  return image;
}

cv::Mat paint_rug(Random& random) {
  const cv::Size size(1024, 1024);
  const double hue = random.uniform(0, 360);
  const auto color = [&] { return random_hsv(random, {-50, 50}, {0.2, 0.7}, {0.2, 0.8}, hue); };
  cv::Mat image(size, CV_8UC3, color());
  constexpr int kBorders = 5;
  for (int i = 0; i < kBorders; ++i) {
    const int inset = 16 + 38 * i;
    cv::rectangle(image, cv::Rect(inset, inset, size.width - 2 * inset, size.height - 2 * inset), color(),
                  -1);
  }
  constexpr int kOrnaments = 420;
  for (int i = 0; i < kOrnaments; ++i) {
    const cv::Point p = random_point(random, size);
    const int radius = 6 + static_cast<int>(random.index(30));
    std::vector<cv::Point> star;
    const int spikes = 2 * (3 + static_cast<int>(random.index(4)));
    const double turn = random.uniform(0, 3);
    for (int k = 0; k < spikes; ++k) {
      const double r = k % 2 == 0 ? radius : 0.5 * radius, a = turn + 2 * CV_PI * k / spikes;
      star.emplace_back(p.x + static_cast<int>(r * std::cos(a)), p.y + static_cast<int>(r * std::sin(a)));
    }
    cv::fillPoly(image, std::vector{star}, color(), cv::LINE_AA);
    cv::circle(image, p, radius / 4, color(), -1, cv::LINE_AA);
  }
  shade(image, fractal_noise(size, {256, 256}, 2, 1.0, random), 0.12);
  return image;
}

}  // namespace kinloop::sim
