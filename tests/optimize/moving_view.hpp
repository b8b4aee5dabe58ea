#pragma once
// Points observed by a moving rolling-shutter camera: ground truth for tests of the pose solvers.

#include "kinloop/optimize/pose/moving_pose.hpp"
#include "tests/optimize/synthetic_view.hpp"

namespace kinloop::test {

inline SensorVector rolling_sensor() {
  SensorVector sensor = SensorVector::Zero();
  sensor(kRollingShutter) = 0.03;
  sensor(kDepthDelay) = 0.015;
  sensor(kDepthShutter) = 0.03;
  return sensor;
}

/// Simulates points measured by a moving rolling-shutter camera.
inline std::vector<PoseObservation> observe_moving(const RollingShutterPose& truth,
                                                   const SensorVector& sensor, int count, double sigma_px,
                                                   Random& random) {
  std::vector<PoseObservation> observations;
  for (const auto& still : make_view(truth.T_world_camera, count, {}, random)) {
    PoseObservation o;
    o.p_reference = still.p_reference;
    o.row = still.pixel.y() / kinect().height - 0.5;
    const SE3 T_color = propagate_pose(truth.T_world_camera, truth.velocity, sensor(kRollingShutter) * o.row);
    o.depth_stamp_difference_s = sensor.isZero(0) ? 0 : -0.012;
    const double depth_s = o.depth_stamp_difference_s + sensor(kDepthDelay) + sensor(kDepthShutter) * o.row;
    const SE3 T_depth = propagate_pose(truth.T_world_camera, truth.velocity, depth_s);
    o.pixel = kinect().project(T_color.inverse() * o.p_reference) + sigma_px * gaussian_vector<2>(random);
    if (still.depth_m > 0) o.depth_m = (T_depth.inverse() * o.p_reference).z();
    observations.push_back(o);
  }
  return observations;
}

inline RollingShutterPose random_moving_pose(Random& random) {
  RollingShutterPose pose{random_motion(random, 1.0, 1.0), {}};
  pose.velocity = {random_vector(random, 0.5), random_vector(random, 1.0)};
  return pose;
}

}  // namespace kinloop::test
