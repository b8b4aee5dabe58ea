#include "kinloop/back_end/final/final_pass.hpp"
#include "kinloop/belief/online_covariance.hpp"
#include "kinloop/belief/pose_scatter.hpp"

namespace kinloop {
namespace {

/// The first keyframe of each component, the reference of its covariances.
std::vector<KeyframeId> first_keyframes(const Map& map) {
  std::vector<KeyframeId> first(map.component_count() + 1);
  for (const Keyframe& keyframe : map.keyframes()) {
    KeyframeId& of_component = first[keyframe.component];
    if (!of_component.valid()) of_component = keyframe.id;
  }
  return first;
}

/// The scatter of every keyframe; zero if unknown.
std::vector<Matrix6d> keyframe_scatter(const FrameLog& log, const std::vector<Matrix6d>& scatter,
                                       size_t count) {
  std::vector<Matrix6d> of_keyframe(count, Matrix6d::Zero());
  for (size_t i = 0; i < log.size(); ++i) {
    if (log[i].keyframe.valid()) of_keyframe[log[i].keyframe.value] = scatter[i];
  }
  return of_keyframe;
}

}  // namespace

PoseCovariances pose_covariances(const FrameLog& log, const Map& map,
                                 const std::vector<Matrix6d>& keyframe_covariance, double scale_sigma) {
  const auto scatter = pose_scatter(log, map);
  const auto first = first_keyframes(map);
  const auto of_keyframe = keyframe_scatter(log, scatter, map.keyframes().size());
  const auto of_map = [&](KeyframeId id) -> Matrix6d {
    return id.value < keyframe_covariance.size() ? keyframe_covariance[id.value] : Matrix6d(Matrix6d::Zero());
  };
  // The first keyframe is off as well, and everything is measured from there.
  const auto since_first = [&](KeyframeId id, const SE3& T_world_camera) -> Matrix6d {
    const KeyframeId from = first[map.keyframe(id).component];
    const SE3 T_first_camera = map.keyframe(from).T_world_camera.inverse() * T_world_camera;
    return transported(of_keyframe[from.value], T_first_camera) +
           covariance_of_scale(T_first_camera, scale_sigma);
  };

  PoseCovariances all;
  for (const Keyframe& keyframe : map.keyframes()) {
    const bool is_first = first[keyframe.component] == keyframe.id;
    all.keyframes.push_back(is_first ? Matrix6d(Matrix6d::Zero())
                                     : Matrix6d(of_map(keyframe.id) + of_keyframe[keyframe.id.value] +
                                                since_first(keyframe.id, keyframe.T_world_camera)));
  }
  for (size_t i = 0; i < log.size(); ++i) {
    const LoggedFrame& entry = log[i];
    Matrix6d covariance = Matrix6d::Zero();
    if (entry.keyframe.valid()) {
      covariance = all.keyframes[entry.keyframe.value];
    } else if (!entry.is_lost() && !(entry.covariance.isZero(0) && scatter[i].isZero(0))) {
      covariance = transported(of_map(entry.reference), entry.T_reference_camera) + entry.covariance +
                   scatter[i] + since_first(entry.reference, entry.world(map));
    }
    all.frames.push_back(covariance.allFinite() ? covariance : Matrix6d(Matrix6d::Zero()));
  }
  return all;
}

}  // namespace kinloop
