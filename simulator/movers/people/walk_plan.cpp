#include "simulator/movers/people/walk_plan.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "kinloop/core/errors.hpp"
#include "kinloop/core/time.hpp"

namespace kinloop::sim {
namespace {

constexpr double kFromCamera_m = 1.0, kFromOthers_m = 0.85;
constexpr double kViewingDistance_m = 2.2;

/// Plans one walk, segment by segment.
class WalkPlanner {
 public:
  WalkPlanner(const FreeFloor& floor, const FloorTrack& camera, const std::vector<Walk>& others,
              Random& random)
      : floor_(floor), camera_(camera), others_(others), random_(random), places_(floor.largest_region()) {
    if (places_.empty())
      throw InputError("sim.movers.people: no free floor in this room; try another seed or fewer people");
  }

  [[nodiscard]] Walk plan() {
    Walk walk{start()};
    while (walk.back().end_s() < camera_.seconds()) {
      if (const auto pause = chosen_pause(walk.back())) walk.push_back(*pause);
      const Walk next = chosen_way(walk.back());
      walk.insert(walk.end(), next.begin(), next.end());
    }
    return walk;
  }

 private:
  [[nodiscard]] Eigen::Vector2d any_place() {
    return places_[random_.index(static_cast<uint32_t>(places_.size()))];
  }

  /// The share of time in view, less penalties for coming too close to the camera or to others, and for
  /// ending far from where the camera looks then.
  [[nodiscard]] double score(const Walk& part) const {
    constexpr double kLookAhead_s = 0.8, kSeenAhead_s = 3, kCrowdedPenaltyPerM = 10, kFarPenaltyPerM = 0.25;
    double nearest_m = 0;
    int seen = 0, samples = 0;
    const double begin_s = part.front().begin_s, end_s = part.back().end_s();
    for (double t = begin_s; t <= end_s + kSeenAhead_s; t += FloorTrack::kStep_s, ++samples) {
      const Eigen::Vector2d p = state_at(part, t).position;
      seen += in_view(camera_.at(t), p) ? 1 : 0;
      if (t <= end_s + kLookAhead_s) nearest_m = std::min(nearest_m, clearance_m(p, t));
    }
    const FloorView& then = camera_.at(end_s + 1);
    const Eigen::Vector2d looked_at = then.position + kViewingDistance_m * then.direction;
    return static_cast<double>(seen) / std::max(samples, 1) + kCrowdedPenaltyPerM * nearest_m -
           kFarPenaltyPerM * (part.back().to - looked_at).norm();
  }

  /// Distance from the camera and from others, beyond what has to be kept.
  [[nodiscard]] double clearance_m(const Eigen::Vector2d& p, double time_s) const {
    double least_m = (p - camera_.at(time_s).position).norm() - kFromCamera_m;
    for (const Walk& other : others_)
      least_m = std::min(least_m, (p - state_at(other, time_s).position).norm() - kFromOthers_m);
    return least_m;
  }

  [[nodiscard]] bool is_clear(const WalkSegment& pause) const {
    for (double t = pause.begin_s; t <= pause.end_s(); t += FloorTrack::kStep_s) {
      if (clearance_m(pause.to, t) < 0) return false;
    }
    return true;
  }

  [[nodiscard]] WalkSegment start() {
    constexpr int kTries = 40;
    WalkSegment best;
    double best_score = 0;
    for (int i = 0; i < kTries; ++i) {
      WalkSegment stand;
      stand.seconds = 0.1;
      stand.from = stand.to = any_place();
      stand.heading_from_rad = stand.heading_to_rad = random_.uniform(0, 6.28);
      const double here = score({stand});
      if (i > 0 && here <= best_score) continue;
      best = stand;
      best_score = here;
    }
    return best;
  }

  [[nodiscard]] std::optional<WalkSegment> chosen_pause(const WalkSegment& before) {
    constexpr double kChance = 0.35;
    const bool wanted = random_.uniform() < kChance;
    const WalkSegment pause = pause_after(before, random_.uniform(0.5, 2.5));
    const bool seen = in_view(camera_.at(pause.begin_s), pause.to);
    if (!wanted || !seen || !is_clear(pause)) return std::nullopt;
    return pause;
  }

  /// Turn and way to the best of several places in a straight line; a short pause if there is none.
  [[nodiscard]] Walk chosen_way(const WalkSegment& before) {
    constexpr int kTries = 1200, kChoices = 60;
    constexpr double kShortest_m = 0.8, kLongest_m = 4.5, kNoWay_s = 0.5;
    Walk best{pause_after(before, kNoWay_s)};
    double best_score = 0;
    for (int i = 0, found = 0; i < kTries && found < kChoices; ++i) {
      const Eigen::Vector2d place = any_place(), way = place - before.to;
      const double speed = random_.uniform(0.8, 1.4);
      if (way.norm() < kShortest_m || way.norm() > kLongest_m || !floor_.is_free(before.to, place)) continue;
      Walk candidate{turn_after(before, std::atan2(way.y(), way.x()))};
      candidate.push_back(straight_after(candidate.back(), place, speed));
      const double here = score(candidate);
      if (found++ > 0 && here <= best_score) continue;
      best = std::move(candidate);
      best_score = here;
    }
    return best;
  }

  const FreeFloor& floor_;
  const FloorTrack& camera_;
  const std::vector<Walk>& others_;
  Random& random_;
  std::vector<Eigen::Vector2d> places_;
};

}  // namespace

const FloorView& FloorTrack::at(double time_s) const {
  const auto last = static_cast<double>(views.size() - 1);
  return views[static_cast<size_t>(std::clamp(std::round(time_s / kStep_s), 0.0, last))];
}

FloorTrack floor_track(const CameraPath& path) {
  FloorTrack track;
  const int64_t first_ns = path.poses().front().stamp_ns, last_ns = path.poses().back().stamp_ns;
  for (int64_t stamp_ns = first_ns; stamp_ns <= last_ns; stamp_ns += to_ns(FloorTrack::kStep_s)) {
    const SE3 T_room_camera = path.at(stamp_ns);
    const Eigen::Vector2d along = T_room_camera.R().col(2).head<2>();
    track.views.push_back({T_room_camera.translation.head<2>(), along.normalized()});
  }
  return track;
}

bool in_view(const FloorView& camera, const Eigen::Vector2d& p) {
  constexpr double kNearest_m = 1.2, kFarthest_m = 4.5, kMinCosine = 0.88;  // 28 degrees off the axis
  const Eigen::Vector2d way = p - camera.position;
  const double distance_m = way.norm();
  return distance_m > kNearest_m && distance_m < kFarthest_m &&
         way.dot(camera.direction) > kMinCosine * distance_m;
}

Walk plan_walk(const FreeFloor& floor, const FloorTrack& camera, const std::vector<Walk>& others,
               Random& random) {
  return WalkPlanner(floor, camera, others, random).plan();
}

}  // namespace kinloop::sim
