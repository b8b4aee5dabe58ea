#include "simulator/sensors/kinect_model.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "kinloop/core/random.hpp"
#include "kinloop/core/threads/parallel_for.hpp"
#include "simulator/sensors/deviates.hpp"

namespace kinloop {

KinectNoise KinectNoise::none() {
  KinectNoise ideal;
  ideal.rolling_shutter_s = ideal.exposure_s = ideal.depth_delay_s = 0;
  ideal.depth_noise_per_m = ideal.disparity_step_px = 0;
  ideal.depth_stamps = ideal.holes = false;
  ideal.min_depth_m = 0;
  ideal.max_depth_m = 5;
  ideal.image_noise = ideal.gain_change = 0;
  return ideal;
}

namespace sim {
namespace {

/// Whether depth jumps between neighbours, so that the correlation window covers two surfaces.
bool at_edge(const cv::Mat& depth_m, int y, int x) {
  constexpr float kJump = 0.04F;
  const float here = depth_m.at<float>(y, x);
  for (const auto& [dy, dx] : {std::pair{-1, 0}, {1, 0}, {0, -1}, {0, 1}}) {
    const int ny = std::clamp(y + dy, 0, depth_m.rows - 1), nx = std::clamp(x + dx, 0, depth_m.cols - 1);
    if (std::abs(depth_m.at<float>(ny, nx) - here) > kJump * here) return true;
  }
  return false;
}

/// A smooth warp over the image, -1 to 1, that models residual lens errors of the infrared camera.
double warp_at(int x, int y, const cv::Size& size) {
  const double u = 2.0 * x / size.width - 1, v = 2.0 * y / size.height - 1;
  return 1.2 * (u * u + v * v) / 2 - 0.5 + 0.3 * u * v;
}

double measured(double depth_m, const KinectNoise& noise, double noise_px, uint64_t bits) {
  if (noise_px > 0 || noise.disparity_step_px > 0) {
    double disparity = kDisparityScale / depth_m + noise_px * approximate_normal(bits);
    if (noise.disparity_step_px > 0) {
      disparity = std::round(disparity / noise.disparity_step_px) * noise.disparity_step_px;
    }
    depth_m = disparity > 0 ? kDisparityScale / disparity : 0;
  }
  return depth_m < noise.min_depth_m || depth_m > noise.max_depth_m ? 0 : depth_m;
}

}  // namespace

double disparity_noise_px(const KinectNoise& noise) {
  // sigma_d = sigma_z scale / z^2; uniform quantisation adds step^2 / 12.
  const double total = noise.depth_noise_per_m * kDisparityScale;
  return std::sqrt(std::max(0.0, total * total - noise.disparity_step_px * noise.disparity_step_px / 12));
}

cv::Mat measured_depth(const ExactDepth& exact, const KinectNoise& noise, uint64_t seed, int threads) {
  const cv::Size size = exact.depth_m.size();
  cv::Mat result(size, CV_32FC1);
  const double noise_px = noise.depth_noise_per_m > 0 ? disparity_noise_px(noise) : 0;
  const double disparity_scale = kDisparityScale * size.width / 640.0;
  parallel_for(static_cast<size_t>(size.height), threads, [&](size_t begin, size_t end) {
    std::vector<uint8_t> shadow(static_cast<size_t>(size.width), 0);
    for (int y = static_cast<int>(begin); y < static_cast<int>(end); ++y) {
      const auto* depth_m = exact.depth_m.ptr<float>(y);
      const auto* cosine = exact.cosine.ptr<float>(y);
      if (noise.holes) cast_shadow(depth_m, size.width, disparity_scale, shadow);
      for (int x = 0; x < size.width; ++x) {
        const uint64_t bits = hash(
            seed, static_cast<uint64_t>(y) * static_cast<uint64_t>(size.width) + static_cast<uint64_t>(x));
        double z = static_cast<double>(depth_m[x]);
        if (noise.depth_distortion > 0) z *= 1 + noise.depth_distortion * warp_at(x, y, size);
        z = measured(z, noise, noise_px, bits);
        if (noise.holes && z > 0) {
          constexpr double kEdgeLoss = 0.7;  // fraction of edge pixels lost
          const double chance = uniform(hash(bits, 1));
          const bool lost = shadow[static_cast<size_t>(x)] != 0 || cosine[x] <= 0 ||
                            chance < grazing_loss(cosine[x]) ||
                            (chance < kEdgeLoss && at_edge(exact.depth_m, y, x));
          if (lost) z = 0;
        }
        result.at<float>(y, x) = static_cast<float>(z);
      }
    }
  });
  return result;
}

double gain_at(const KinectNoise& noise, double time_s) {
  constexpr double kSlow_s = 7.3, kFast_s = 3.1;
  constexpr double kTwoPi = 2 * std::numbers::pi;
  return 1 + noise.gain_change *
                 (0.6 * std::sin(kTwoPi * time_s / kSlow_s) + 0.4 * std::sin(kTwoPi * time_s / kFast_s));
}

float noisy_level(float level, const KinectNoise& noise, uint32_t random_bits) {
  // Half of the variance at mid grey is read-out noise, half shot noise.
  constexpr float kMidGrey = 128;
  const float sigma = static_cast<float>(noise.image_noise) * std::sqrt(0.5F + 0.5F * level / kMidGrey);
  // Sum of two 16-bit parts: a triangular deviate of variance 1.
  const float sum = static_cast<float>(random_bits & 0xffff) + static_cast<float>(random_bits >> 16);
  constexpr float kMean = 65535, kInverseSigma = 2.4494897F / 65536;
  return level + sigma * (sum - kMean) * kInverseSigma;
}

}  // namespace sim
}  // namespace kinloop
