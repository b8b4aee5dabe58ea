#include "kinloop/tracking/evidence/confirmed_first.hpp"

#include <algorithm>

namespace kinloop {

std::optional<VotedPose> solve_by_confirmed_first(const Sensor& sensor,
                                                  std::span<const PoseObservation> observations,
                                                  const std::vector<bool>& confirmed,
                                                  const SE3& T_reference_camera_guess,
                                                  const AbsolutePoseOptions& options) {
  constexpr double kMinAgreeing = 0.5;
  std::vector<PoseObservation> old, young;
  for (size_t i = 0; i < observations.size(); ++i) (confirmed[i] ? old : young).push_back(observations[i]);
  const auto solve_all = [&]() -> std::optional<VotedPose> {
    auto solution = solve_absolute_pose(sensor, observations, T_reference_camera_guess, options);
    if (!solution) return std::nullopt;
    return VotedPose{*std::move(solution), static_cast<int>(observations.size())};
  };
  const auto count_old = static_cast<int>(old.size());
  if (count_old < kMinConfirmed || young.empty()) return solve_all();
  const auto by_old = solve_absolute_pose(sensor, old, T_reference_camera_guess, options);
  if (!by_old || by_old->inlier_count < std::max<double>(kMinConfirmed, kMinConsistent * count_old))
    return solve_all();
  const auto agrees = pixel_inliers(sensor, young, by_old->T_reference_camera);
  const auto agreeing = static_cast<double>(std::count(agrees.begin(), agrees.end(), 1));
  if (agreeing >= kMinAgreeing * static_cast<double>(young.size())) return solve_all();
  VotedPose pose{*by_old, count_old};
  pose.inliers.assign(observations.size(), 0);
  for (size_t i = 0, k = 0; i < observations.size(); ++i) {
    if (confirmed[i]) pose.inliers[i] = by_old->inliers[k++];
  }
  return pose;
}

}  // namespace kinloop
