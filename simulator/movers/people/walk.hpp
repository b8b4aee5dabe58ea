#pragma once
// In: a list of straight ways, turns and pauses. Out: where a walker is at any time, and how it stands.

#include <vector>

#include <Eigen/Core>

namespace kinloop::sim {

/// Place and gait of a walker. Headings are about z, 0 along x.
struct WalkState {
  Eigen::Vector2d position = Eigen::Vector2d::Zero();  ///< room frame, m
  double heading_rad = 0;
  double phase = 0;   ///< cycles of two steps; with whole and half numbers the legs are side by side
  double step_m = 0;  ///< present length of a step
};

/// A straight way, a turn on the spot (`from` = `to`), or a pause (nothing changes).
struct WalkSegment {
  double begin_s = 0, seconds = 0;
  Eigen::Vector2d from = Eigen::Vector2d::Zero(), to = Eigen::Vector2d::Zero();
  double heading_from_rad = 0, heading_to_rad = 0;
  double phase = 0, cycles = 0;  ///< at the beginning, and gained; a multiple of one half

  [[nodiscard]] double end_s() const { return begin_s + seconds; }
};

/// Segments in order of time, each beginning where the one before ends.
using Walk = std::vector<WalkSegment>;

/// Returns the state at a time within or beyond a segment.
WalkState state_in(const WalkSegment& segment, double time_s);

/// Returns the state at a time; before the first and after the last segment the walker stands. Requires a
/// segment.
WalkState state_at(const Walk& walk, double time_s);

/// Returns the segment for standing from the end of `before` on.
WalkSegment pause_after(const WalkSegment& before, double seconds);

/// Returns the segment for turning to a heading, by the shorter way.
WalkSegment turn_after(const WalkSegment& before, double heading_rad);

/// Returns the segment for walking straight on to a point. Speeds up and slows down within half a second.
WalkSegment straight_after(const WalkSegment& before, const Eigen::Vector2d& to, double speed_m_per_s);

}  // namespace kinloop::sim
