#pragma once
// A map of random numbers, as a file holds it.

#include <cmath>
#include <limits>

#include <opencv2/core.hpp>

#include "kinloop/core/random.hpp"
#include "kinloop/io/map_file/map_file.hpp"

namespace kinloop::test {

inline constexpr size_t kKeyframes = 12, kKeypoints = 60, kImages = 5;

inline Features some_features(Random& random) {
  Features features;
  for (size_t i = 0; i < kKeypoints; ++i) {
    const auto number = [&] { return static_cast<float>(random.uniform(-1, 1) * 600); };
    const auto pixel = [&] {
      const float y = number();
      return Eigen::Vector2f(number(), y);
    };
    features.pixels.push_back(pixel());
    features.depths_m.push_back(i % 3 == 0 ? 0 : std::abs(number()));
    features.raw_pixels.push_back(pixel());
    features.measured_pixels.push_back(pixel());
    features.measured_depths_m.push_back(std::abs(number()));
    features.inverse_depth_gradients.emplace_back(number(), std::numeric_limits<float>::quiet_NaN());
    features.levels.push_back(static_cast<int>(i % 8));
    features.angles_rad.push_back(number());
    features.sigmas_px.push_back(1 + std::abs(number()));
  }
  features.depth_stamp_difference_s = static_cast<float>(random.uniform(-0.02, 0.02));
  features.descriptors = cv::Mat(static_cast<int>(kKeypoints), 32, CV_8UC1);
  for (int row = 0; row < features.descriptors.rows; ++row) {
    for (int col = 0; col < 32; ++col)
      features.descriptors.at<uint8_t>(row, col) = static_cast<uint8_t>(random.uniform(0, 255));
  }
  return features;
}

inline SE3 some_pose(Random& random) {
  Vector6d twist;
  for (int i = 0; i < 6; ++i) twist(i) = random.uniform(-1, 1);
  return SE3::exp(twist);
}

/// Two disconnected components; keypoint i of every keyframe of a component observes its landmark i.
inline Map some_map(Random& random) {
  Map map;
  std::vector<LandmarkId> landmarks;
  for (uint32_t k = 0; k < kKeyframes; ++k) {
    const bool begins = k % (kKeyframes / 2) == 0;
    const uint32_t component = begins ? map.component_count() : map.component_count() - 1;
    const auto features = std::make_shared<const Features>(some_features(random));
    const KeyframeId id = map.add_keyframe(FrameId{3 * k}, 100 * k, some_pose(random), features, component);
    if (begins) landmarks.clear();
    for (uint32_t i = 0; i < kKeypoints; ++i) {
      if (begins) {
        landmarks.push_back(map.add_landmark(id, i, {random.uniform(-1, 1), -0.0, random.uniform(1, 2)}));
      } else {
        map.add_observation(landmarks[i], {id, i});
      }
    }
  }
  map.erase(LandmarkId{5});
  map.add_loop_closure({KeyframeId{0},
                        KeyframeId{4},
                        some_pose(random),
                        3.5 * Matrix6d::Identity(),
                        {77},
                        LoopStage::kVerified});
  map.record_loop({.a = KeyframeId{2},
                   .b = KeyframeId{8},
                   .T_a_b = some_pose(random),
                   .information = 2 * Matrix6d::Identity(),
                   .evidence = {.inliers = 41, .scale = {0.93, 0.004}},
                   .stage = LoopStage::kRejected,
                   .support = 3,
                   .reason = LoopReason::kScale});
  map.record_loop({.a = KeyframeId{3},
                   .b = KeyframeId{9},
                   .T_a_b = some_pose(random),
                   .stage = LoopStage::kProvisional,
                   .reason = LoopReason::kAmbiguous});
  return map;
}

inline SavedMap some_saved_map() {
  Random random(7);
  SavedMap saved;
  saved.program = "kinloop test";
  saved.sessions = {{"a folder/with ümlaut", FrameId{0}}, {"another", FrameId{20}}};
  saved.options = {{"features.count", "1000"}, {"seed", "1"}};
  const LensDistortion lens{LensModel::kBrownConrady, 0.26, -0.95, -0.005, 0.0026, 1.16};
  saved.camera.color = {160, 120, 129.3, 129.1, 79.6, 63.8, lens};
  const LensDistortion rational{LensModel::kRational, 3.13, 2.32, 8e-5, -5e-5, 0.13, 3.46, 3.35, 0.66};
  saved.camera.depth = PinholeCamera{640, 480, 585, 585, 320, 240, rational};
  saved.camera.T_color_depth = some_pose(random);
  saved.camera.rolling_shutter_s = 0.1 + 0.2;  // many decimals
  saved.camera.sensor.set_by_source(DepthSensorModel::kIphone);
  saved.sensor = {{1e-300, 0.1, true}, {-0.0, 0, false}};
  saved.map = some_map(random).data();
  for (uint32_t i = 0; i < 3 * kKeyframes; ++i) {
    TrackedFrame frame;
    frame.id = FrameId{i};
    frame.stamp_ns = 33 * i;
    frame.outcome = TrackingOutcome::kTracked;
    if (i % 3 == 1) frame.method = TrackingMethod::kRepeat;
    if (i == 5) frame.method = TrackingMethod::kPredicted;
    frame.reference = KeyframeId{i / 3};
    if (i % 3 == 0) frame.keyframe = KeyframeId{i / 3};
    frame.T_reference_camera = some_pose(random);
    frame.depth_stamp_difference_s = static_cast<float>(random.uniform(-0.02, 0.02));
    if (i % 5 == 2) doubt(frame, DoubtCause::kPlace);
    saved.frames.push_back(frame);
  }
  return saved;
}

inline SavedImages some_images(size_t index) {
  cv::Mat color(120, 160, CV_8UC3), depth_m(120, 160, CV_32FC1);
  cv::RNG random(index + 1);
  random.fill(color, cv::RNG::UNIFORM, 0, 256);
  random.fill(depth_m, cv::RNG::UNIFORM, 0, 10);
  return {FrameId{static_cast<uint32_t>(3 * index)}, encode_images(color, depth_m, {}).encoded};
}

}  // namespace kinloop::test
