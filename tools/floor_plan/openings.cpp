#include "tools/floor_plan/openings.hpp"

#include <algorithm>
#include <cmath>

namespace kinloop {
namespace {

constexpr double kStep_m = 0.025;

/// Runs of true values: first and one past the last, without those next to short gaps.
std::vector<std::pair<size_t, size_t>> runs_of(const std::vector<bool>& values, size_t longest_gap) {
  std::vector<std::pair<size_t, size_t>> runs;
  for (size_t i = 0; i < values.size(); ++i) {
    if (!values[i]) continue;
    if (!runs.empty() && i - runs.back().second <= longest_gap) {
      runs.back().second = i + 1;
    } else {
      runs.emplace_back(i, i + 1);
    }
  }
  return runs;
}

/// Positions along a wall in steps of kStep_m.
class WallProfile {
 public:
  WallProfile(const PlanWall& wall, const OpeningEvidence& evidence)
      : from_m_(wall.from_m), along_((wall.to_m - wall.from_m).normalized()), evidence_(evidence) {
    steps_ = static_cast<size_t>(wall.length_m() / kStep_m);
  }

  /// Returns at which positions the space in and behind the wall was seen free.
  [[nodiscard]] std::vector<bool> seen_through(const cv::Mat& free_space) const {
    constexpr double kFar_m = 0.3;
    std::vector<bool> seen(steps_, false);
    for (size_t i = 0; i < steps_; ++i) {
      bool all = true;
      for (double depth_m = 0; depth_m <= kFar_m; depth_m += kStep_m) {
        const cv::Point cell = evidence_.grid.cell(at(i) + depth_m * outwards());
        all = all && evidence_.grid.contains(cell) && free_space.at<uint8_t>(cell) != 0;
      }
      seen[i] = all;
    }
    return seen;
  }

 private:
  [[nodiscard]] Eigen::Vector2d at(size_t step) const {
    return from_m_ + (static_cast<double>(step) + 0.5) * kStep_m * along_;
  }
  [[nodiscard]] Eigen::Vector2d outwards() const { return {along_.y(), -along_.x()}; }

  Eigen::Vector2d from_m_, along_;
  const OpeningEvidence& evidence_;
  size_t steps_ = 0;
};

std::vector<PlanOpening> openings_of(const PlanWall& wall, const OpeningEvidence& evidence) {
  constexpr double kNarrowest_m = 0.5, kGap_m = 0.1, kDoorwayShare = 0.3;
  const WallProfile profile(wall, evidence);
  const auto high = profile.seen_through(evidence.high_free);
  const auto low = profile.seen_through(evidence.low_free);
  std::vector<PlanOpening> openings;
  for (const auto& [begin, end] : runs_of(high, static_cast<size_t>(kGap_m / kStep_m))) {
    if (static_cast<double>(end - begin) * kStep_m < kNarrowest_m) continue;
    const auto seen_low =
        std::count(low.begin() + static_cast<long>(begin), low.begin() + static_cast<long>(end), true);
    const bool is_doorway = static_cast<double>(seen_low) > kDoorwayShare * static_cast<double>(end - begin);
    openings.push_back({is_doorway ? OpeningKind::kDoorway : OpeningKind::kHole,
                        static_cast<double>(begin) * kStep_m, static_cast<double>(end) * kStep_m});
  }
  return openings;
}

}  // namespace

void find_openings(std::vector<PlanRoom>& rooms, const OpeningEvidence& evidence) {
  for (PlanRoom& room : rooms) {
    for (PlanWall& wall : room.walls) wall.openings = openings_of(wall, evidence);
  }
}

}  // namespace kinloop
