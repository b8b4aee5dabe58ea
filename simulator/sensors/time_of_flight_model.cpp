#include <cmath>
#include <complex>
#include <numbers>

#include "kinloop/core/random.hpp"
#include "kinloop/core/threads/parallel_for.hpp"
#include "simulator/sensors/depth_models.hpp"
#include "simulator/sensors/deviates.hpp"

namespace kinloop {

TimeOfFlightNoise TimeOfFlightNoise::none() {
  TimeOfFlightNoise ideal;
  ideal.noise_floor_m = ideal.noise_per_m = 0;
  ideal.flying_pixels = ideal.multipath = false;
  ideal.min_depth_m = 0;
  ideal.max_depth_m = 5;
  return ideal;
}

namespace sim {
namespace {

constexpr double kRadPerM = 2 * std::numbers::pi / kUnambiguousRange_m;

/// Light as a pixel receives it: its strength, 1 for a white surface head-on at 1 m, and its phase. Light of
/// two surfaces adds up as complex numbers, which puts the pixel between both ("flying pixels", Reynolds et
/// al. 2011, "Capturing time-of-flight data with confidence").
std::complex<double> received_light(const TimeOfFlightRays& view, int y, int x) {
  const int samples = view.exact.depth_m.channels();
  const auto range_per_depth = static_cast<double>(view.range_per_depth.at<float>(y, x));
  const auto value = [&](const cv::Mat& image, int sample) {
    return static_cast<double>(image.ptr<float>(y)[x * samples + sample]);
  };
  std::complex<double> sum(0, 0);
  for (int i = 0; i < samples; ++i) {
    const double range_m = value(view.exact.depth_m, i) * range_per_depth;
    const double strength =
        value(view.exact.reflectance, i) * value(view.exact.cosine, i) / (range_m * range_m);
    if (strength > 0) sum += std::polar(strength / samples, kRadPerM * range_m);
  }
  return sum;
}

/// Noise is in inverse proportion to the strength of the light, since ambient light and the electronics make
/// most of it (Lange and Seitz 2001, "Solid-state time-of-flight range camera").
double noise_m(const TimeOfFlightNoise& noise, double strength) {
  return std::hypot(noise.noise_floor_m, noise.noise_per_m / strength);
}

double measured_m(const TimeOfFlightRays& view, const TimeOfFlightNoise& noise, int y, int x, uint64_t bits) {
  const std::complex<double> light = received_light(view, y, x);
  const double strength = std::abs(light);
  if (!(strength > 0)) return 0;
  const double sigma_m = noise_m(noise, strength);
  if (sigma_m > noise.max_noise_m) return 0;
  const double phase = std::arg(light);
  double range_m = (phase < 0 ? phase + 2 * std::numbers::pi : phase) / kRadPerM;
  if (!view.range_error_m.empty()) range_m += static_cast<double>(view.range_error_m.at<float>(y, x));
  range_m += sigma_m * approximate_normal(bits);
  const double depth_m = range_m / static_cast<double>(view.range_per_depth.at<float>(y, x));
  return depth_m < noise.min_depth_m || depth_m > noise.max_depth_m ? 0 : depth_m;
}

}  // namespace

cv::Mat measured_depth(const TimeOfFlightRays& view, const TimeOfFlightNoise& noise, uint64_t seed,
                       int threads) {
  const cv::Size size = view.exact.depth_m.size();
  cv::Mat result(size, CV_32FC1);
  parallel_for(static_cast<size_t>(size.height), threads, [&](size_t begin, size_t end) {
    for (int y = static_cast<int>(begin); y < static_cast<int>(end); ++y) {
      for (int x = 0; x < size.width; ++x) {
        const uint64_t bits = hash(
            seed, static_cast<uint64_t>(y) * static_cast<uint64_t>(size.width) + static_cast<uint64_t>(x));
        result.at<float>(y, x) = static_cast<float>(measured_m(view, noise, y, x, bits));
      }
    }
  });
  return result;
}

}  // namespace sim
}  // namespace kinloop
