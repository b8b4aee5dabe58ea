#include "simulator/movers/people/walk.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "kinloop/core/errors.hpp"

namespace kinloop::sim {
namespace {

constexpr double kSpeedUp_s = 0.45;  // from standing to full speed, and back

/// 3 s^2 - 2 s^3, and its integral from 0.
double eased(double s) {
  return s * s * (3 - 2 * s);
}
double eased_integral(double s) {
  return s * s * s * (1 - s / 2);
}

/// Seconds at full speed that cover the same way, and the share of full speed.
struct Pace {
  double covered_s, share;
};

Pace pace_at(double elapsed_s, double seconds) {
  if (elapsed_s < kSpeedUp_s) {
    const double s = elapsed_s / kSpeedUp_s;
    return {kSpeedUp_s * eased_integral(s), eased(s)};
  }
  if (elapsed_s > seconds - kSpeedUp_s) {
    const double s = (seconds - elapsed_s) / kSpeedUp_s;
    return {seconds - kSpeedUp_s - kSpeedUp_s * eased_integral(s), eased(s)};
  }
  return {elapsed_s - kSpeedUp_s / 2, 1};
}

/// The begin of a segment that follows another.
WalkSegment after(const WalkSegment& before) {
  WalkSegment next;
  next.begin_s = before.end_s();
  next.from = next.to = before.to;
  next.heading_from_rad = next.heading_to_rad = before.heading_to_rad;
  next.phase = before.phase + before.cycles;
  return next;
}

}  // namespace

WalkState state_in(const WalkSegment& segment, double time_s) {
  WalkState state{segment.from, segment.heading_from_rad, segment.phase, 0};
  if (segment.seconds <= 0) return state;
  const double elapsed_s = std::clamp(time_s - segment.begin_s, 0.0, segment.seconds);
  const double length_m = (segment.to - segment.from).norm();
  if (length_m > 0) {
    const Pace pace = pace_at(elapsed_s, segment.seconds);
    const double part = pace.covered_s / (segment.seconds - kSpeedUp_s);
    state.position += part * (segment.to - segment.from);
    state.phase += part * segment.cycles;
    state.step_m = pace.share * length_m / (2 * segment.cycles);
    return state;
  }
  constexpr double kStepOnTheSpot_m = 0.22;
  const double part = eased(elapsed_s / segment.seconds);
  state.heading_rad += part * (segment.heading_to_rad - segment.heading_from_rad);
  state.phase += part * segment.cycles;
  if (segment.cycles > 0) {
    const double lift = std::sin(std::numbers::pi * elapsed_s / segment.seconds);
    state.step_m = kStepOnTheSpot_m * lift * lift;
  }
  return state;
}

WalkState state_at(const Walk& walk, double time_s) {
  require(!walk.empty(), "a walk needs a segment");
  auto next = std::upper_bound(walk.begin(), walk.end(), time_s,
                               [](double t, const WalkSegment& segment) { return t < segment.begin_s; });
  return state_in(next == walk.begin() ? *next : *std::prev(next), time_s);
}

WalkSegment pause_after(const WalkSegment& before, double seconds) {
  WalkSegment pause = after(before);
  pause.seconds = seconds;
  return pause;
}

WalkSegment turn_after(const WalkSegment& before, double heading_rad) {
  constexpr double kTurnRate = 2.2;  // rad / s
  constexpr double kLeast_s = 0.5, kTurnPerStep_rad = 1.2;
  WalkSegment turn = after(before);
  const double angle_rad = std::remainder(heading_rad - turn.heading_from_rad, 2 * std::numbers::pi);
  turn.heading_to_rad += angle_rad;
  turn.seconds = kLeast_s + std::abs(angle_rad) / kTurnRate;
  turn.cycles = std::ceil(std::abs(angle_rad) / kTurnPerStep_rad) / 2;
  return turn;
}

WalkSegment straight_after(const WalkSegment& before, const Eigen::Vector2d& to, double speed_m_per_s) {
  // Steps grow with speed: .6 m at .8 m/s, .75 m at 1.4 m/s (near the walk ratio of Sekiya et al. 1996, "The
  // invariant relationship between step length and step rate during free walking"; from memory).
  const double step_m = 0.4 + 0.25 * speed_m_per_s;
  WalkSegment way = after(before);
  way.to = to;
  const double length_m = (way.to - way.from).norm();
  way.seconds = std::max(length_m / speed_m_per_s + kSpeedUp_s, 2 * kSpeedUp_s);
  way.cycles = std::max(1.0, std::round(length_m / step_m)) / 2;
  return way;
}

}  // namespace kinloop::sim
