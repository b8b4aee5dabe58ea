// The hot kernels, each on input of the size of a 640x480 frame. Run: build/release/bench/bench_kernels

#include <array>

#include <benchmark/benchmark.h>
#include <opencv2/features2d.hpp>

#include "kinloop/core/random.hpp"
#include "kinloop/features/extraction/extractor.hpp"
#include "kinloop/features/matcher.hpp"
#include "kinloop/map/local_map.hpp"
#include "kinloop/optimize/bundle/bundle.hpp"
#include "kinloop/optimize/pose/camera_observations.hpp"
#include "kinloop/place/vocabulary/default_vocabulary.hpp"
#include "kinloop/tracking/keypoint_tracking.hpp"
#include "simulator/simulated_source.hpp"

namespace kinloop {
namespace {

/// Two successive frames of the simulated room.
struct Frames {
  PinholeCamera camera;
  Frame first, second;

  Frames() {
    const auto source = make_simulated_source("sim:room", {}, 2);
    camera = source->camera().color;
    first = prepare(source->frame(100));
    second = prepare(source->frame(101));
  }

  [[nodiscard]] Frame prepare(const Frame& frame) const {
    Frame prepared;
    prepared.id = frame.id;
    prepared.stamp_ns = frame.stamp_ns;
    prepared.depth_m = frame.depth_m;
    prepared.gray = frame.color.gray();
    prepared.features =
        std::make_shared<const Features>(extract_features(prepared.gray, frame.depth_m, Sensor{camera}, {}));
    return prepared;
  }
};

const Frames& frames() {
  static const Frames kFrames;
  return kFrames;
}

void extract_orb(benchmark::State& state) {
  const Frames& input = frames();
  const Sensor sensor{input.camera};
  for (auto _ : state) {
    benchmark::DoNotOptimize(extract_features(input.first.gray, input.first.depth_m, sensor, {}));
  }
}
BENCHMARK(extract_orb)->Unit(benchmark::kMillisecond);

void extract_orb_without_depth(benchmark::State& state) {
  const Frames& input = frames();
  const Sensor sensor{input.camera};
  for (auto _ : state) {
    benchmark::DoNotOptimize(extract_features(input.first.gray, cv::Mat(), sensor, {}));
  }
}
BENCHMARK(extract_orb_without_depth)->Unit(benchmark::kMillisecond);

void extract_orb_opencv(benchmark::State& state) {
  cv::setNumThreads(1);
  const auto orb = cv::ORB::create(1000, 1.2F, 8);
  for (auto _ : state) {
    std::vector<cv::KeyPoint> points;
    cv::Mat descriptors;
    orb->detectAndCompute(frames().first.gray, cv::noArray(), points, descriptors);
    benchmark::DoNotOptimize(descriptors);
  }
}
BENCHMARK(extract_orb_opencv)->Unit(benchmark::kMillisecond);

void match_all(benchmark::State& state) {
  const cv::Mat& a = frames().first.features->descriptors;
  const cv::Mat& b = frames().second.features->descriptors;
  for (auto _ : state) benchmark::DoNotOptimize(match_brute_force(a, b, true));
}
BENCHMARK(match_all)->Unit(benchmark::kMillisecond);

void words_of_image(benchmark::State& state) {
  const Vocabulary vocabulary = load_default_vocabulary();
  for (auto _ : state) benchmark::DoNotOptimize(vocabulary.quantize(frames().first.features->descriptors));
}
BENCHMARK(words_of_image)->Unit(benchmark::kMillisecond);

void load_vocabulary(benchmark::State& state) {
  for (auto _ : state) benchmark::DoNotOptimize(load_default_vocabulary());
}
BENCHMARK(load_vocabulary)->Unit(benchmark::kMillisecond);

void track_frame(benchmark::State& state) {
  const Features& features = *frames().first.features;
  Map map;
  const KeyframeId keyframe = map.add_keyframe(FrameId{0}, 0, SE3{}, frames().first.features);
  for (uint32_t i = 0; i < features.size(); ++i) {
    const auto depth_m = static_cast<double>(features.depths_m[i]);
    if (depth_m > 0) {
      map.add_landmark(keyframe, i, frames().camera.unproject(features.pixels[i].cast<double>(), depth_m));
    }
  }
  const LocalMap view = make_local_map(map, keyframe, {});
  TrackedFrame previous = unlocated(frames().first);
  previous.outcome = TrackingOutcome::kTracked;
  previous.reference = keyframe;
  previous.frame = std::make_shared<const Frame>(frames().first);
  const auto& landmark_of = map.keyframe(keyframe).landmark_of;
  for (uint32_t i = 0; i < landmark_of.size(); ++i) {
    if (landmark_of[i].valid()) previous.matches.push_back({landmark_of[i], i});
  }
  const Sensor sensor{frames().camera};
  const TrackingOptions options;
  for (auto _ : state) {
    benchmark::DoNotOptimize(
        track_keypoints({frames().second, view, sensor, options}, previous, {SE3{}, 0.01, 0.02}, 1));
  }
}
BENCHMARK(track_frame)->Unit(benchmark::kMillisecond);

/// A thousand keypoints as seen by one moving camera.
CameraObservations thousand_observations() {
  constexpr size_t kCount = 1000;
  const PinholeCamera& camera = frames().camera;
  CameraObservations observations(kCount);
  Random random(1);
  for (size_t i = 0; i < kCount; ++i) {
    KeypointMeasurement seen;
    seen.pixel = {random.uniform(0, camera.width), random.uniform(0, camera.height)};
    seen.depth_m = random.uniform(0.7, 4);
    seen.row = seen.pixel.y() / camera.height - 0.5;
    observations.set(i, camera.unproject(seen.pixel, seen.depth_m), seen);
  }
  return observations;
}

/// Residuals and Jacobians of all, and their normal equations: with respect to the pose; the pose and
/// velocity; these, the sensor parameters and the point.
void linearize_thousand(benchmark::State& state) {
  const auto observations = thousand_observations();
  const Sensor sensor{frames().camera};
  const BundleView view(SE3{}, Velocity::from_vector(Vector6d::Constant(0.1)));
  const std::array layouts{LinearColumns::of_pose(), LinearColumns::of_pose_and_velocity(),
                           LinearColumns::of_all()};
  for (auto _ : state)
    benchmark::DoNotOptimize(
        observations.linearize(view, sensor, layouts.at(static_cast<size_t>(state.range(0)))));
}
BENCHMARK(linearize_thousand)->DenseRange(0, 2)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace kinloop
