#include <algorithm>
#include <cmath>
#include <vector>

#include <opencv2/imgproc.hpp>

#include "kinloop/core/random.hpp"
#include "kinloop/core/threads/parallel_for.hpp"
#include "simulator/sensors/depth_models.hpp"
#include "simulator/sensors/deviates.hpp"

namespace kinloop {

StereoNoise StereoNoise::none() {
  StereoNoise ideal;
  ideal.disparity_noise_px = ideal.disparity_step_px = ideal.min_contrast = 0;
  ideal.fattening = ideal.holes = false;
  ideal.min_depth_m = 0;
  ideal.max_depth_m = 5;
  return ideal;
}

namespace sim {
namespace {

/// Mean and variance in a window around a pixel, cut at the border.
class WindowStatistics {
 public:
  WindowStatistics(const cv::Mat& image, int window_px) : radius_(window_px / 2) {
    cv::integral(image, sum_, squares_, CV_64F, CV_64F);
  }
  [[nodiscard]] double sum(int y, int x) const { return over_window(sum_, y, x); }
  [[nodiscard]] double count(int y, int x) const {
    const cv::Rect w = window(y, x);
    return w.area();
  }
  [[nodiscard]] double mean(int y, int x) const { return sum(y, x) / count(y, x); }
  [[nodiscard]] double deviation(int y, int x) const {
    const double m = mean(y, x);
    return std::sqrt(std::max(0.0, over_window(squares_, y, x) / count(y, x) - m * m));
  }

 private:
  [[nodiscard]] cv::Rect window(int y, int x) const {
    const cv::Rect image(0, 0, sum_.cols - 1, sum_.rows - 1);
    return cv::Rect(x - radius_, y - radius_, 2 * radius_ + 1, 2 * radius_ + 1) & image;
  }
  [[nodiscard]] double over_window(const cv::Mat& integral, int y, int x) const {
    const cv::Rect w = window(y, x);
    const auto* top = integral.ptr<double>(w.y);
    const auto* bottom = integral.ptr<double>(w.y + w.height);
    return bottom[w.x + w.width] - bottom[w.x] - top[w.x + w.width] + top[w.x];
  }

  int radius_;
  cv::Mat sum_, squares_;
};

uint64_t bits_of(uint64_t seed, const cv::Mat& image, int y, int x) {
  return hash(seed, static_cast<uint64_t>(y) * static_cast<uint64_t>(image.cols) + static_cast<uint64_t>(x));
}

/// Noise before it is averaged over the windows.
cv::Mat white_noise(const cv::Size& size, uint64_t seed, int threads) {
  cv::Mat noise(size, CV_32FC1);
  parallel_for(static_cast<size_t>(size.height), threads, [&](size_t begin, size_t end) {
    for (int y = static_cast<int>(begin); y < static_cast<int>(end); ++y) {
      for (int x = 0; x < size.width; ++x)
        noise.at<float>(y, x) = static_cast<float>(approximate_normal(bits_of(seed, noise, y, x)));
    }
  });
  return noise;
}

/// Exact disparity, 0 where there is none to match.
cv::Mat visible_disparity(const ExactDepth& exact, double disparity_scale, bool holes) {
  const cv::Size size = exact.depth_m.size();
  cv::Mat disparity(size, CV_32FC1);
  std::vector<uint8_t> shadow(static_cast<size_t>(size.width), 0);
  for (int y = 0; y < size.height; ++y) {
    const auto* depth_m = exact.depth_m.ptr<float>(y);
    const auto* cosine = exact.cosine.ptr<float>(y);
    if (holes) cast_shadow(depth_m, size.width, disparity_scale, shadow);
    for (int x = 0; x < size.width; ++x) {
      const bool seen = !holes || (cosine[x] > 0 && shadow[static_cast<size_t>(x)] == 0);
      disparity.at<float>(y, x) = seen ? static_cast<float>(disparity_scale) / depth_m[x] : 0;
    }
  }
  return disparity;
}

/// Near an edge the window holds more of the near surface's texture than of the far one's, and matches it
/// ("foreground fattening", Scharstein and Szeliski 2002, "A taxonomy and evaluation of dense two-frame
/// stereo correspondence algorithms").
cv::Mat fattened(const cv::Mat& disparity, int window_px) {
  constexpr float kJump_px = 1;  // more than a slanted surface has within a window
  cv::Mat nearest, result = disparity.clone();
  cv::dilate(disparity, nearest, cv::Mat::ones(window_px, window_px, CV_8U));
  nearest.copyTo(result, nearest - disparity > kJump_px);
  return result;
}

/// Contrast of the texture and of the projector's pattern, which fades with the square of the distance: on a
/// white wall it suffices up to about 4 m.
double contrast(const ExactDepth& exact, const WindowStatistics& reflectance, int y, int x) {
  constexpr double kPatternContrast_m2 = 0.3;  // on a white surface at 1 m
  const auto depth_m = static_cast<double>(exact.depth_m.at<float>(y, x));
  const double pattern = kPatternContrast_m2 * reflectance.mean(y, x) / (depth_m * depth_m);
  return reflectance.deviation(y, x) + pattern;
}

double depth_of(double disparity_px, double disparity_scale, const StereoNoise& noise) {
  if (noise.disparity_step_px > 0)
    disparity_px = std::round(disparity_px / noise.disparity_step_px) * noise.disparity_step_px;
  const double depth_m = disparity_px > 0 ? disparity_scale / disparity_px : 0;
  return depth_m < noise.min_depth_m || depth_m > noise.max_depth_m ? 0 : depth_m;
}

}  // namespace

cv::Mat matched_depth(const ExactDepth& exact, double disparity_scale, const StereoNoise& noise,
                      uint64_t seed, int threads) {
  const cv::Size size = exact.depth_m.size();
  cv::Mat disparity = visible_disparity(exact, disparity_scale, noise.holes), result(size, CV_32FC1);
  if (noise.fattening) disparity = fattened(disparity, noise.window_px);
  // Neighbours share most of their windows, and so their noise; uniform quantisation adds step^2 / 12.
  const WindowStatistics white(white_noise(size, seed, threads), noise.window_px);
  const WindowStatistics reflectance(exact.reflectance, noise.window_px);
  const double step_px = noise.disparity_step_px;
  const double noise_px =
      std::sqrt(std::max(0.0, noise.disparity_noise_px * noise.disparity_noise_px - step_px * step_px / 12));
  const auto lost = [&](double disparity_px, int y, int x) {
    if (disparity_px <= 0 || contrast(exact, reflectance, y, x) < noise.min_contrast) return true;
    // The second camera's image begins farther right.
    if (!noise.holes) return false;
    return x < disparity_px ||
           uniform(hash(bits_of(seed, result, y, x), 1)) < grazing_loss(exact.cosine.at<float>(y, x));
  };
  parallel_for(static_cast<size_t>(size.height), threads, [&](size_t begin, size_t end) {
    for (int y = static_cast<int>(begin); y < static_cast<int>(end); ++y) {
      for (int x = 0; x < size.width; ++x) {
        const auto exact_px = static_cast<double>(disparity.at<float>(y, x));
        const double error_px = noise_px * white.sum(y, x) / std::sqrt(white.count(y, x));
        const bool none = lost(exact_px, y, x);
        result.at<float>(y, x) =
            none ? 0 : static_cast<float>(depth_of(exact_px + error_px, disparity_scale, noise));
      }
    }
  });
  return result;
}

}  // namespace sim
}  // namespace kinloop
