#pragma once
// In: a moment of a scene and a time-of-flight camera with its lamp. Out: how much too far each surface
// seems, because light also reaches it by way of others.

#include "kinloop/geometry/camera.hpp"
#include "simulator/render/moment.hpp"

namespace kinloop::sim {

/// Returns the error of range, 32FC1 of the camera's size, m: one reflection on the way, from surfaces that
/// reflect in all directions alike (Jimenez et al. 2014, "Modeling and correction of multipath interference
/// in time of flight cameras"). It rounds concave corners; a plane alone has none. Computed for blocks of
/// pixels and interpolated.
cv::Mat multipath_error_m(const Moment& moment, const PinholeCamera& camera, const SE3& T_room_camera,
                          int threads);

}  // namespace kinloop::sim
