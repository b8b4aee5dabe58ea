#include "kinloop/belief/reach.hpp"

#include <algorithm>

#include "kinloop/core/time.hpp"

namespace kinloop {

namespace {

/// The distance of a point from the line segment between two others.
double distance_from_segment(const Eigen::Vector3d& p, const Eigen::Vector3d& begin,
                             const Eigen::Vector3d& end) {
  const Eigen::Vector3d way = end - begin;
  const double length2 = way.squaredNorm();
  const double share = length2 > 0 ? std::clamp((p - begin).dot(way) / length2, 0.0, 1.0) : 0;
  return (p - begin - share * way).norm();
}

}  // namespace

bool can_reach(const CameraMotion& from, const Map& map, const Eigen::Vector3d& p_world, int64_t stamp_ns,
               double drift_m) {
  constexpr double kMaxSpeed_m_s = 3, kMaxAcceleration_m_s2 = 1, kMaxDrift_m = 0.5;
  const double since_s = to_seconds(stamp_ns - from.stamp_ns);
  const SE3 T_world_camera = from.pose.world(map);
  const Eigen::Vector3d p_ahead = T_world_camera * (since_s * from.velocity.linear_m_s);
  const double map_off_m = kMaxDrift_m + drift_m;
  const double turned_m = std::min(kMaxSpeed_m_s * since_s, kMaxAcceleration_m_s2 / 2 * since_s * since_s);
  return (p_world - p_ahead).norm() < map_off_m + turned_m ||
         distance_from_segment(p_world, T_world_camera.translation, p_ahead) < map_off_m;
}

}  // namespace kinloop
