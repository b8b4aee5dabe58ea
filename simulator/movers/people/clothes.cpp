#include "simulator/movers/people/clothes.hpp"

#include <opencv2/imgproc.hpp>

#include "simulator/paint/paint.hpp"

namespace kinloop::sim {
namespace {

const cv::Size kCloth(256, 256);

void add_weave(cv::Mat& image, double contrast, Random& random) {
  shade(image, fractal_noise(kCloth, {16, 16}, 5, 0.8, random), contrast);
}

void paint_stripes(cv::Mat& image, bool checks, Random& random) {
  const int count = 3 + random_below(random, 5);
  for (int i = 0; i < count; ++i) {
    const cv::Scalar color = random_color(random, 0.7, 0.15, 0.95);
    const int at = i * kCloth.height / count, width = 8 + random_below(random, 24);
    cv::rectangle(image, cv::Rect(0, at, kCloth.width, width), color, -1);
    if (checks) cv::rectangle(image, cv::Rect(at, 0, width / 2, kCloth.height), color * 0.8, -1);
  }
}

void paint_print(cv::Mat& image, Random& random) {
  constexpr int kShapes = 40;
  for (int i = 0; i < kShapes; ++i) {
    const cv::Point p = random_point(random, kCloth);
    const int radius = 5 + random_below(random, 14);
    const cv::Scalar color = random_color(random, 0.8, 0.2, 0.95);
    if (random.index(2) == 0) {
      cv::circle(image, p, radius, color, -1, cv::LINE_AA);
    } else {
      cv::rectangle(image, cv::Rect(p.x, p.y, radius, 2 * radius), color, -1);
    }
  }
  const cv::Scalar ink = random_color(random, 0.3, 0.05, 0.25);
  write_lines(image, cv::Rect(20, 90, 216, 80), 38, ink, random);
}

cv::Mat paint_shirt(Random& random) {
  cv::Mat image(kCloth, CV_8UC3, random_color(random, 0.7, 0.25, 0.9));
  const uint32_t pattern = random.index(3);
  if (pattern == 2) {
    paint_print(image, random);
  } else {
    paint_stripes(image, pattern == 1, random);
  }
  add_weave(image, 0.1, random);
  return image;
}

cv::Mat paint_trousers(Random& random) {
  const cv::Scalar color = random_hsv(random, {200, 240}, {0.05, 0.6}, {0.15, 0.5});
  cv::Mat image(kCloth, CV_8UC3, color);
  for (const int x : {2, 130}) cv::line(image, {x, 0}, {x, kCloth.height}, color * 1.5, 2, cv::LINE_AA);
  constexpr int kFolds = 18;
  for (int i = 0; i < kFolds; ++i) {
    const cv::Point p = random_point(random, kCloth);
    const cv::Point slope(30 + random_below(random, 30), random_below(random, 21) - 10);
    cv::line(image, p, p + slope, color * random.uniform(0.6, 1.4), 2, cv::LINE_AA);
  }
  add_weave(image, 0.16, random);
  return image;
}

cv::Mat paint_shoe(Random& random) {
  const cv::Scalar color = random_color(random, 0.6, 0.1, 0.6);
  cv::Mat image(kCloth, CV_8UC3, color);
  for (int y = 10; y < kCloth.height; y += 50)
    cv::line(image, {0, y}, {kCloth.width, y + 12}, cv::Scalar::all(225), 6, cv::LINE_AA);
  add_weave(image, 0.1, random);
  return image;
}

/// The whole head, unrolled: the face looks along x, in the middle of the image.
cv::Mat paint_head(const cv::Scalar& skin, const cv::Scalar& hair, Random& random) {
  const cv::Size size(512, 256);
  cv::Mat image(size, CV_8UC3, skin);
  const int hairline = 66 + random_below(random, 16), nape = 150 + random_below(random, 40);
  cv::rectangle(image, cv::Rect(0, 0, size.width, hairline), hair, -1);
  for (const int x : {0, 356}) cv::rectangle(image, cv::Rect(x, 0, 156, nape), hair, -1);
  for (const int side : {-1, 1}) {
    const cv::Point eye(256 + 28 * side, 118), ear(256 + 112 * side, 128);
    cv::ellipse(image, eye, {11, 6}, 0, 0, 360, cv::Scalar::all(240), -1, cv::LINE_AA);
    cv::circle(image, eye, 5, cv::Scalar(50, 40, 30), -1, cv::LINE_AA);
    cv::line(image, eye - cv::Point(13, 14), eye + cv::Point(13, -15), hair * 0.8, 5, cv::LINE_AA);
    cv::ellipse(image, ear, {9, 18}, 0, 0, 360, skin * 0.8, -1, cv::LINE_AA);
  }
  cv::ellipse(image, {256, 172}, {20, 6}, 0, 0, 360, cv::Scalar(90, 80, 160), -1, cv::LINE_AA);
  cv::line(image, {238, 172}, {274, 172}, cv::Scalar(50, 40, 90), 2, cv::LINE_AA);
  shade(image, fractal_noise(size, {32, 16}, 4, 0.8, random), 0.07);
  return image;
}

}  // namespace

FaceTexture Wardrobe::added(const cv::Mat& image, float period_m) {
  textures_.emplace_back(image);
  const int texture = first_texture_ + static_cast<int>(textures_.size()) - 1;
  return {texture, false, 0, 0, 1 / period_m, 1 / period_m};
}

Outfit Wardrobe::outfit(Random& random) {
  constexpr float kShirt_m = 0.42F, kTrousers_m = 0.3F, kSkin_m = 0.25F, kHair_m = 0.15F;
  const cv::Scalar skin = random_hsv(random, {14, 28}, {0.3, 0.6}, {0.35, 0.95});
  const cv::Scalar hair = random_hsv(random, {10, 40}, {0.2, 0.6}, {0.08, 0.6});
  Outfit outfit;
  outfit.shirt = added(paint_shirt(random), kShirt_m);
  outfit.trousers = added(paint_trousers(random), kTrousers_m);
  outfit.shoe = added(paint_shoe(random), 0.15F);
  outfit.bag = added(paint_shirt(random), kShirt_m);
  cv::Mat bare(kCloth, CV_8UC3, skin), strands(kCloth, CV_8UC3, hair);
  add_weave(bare, 0.06, random);
  add_weave(strands, 0.25, random);
  outfit.skin = added(bare, kSkin_m);
  outfit.hair = added(strands, kHair_m);
  outfit.face = added(paint_head(skin, hair, random), 1);
  outfit.face.fitted = true;
  outfit.short_sleeves = random.index(2) == 0;
  outfit.has_bag = random.index(3) == 0;
  return outfit;
}

}  // namespace kinloop::sim
