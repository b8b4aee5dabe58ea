#include <cmath>

#include "kinloop/core/errors.hpp"
#include "kinloop/core/time.hpp"
#include "kinloop/geometry/velocity.hpp"

namespace kinloop {
namespace {

/// The four cubic Hermite polynomials at s = 0 to 1; those of the velocities are multiplied by the duration.
struct Hermite {
  Hermite(double s, double duration_s)
      : before((1 + 2 * s) * (1 - s) * (1 - s)),
        after(s * s * (3 - 2 * s)),
        velocity_before(s * (1 - s) * (1 - s) * duration_s),
        velocity_after(-s * s * (1 - s) * duration_s) {}

  double before, after, velocity_before, velocity_after;
};

/// Returns d/dt log(R exp(t omega)) at t = 0.
Eigen::Vector3d log_rate(const Eigen::Quaterniond& R, const Eigen::Vector3d& omega) {
  constexpr double kStep_s = 1e-5;
  const Eigen::Vector3d step = kStep_s * omega;
  return (log_so3(R * exp_so3(step)) - log_so3(R * exp_so3(-step))) / (2 * kStep_s);
}

}  // namespace

BridgedPose bridge_motion(const MovingCamera& before, const MovingCamera& after, int64_t stamp_ns,
                          const AccelerationNoise& acceleration, const Velocity& velocity_noise) {
  const double duration_s = to_seconds(after.stamp_ns - before.stamp_ns);
  require(duration_s > 0, "bridge_motion: the two moments must be in order of time");
  const double s = to_seconds(stamp_ns - before.stamp_ns) / duration_s;
  const Hermite h(s, duration_s);
  const SE3 &a = before.T_world_camera, &b = after.T_world_camera;
  BridgedPose bridged;
  bridged.T_world_camera.translation = h.before * a.translation + h.after * b.translation +
                                       h.velocity_before * (a.rotation * before.velocity.linear_m_s) +
                                       h.velocity_after * (b.rotation * after.velocity.linear_m_s);
  const Eigen::Quaterniond R_a_b = a.rotation.conjugate() * b.rotation;
  const Eigen::Vector3d turned_rad = h.after * log_so3(R_a_b) +
                                     h.velocity_before * before.velocity.angular_rad_s +
                                     h.velocity_after * log_rate(R_a_b, after.velocity.angular_rad_s);
  bridged.T_world_camera.rotation = (a.rotation * exp_so3(turned_rad)).normalized();

  const double since_s = s * duration_s, until_s = (1 - s) * duration_s;
  const double of_acceleration_s3 = std::pow(since_s * until_s / duration_s, 3) / 3;
  const double of_velocity_s2 = h.velocity_before * h.velocity_before + h.velocity_after * h.velocity_after;
  bridged.covariance.diagonal() << Eigen::Vector3d::Constant(acceleration.linear_m2_s3 * of_acceleration_s3) +
                                       of_velocity_s2 * velocity_noise.linear_m_s.cwiseAbs2(),
      Eigen::Vector3d::Constant(acceleration.angular_rad2_s3 * of_acceleration_s3) +
          of_velocity_s2 * velocity_noise.angular_rad_s.cwiseAbs2();
  return bridged;
}

}  // namespace kinloop
