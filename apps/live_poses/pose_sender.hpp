#pragma once
// In: each frame as it is tracked. Out: a JSON line with its pose for another program (--poses-to);
// docs/protocol.md describes it.

#include <memory>
#include <optional>
#include <string>

#include "apps/live_poses/line_output.hpp"
#include "kinloop/map/map.hpp"
#include "kinloop/map/tracked_frame.hpp"

namespace kinloop {

/// Accumulates the corrections of the map, which move the camera in the frame of the map but not in that of
/// its odometry (REP 105).
class OdometryFrame {
 public:
  /// Call for every frame in order, with the map in which it was tracked.
  void update(const TrackedFrame& tracked, const Map& map);

  /// T_map_odom: T_odom_camera = T_map_odom^-1 * T_world_camera does not jump with corrections.
  [[nodiscard]] const SE3& T_map_odom() const { return T_map_odom_; }

 private:
  SE3 T_map_odom_;
  std::optional<TrackedFrame> latest_;  // that has a pose; without matches and images
};

/// Returns the line of a frame, with its line break.
std::string pose_line(const TrackedFrame& tracked, const Map& map, const SE3& T_map_odom);

class PoseSender {
 public:
  /// `target` is that of open_line_output, which may throw.
  explicit PoseSender(std::string target);

  void send(const TrackedFrame& tracked, const Map& map);

  /// Logs how many lines were dropped, if any.
  void report() const;

 private:
  std::string target_;
  std::unique_ptr<LineOutput> output_;
  OdometryFrame odometry_;
  size_t lines_ = 0, dropped_ = 0;
};

}  // namespace kinloop
