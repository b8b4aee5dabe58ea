// bench_growth: what grows with the map on the thread that tracks. Times the work that Slam::process does
// besides tracking at a keyframe, in maps of 10 to 10,000 keyframes of a corridor that is walked once.
// Copies for the back end stand in the column of the longest frame: they happen at few frames, but delay one.

#include <algorithm>
#include <vector>

#include <fmt/format.h>

#include "kinloop/back_end/self_calibration.hpp"
#include "kinloop/core/random.hpp"
#include "kinloop/core/stopwatch.hpp"
#include "kinloop/loop/correction/correct_loop.hpp"
#include "kinloop/map/local_map.hpp"
#include "kinloop/mapping/bundle_adjustment.hpp"
#include "kinloop/tracking/motion/motion_compensation.hpp"

namespace kinloop {
namespace {

constexpr uint32_t kNewPerKeyframe = 80, kSeenBy = 4;  // landmarks, and the keyframes that see each
constexpr uint32_t kKeypoints = kNewPerKeyframe * kSeenBy;
constexpr double kStep_m = 0.3, kDepth_m = 2;

RgbdCamera some_camera() {
  RgbdCamera camera;
  camera.color = {640, 480, 525, 525, 319.5, 239.5, {}};
  camera.rolling_shutter_s = 0.03;
  return camera;
}

std::shared_ptr<const Features> some_features(Random& random) {
  Features features;
  for (uint32_t i = 0; i < kKeypoints; ++i) {
    const Eigen::Vector2d pixel(random.uniform(0, 639), random.uniform(0, 479));
    features.pixels.push_back(pixel.cast<float>());
    features.depths_m.push_back(static_cast<float>(kDepth_m));
    features.levels.push_back(0);
    features.angles_rad.push_back(0);
    features.sigmas_px.push_back(1);
  }
  features.raw_pixels = features.measured_pixels = features.pixels;
  features.measured_depths_m = features.depths_m;
  features.descriptors = cv::Mat(static_cast<int>(kKeypoints), 32, CV_8UC1, cv::Scalar(0));
  return std::make_shared<const Features>(std::move(features));
}

/// Compensates all keyframes for their motion, as when the times of the sensor have been estimated.
void deskew(const Map& map, const Sensor& sensor) {
  const Velocity velocity{{0.3, 0, 0.1}, {0, 0.5, 0.1}};
  for (const Keyframe& keyframe : map.keyframes()) deskew_features(*keyframe.features, sensor, velocity);
}

/// Keyframe k first sees the landmarks k * kNewPerKeyframe and following, which the next ones see again.
Map corridor(uint32_t keyframes) {
  Map map;
  Random random(1);
  const auto features = some_features(random);
  for (uint32_t k = 0; k < keyframes; ++k) {
    const SE3 T_world_camera{Eigen::Quaterniond::Identity(), {kStep_m * k, 0, 0}};
    const KeyframeId id = map.add_keyframe(FrameId{k}, int64_t{k} * 500'000'000, T_world_camera, features);
    for (uint32_t i = 0; i < kKeypoints; ++i) {
      const uint32_t age = i / kNewPerKeyframe;
      if (age == 0) {
        map.add_landmark(id, i, some_camera().color.unproject(features->pixels[i].cast<double>(), kDepth_m));
      } else if (age <= k) {
        map.add_observation(LandmarkId{(k - age) * kNewPerKeyframe + i % kNewPerKeyframe}, {id, i});
      }
    }
  }
  return map;
}

/// Returns the median CPU time of a few calls, ms: other jobs on the machine do not add to it.
template <class Work>
double time_ms(const Work& work) {
  constexpr int kCalls = 5;
  std::vector<double> times_ms;
  for (int call = 0; call < kCalls; ++call) {
    const Stopwatch watch;
    work();
    times_ms.push_back(1e3 * watch.cpu_s());
  }
  std::nth_element(times_ms.begin(), times_ms.begin() + kCalls / 2, times_ms.end());
  return times_ms[kCalls / 2];
}

/// A correction of all keyframes, as that of a loop.
MapUpdate correction_of(const Map& map) {
  MapUpdate update;
  for (const Keyframe& keyframe : map.keyframes())
    update.T_world_camera.emplace_back(keyframe.id, keyframe.T_world_camera);
  update.newest_keyframe = map.keyframes().back().id;
  update.epoch = map.epoch();
  return update;
}

void measure(uint32_t keyframes) {
  const Map map = corridor(keyframes);
  const Sensor sensor = make_sensor(some_camera());
  const KeyframeId newest = map.keyframes().back().id;
  const double local_map_ms = time_ms([&] { make_local_map(map, newest, {}); }),
               local_ba_ms = time_ms([&] { make_local_ba_problem(map, newest, sensor, {}); }),
               global_ba_ms = time_ms([&] { make_global_ba_problem(map, sensor); }),
               calibration_ms = time_ms(
                   [&] { make_self_calibration_problem(map, sensor, std::vector<Velocity>(keyframes)); }),
               deskew_ms = time_ms([&] { deskew(map, sensor); }),
               pose_graph_ms = time_ms([&] { make_pose_graph(map, {}); });
  Map corrected = map;
  const MapUpdate correction = correction_of(map);
  const double apply_ms = time_ms([&] { corrected.apply(correction); });
  fmt::print("{:9} {:12.2f} {:12.2f} {:12.1f} {:14.1f} {:12.1f} {:12.1f} {:12.1f}\n", keyframes, local_map_ms,
             local_ba_ms, global_ba_ms, calibration_ms, deskew_ms, pose_graph_ms, apply_ms);
}

}  // namespace
}  // namespace kinloop

int main() {
  fmt::print(
      "ms        every keyframe            now and then\n{:>9} {:>12} {:>12} {:>12} {:>14} {:>12} {:>12} "
      "{:>12}\n",
      "keyframes", "local map", "local BA", "global BA", "calibration", "deskewing", "pose graph",
      "correction");
  for (const uint32_t keyframes : {10U, 200U, 400U, 1000U, 10000U}) kinloop::measure(keyframes);
}
