// Each kernel on each instruction set of this machine. Run: build/release/bench/bench_simd

#include <benchmark/benchmark.h>
#include <opencv2/imgproc.hpp>

#include "kinloop/core/random.hpp"
#include "kinloop/features/hamming.hpp"
#include "kinloop/features/kernels/corner_scores.hpp"
#include "kinloop/features/kernels/gaussian_blur.hpp"
#include "kinloop/features/kernels/hamming_rows.hpp"
#include "kinloop/features/kernels/steered_brief.hpp"
#include "kinloop/optimize/kernels/bundle_products.hpp"
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
  cv::Mat descriptors = cv::Mat(kCount, kOrbBytes, CV_8UC1);
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
      const auto y = static_cast<int>(random.index(440)), x = static_cast<int>(random.index(600));
      corners.emplace_back(20 + x, 20 + y);
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
  const Sensor sensor{input().camera};
  const BundleView view(SE3{}, Velocity::from_vector(Vector6d::Constant(0.1)));
  benchmark::DoNotOptimize(input().observations.linearize(view, sensor, LinearColumns::of_all()));
}

void gram_matrix() {
  static const std::vector<double> kRows(3 * kCount * kMaxGramWidth, 0.5);
  std::vector<double> gram(kMaxGramWidth * kMaxGramWidth);
  add_gram(kRows.data(), 3 * kCount, kMaxGramWidth, gram.data());
  benchmark::DoNotOptimize(gram.data());
}

void products_of_points() {
  static const LinearColumns kLayout = LinearColumns::of_bundle(SensorVector::Ones());
  static const size_t kSize = PointProducts(kLayout).size();
  static const std::vector<double> kColumns(kLayout.width * kRowsPerObservation * ObservationBlock::kSize,
                                            0.5);
  static std::vector<double> values(kSize * ObservationBlock::kSize);
  std::array<double*, ObservationBlock::kSize> records;
  for (size_t i = 0; i < records.size(); ++i) records[i] = values.data() + i * kSize;
  for (size_t i = 0; i < kCount / ObservationBlock::kSize; ++i) {
    write_point_products(kLayout, kColumns.data(), records);
  }
  benchmark::DoNotOptimize(values.data());
}

void eliminated_points() {
  static const std::vector<double> kRecords(kCount * size_t{PointProducts::kPose + kEliminatedWidth}, 0.5);
  static std::vector<double> U(kCount * kEliminatedSize);
  const PointFactor factor({3, 1, 1, 3, 1, 3});
  eliminate_point(factor, kRecords.data(), PointProducts::kPose + kEliminatedWidth, kCount, U.data());
  benchmark::DoNotOptimize(U.data());
}

/// 1000 points, each seen by eight cameras.
struct SchurInput {
  static constexpr uint32_t kCameras = 8;
  static constexpr size_t kBorder = 11;
  std::vector<SchurColumn::Slot> slots;
  std::vector<uint32_t> blocks;
  std::vector<int> cameras;
  std::vector<double> U = std::vector<double>(kCount * kCameras * kEliminatedSize, 0.5);
  std::vector<double> border = std::vector<double>(kCount * size_t{3} * kBorder, 0.5);

  SchurInput() {
    for (uint32_t camera = 0; camera < kCameras; ++camera) blocks.push_back(camera);
    for (uint32_t point = 0; point < kCount; ++point) {
      slots.push_back({point * kCameras, point * kCameras, (point + 1) * kCameras, point});
      for (uint32_t camera = 0; camera < kCameras; ++camera) cameras.push_back(static_cast<int>(camera));
    }
  }
};

void schur_column() {
  static const SchurInput kInput;
  const SchurColumn column{kInput.slots,         kInput.blocks,       kInput.cameras.data(), kInput.U.data(),
                           kInput.border.data(), SchurInput::kBorder, SchurInput::kBorder};
  std::vector<double> blocks(SchurInput::kCameras * kSchurBlockSize);
  std::vector<double> right(SchurInput::kBorder * kEliminatedWidth);
  add_schur_column(column, blocks.data(), right.data());
  benchmark::DoNotOptimize(blocks.data());
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
  register_kernel("products of 1000 observations with their points", products_of_points);
  register_kernel("elimination of points, 1000 observations", eliminated_points);
  register_kernel("Schur complement, 1000 points in 8 cameras", schur_column);
  register_kernel("J'J of 3000 x 32", gram_matrix);
  benchmark::Initialize(&argc, argv);
  benchmark::RunSpecifiedBenchmarks();
}
