// Each kernel on each instruction set of this machine. Run: build/release/bench/bench_simd

#include <benchmark/benchmark.h>
#include <opencv2/imgproc.hpp>

#include "kinloop/base/random.hpp"
#include "kinloop/features/hamming.hpp"
#include "kinloop/features/kernels/corner_scores.hpp"
#include "kinloop/features/kernels/gaussian_blur.hpp"
#include "kinloop/features/kernels/hamming_rows.hpp"
#include "kinloop/features/kernels/orientation.hpp"
#include "kinloop/features/kernels/steered_brief.hpp"
#include "kinloop/optimize/kernels/gram.hpp"
#include "kinloop/optimize/pose/camera_observations.hpp"
#include "tests/support/simd_targets.hpp"

namespace kinloop {
namespace {

constexpr int kCount = 1000;  // keypoints of an image

/// Smoothed noise of 640 x 480 pixels.
cv::Mat noise_image() {
  cv::Mat image(480, 640, CV_8UC1);
  Random random(1);
  for (int y = 0; y < image.rows; ++y) {
    for (int x = 0; x < image.cols; ++x) image.at<uint8_t>(y, x) = static_cast<uint8_t>(random.index(256));
  }
  cv::GaussianBlur(image, image, {}, 1.5);
  return image;
}

/// The image, positions on it, descriptors, and observations of one camera.
struct Input {
  cv::Mat image = noise_image();
  std::vector<cv::Point> corners;
  cv::Mat descriptors{kCount, kOrbBytes, CV_8UC1};
  std::vector<uint32_t> indices;  // of the descriptors, as windowed matching selects them
  PinholeCamera camera;
  CameraObservations observations{kCount};

  Input() {
    camera.width = 640;
    camera.height = 480;
    camera.fx = camera.fy = 525;
    camera.cx = 320;
    camera.cy = 240;
    Random random(2);
    for (int i = 0; i < kCount; ++i) {
      corners.emplace_back(20 + static_cast<int>(random.index(600)), 20 + static_cast<int>(random.index(440)));
      describe_corner(image, corners.back().x, corners.back().y, static_cast<float>(random.uniform(0, 360)),
                      descriptors.ptr(i));
      indices.push_back(random.index(kCount));
      KeypointMeasurement seen;
      seen.pixel = {corners.back().x, corners.back().y};
      seen.depth_m = random.uniform(0.7, 4);
      seen.row = seen.pixel.y() / camera.height - 0.5;
      observations.set(static_cast<size_t>(i), camera.unproject(seen.pixel, seen.depth_m), seen);
    }
  }
};

const Input& input() {
  static const Input kInput;
  return kInput;
}

void corners_of_image() {
  benchmark::DoNotOptimize(find_corners(input().image, 12, 16));
}

void blur_of_image() {
  benchmark::DoNotOptimize(gaussian_blur(input().image));
}

void orientations() {
  for (const cv::Point& at : input().corners)
    benchmark::DoNotOptimize(disc_moments(input().image, at.x, at.y));
}

void descriptors() {
  uint8_t descriptor[kOrbBytes];
  for (const cv::Point& at : input().corners) {
    describe_corner(input().image, at.x, at.y, 30.0F, descriptor);
    benchmark::DoNotOptimize(descriptor);
  }
}

void all_distances() {
  static const TransposedDescriptors kTransposed(input().descriptors.ptr(), kCount);
  std::vector<uint16_t> distances(kTransposed.padded_count());
  for (int i = 0; i < kCount; ++i) kTransposed.distances_from(input().descriptors.ptr(i), distances);
  benchmark::DoNotOptimize(distances.data());
}

void nearest_keys() {
  const std::vector<uint16_t> distances(1024, 100);
  std::vector<uint32_t> keys(distances.size(), kNoKey);
  for (uint32_t i = 0; i < kCount; ++i) benchmark::DoNotOptimize(nearest_key(distances, i, keys.data()));
}

void windowed_distances() {
  uint16_t distances[kCount];
  const cv::Mat& rows = input().descriptors;
  hamming_to_rows(rows.ptr(), rows.ptr(), input().indices, distances);
  benchmark::DoNotOptimize(distances);
}

void normal_equations() {
  const SensorVector sensor = SensorVector::Zero();
  const MeasurementModel model{input().camera, sensor, 6e-3, 0.5};
  const BundleView view(SE3{}, Velocity::from_vector(Vector6d::Constant(0.1)));
  benchmark::DoNotOptimize(input().observations.linearize(view, model, RowLayout(true, true)));
}

void gram_matrix() {
  static const std::vector<double> kRows(3 * kCount * kMaxGramWidth, 0.5);
  std::vector<double> gram(kMaxGramWidth * kMaxGramWidth);
  add_gram(kRows.data(), 3 * kCount, kMaxGramWidth, gram.data());
  benchmark::DoNotOptimize(gram.data());
}

using Kernel = void (*)();

void register_kernel(const std::string& name, Kernel kernel) {
  const auto all = hwy::SupportedTargets();
  for (auto left = all; left != 0; left &= left - 1) {
    const auto target = left & -left;
    if ((target & HWY_TARGETS) == 0) continue;
    const auto run = [kernel, target](benchmark::State& state) {
      test::force_simd_target(target);
      for (auto _ : state) kernel();
      test::force_simd_target(0);
    };
    benchmark::RegisterBenchmark((name + "/" + hwy::TargetName(target)).c_str(), run)
        ->Unit(benchmark::kMicrosecond);
  }
}

}  // namespace
}  // namespace kinloop

int main(int argc, char** argv) {
  using namespace kinloop;
  register_kernel("corners of an image", corners_of_image);
  register_kernel("blur of an image", blur_of_image);
  register_kernel("1000 orientations", orientations);
  register_kernel("1000 descriptors", descriptors);
  register_kernel("1000 x 1000 distances", all_distances);
  register_kernel("1000 x 1024 nearest keys", nearest_keys);
  register_kernel("1000 windowed distances", windowed_distances);
  register_kernel("normal equations of 1000 observations", normal_equations);
  register_kernel("J'J of 3000 x 32", gram_matrix);
  benchmark::Initialize(&argc, argv);
  benchmark::RunSpecifiedBenchmarks();
}
