#include "kinloop/geometry/velocity.hpp"

#include "kinloop/core/errors.hpp"

namespace kinloop {

Vector6d Velocity::vector() const {
  Vector6d v;
  v << linear_m_s, angular_rad_s;
  return v;
}

Velocity velocity_of_twist(const Vector6d& twist, double dt_s) {
  return Velocity::from_vector(twist / dt_s);
}

Velocity velocity_between(const SE3& T_world_before, const SE3& T_world_after, double dt_s) {
  require(dt_s != 0, "velocity_between: dt_s must not be zero");
  const SE3 T_before_after = T_world_before.inverse() * T_world_after;
  return {T_before_after.translation / dt_s, log_so3(T_before_after.rotation) / dt_s};
}

SE3 propagate_pose(const SE3& T_world_camera, const Velocity& velocity, double dt_s) {
  return T_world_camera * SE3{exp_so3(velocity.angular_rad_s * dt_s), velocity.linear_m_s * dt_s};
}

Eigen::Vector3d point_in_later_camera(const Eigen::Vector3d& p_camera, const Velocity& velocity,
                                      double dt_s) {
  return exp_so3(-dt_s * velocity.angular_rad_s) * (p_camera - dt_s * velocity.linear_m_s);
}

Eigen::Vector3d point_in_earlier_camera(const Eigen::Vector3d& p_camera_later, const Velocity& velocity,
                                        double dt_s) {
  return exp_so3(dt_s * velocity.angular_rad_s) * p_camera_later + dt_s * velocity.linear_m_s;
}

}  // namespace kinloop
