#pragma once
// A map built from the synthetic world along given poses, and frames of it: ground truth for tracking,
// mapping, loop.

#include <map>

#include "kinloop/map/frames/tracked_frame.hpp"
#include "kinloop/map/map.hpp"
#include "kinloop/sensor/frame.hpp"
#include "tests/support/synthetic_world.hpp"

namespace kinloop::test {

/// A map whose landmark k represents a known point of the world.
struct SyntheticMap {
  Map map;
  std::map<uint32_t, LandmarkId> landmark_of_point;
};

inline Frame make_frame(uint32_t id, const SyntheticView& view) {
  Frame frame;
  frame.id = FrameId{id};
  frame.stamp_ns = id * 33'333'333LL;
  frame.features = view.features;
  frame.depth_m = cv::Mat(480, 640, CV_32FC1, cv::Scalar(0.0F));
  frame.gray = cv::Mat(480, 640, CV_8UC1, cv::Scalar(0));
  return frame;
}

/// Adds a keyframe at `T_world_camera` (which may differ from the view's true pose) with true associations.
inline KeyframeId add_view(SyntheticMap& built, const SyntheticWorld& world, const SyntheticView& view,
                           const SE3& T_world_camera) {
  Map& map = built.map;
  const auto number = static_cast<uint32_t>(map.keyframes().size());
  const KeyframeId id =
      map.add_keyframe(FrameId{number}, number * 100'000'000LL, T_world_camera, view.features);
  for (uint32_t i = 0; i < view.point_of.size(); ++i) {
    const auto known = built.landmark_of_point.find(view.point_of[i]);
    const auto depth_m = static_cast<double>(view.features->depths_m[i]);
    if (known != built.landmark_of_point.end()) {
      map.add_observation(known->second, {id, i});
    } else if (depth_m > 0) {
      const Eigen::Vector3d point = world.camera.unproject(view.features->pixels[i].cast<double>(), depth_m);
      built.landmark_of_point[view.point_of[i]] = map.add_landmark(id, i, point);
    }
  }
  return id;
}

/// Returns a frame tracked exactly at a keyframe, with its landmarks.
inline TrackedFrame tracked_as(KeyframeId keyframe, const Map& map, const Frame& frame) {
  TrackedFrame tracked = unlocated(frame);
  tracked.outcome = TrackingOutcome::kTracked;
  tracked.reference = keyframe;
  tracked.frame = std::make_shared<const Frame>(frame);
  const auto& landmark_of = map.keyframe(keyframe).landmark_of;
  for (uint32_t i = 0; i < landmark_of.size(); ++i) {
    if (landmark_of[i].valid()) tracked.matches.push_back({landmark_of[i], i});
  }
  return tracked;
}

/// Moves the whole map: keyframes, and the landmarks with them.
inline void move_world(Map& map, const SE3& T_new_world) {
  MapUpdate update;
  update.epoch = map.epoch();
  for (const Keyframe& keyframe : map.keyframes())
    update.T_world_camera.emplace_back(keyframe.id, T_new_world * keyframe.T_world_camera);
  map.apply(update);
}

}  // namespace kinloop::test
