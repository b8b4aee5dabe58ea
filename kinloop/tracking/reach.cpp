#include "kinloop/tracking/reach.hpp"

#include <algorithm>

#include "kinloop/core/time.hpp"

namespace kinloop {

bool can_reach(const TrustedPose& from, const Map& map, const Eigen::Vector3d& p_world, int64_t stamp_ns) {
  constexpr double kMaxSpeed_m_s = 3, kMaxAcceleration_m_s2 = 1, kMaxDrift_m = 0.5;
  const double since_s = to_seconds(stamp_ns - from.stamp_ns);
  const SE3 T_world_camera = map.keyframe(from.reference).T_world_camera * from.T_reference_camera;
  const Eigen::Vector3d p_expected = T_world_camera * (since_s * from.velocity.linear_m_s);
  return (p_world - p_expected).norm() <
         kMaxDrift_m + std::min(kMaxSpeed_m_s * since_s, kMaxAcceleration_m_s2 / 2 * since_s * since_s);
}

}  // namespace kinloop
