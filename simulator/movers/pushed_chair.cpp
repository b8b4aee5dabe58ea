#include <algorithm>
#include <cmath>
#include <limits>

#include "kinloop/core/errors.hpp"
#include "simulator/movers/movers.hpp"

namespace kinloop::sim {
namespace {

constexpr double kFromPath_m = 0.6;

double pushed_share(const PushedChair& chair, double time_s) {
  const double s = std::clamp((time_s - chair.begin_s) / chair.seconds, 0.0, 1.0);
  return s * s * (3 - 2 * s);
}

/// How often the camera looks at a place, less a penalty for a place too near its path.
double views_of(const FloorTrack& camera, const Eigen::Vector2d& p) {
  constexpr double kPenalty = 1e4;
  double views = 0, nearest_m = std::numeric_limits<double>::infinity();
  for (const FloorView& view : camera.views) {
    views += in_view(view, p) ? 1 : 0;
    nearest_m = std::min(nearest_m, (view.position - p).norm());
  }
  return views - kPenalty * std::max(0.0, kFromPath_m - nearest_m);
}

struct Push {
  Eigen::Vector2d from, to;
};

/// The push that the camera sees most of several.
Push chosen_push(const FreeFloor& floor, const FloorTrack& camera, Random& random) {
  constexpr int kTries = 4000, kChoices = 30;
  constexpr double kShortest_m = 0.4, kLongest_m = 1.3;
  const std::vector<Eigen::Vector2d> places = floor.largest_region();
  if (places.empty()) throw InputError("sim.movers.chairs: no room for another chair; set fewer");
  Push best{places.front(), places.front()};
  double best_views = -std::numeric_limits<double>::infinity();
  const auto any = [&] { return places[random.index(static_cast<uint32_t>(places.size()))]; };
  for (int i = 0, found = 0; i < kTries && found < kChoices; ++i) {
    const Eigen::Vector2d from = any(), to = any();
    const double length_m = (to - from).norm();
    if (length_m < kShortest_m || length_m > kLongest_m || !floor.is_free(from, to)) continue;
    ++found;
    const double views = std::min(views_of(camera, from), views_of(camera, to));
    if (views <= best_views) continue;
    best = {from, to};
    best_views = views;
  }
  return best;
}

/// A time between a fifth and three fifths of all; in three of five cases, if possible, while the camera sees
/// the chair.
double chosen_time_s(const FloorTrack& camera, const Eigen::Vector2d& p, Random& random) {
  constexpr double kEarliest = 0.2, kLatest = 0.6, kSeen = 0.6;
  const double any_s = random.uniform(kEarliest, kLatest) * camera.seconds();
  std::vector<double> seen_s;
  for (double t = kEarliest * camera.seconds(); t < kLatest * camera.seconds(); t += FloorTrack::kStep_s) {
    if (in_view(camera.at(t), p)) seen_s.push_back(t);
  }
  if (seen_s.empty() || random.uniform() > kSeen) return any_s;
  return seen_s[random.index(static_cast<uint32_t>(seen_s.size()))];
}

void block_place(FreeFloor& floor, const Eigen::Vector2d& p) {
  const Eigen::Vector2f middle = p.cast<float>();
  floor.block({middle.array() - kChairRadius_m, middle.array() + kChairRadius_m});
}

}  // namespace

ChairPlace place_at(const PushedChair& chair, double time_s) {
  const auto s = static_cast<float>(pushed_share(chair, time_s));
  if (s == 0) return chair.before;
  if (s == 1) return chair.after;
  return {chair.before.position + s * (chair.after.position - chair.before.position),
          chair.before.yaw_rad + s * (chair.after.yaw_rad - chair.before.yaw_rad)};
}

bool is_pushed(const PushedChair& chair, double time_s) {
  return time_s > chair.begin_s && time_s < chair.begin_s + chair.seconds;
}

Parts chair_at(const PushedChair& chair, double time_s) {
  const ChairPlace place = place_at(chair, time_s);
  return moved(chair.parts, place.yaw_rad, {place.position.x(), place.position.y(), 0});
}

PushedChair place_chair(FreeFloor& floor, const FloorTrack& camera, FurnitureBuilder& builder) {
  constexpr float kHalfDepth_m = 0.23F, kMaxTurn_rad = 0.9F;
  constexpr double kSpeed = 0.6;  // m / s
  Random& random = builder.random();
  const Push push = chosen_push(floor, camera, random);
  PushedChair chair;
  chair.parts = moved(builder.chair(), 0, {0, kHalfDepth_m, 0});
  chair.before = {push.from.cast<float>(), builder.uniform(0, 6.28F)};
  const float turn_rad = builder.uniform(-kMaxTurn_rad, kMaxTurn_rad);
  chair.after = {push.to.cast<float>(), chair.before.yaw_rad + turn_rad};
  chair.begin_s = chosen_time_s(camera, push.from, random);
  chair.seconds = 0.4 + (push.to - push.from).norm() / kSpeed;
  block_place(floor, push.from);
  block_place(floor, push.to);
  return chair;
}

}  // namespace kinloop::sim
