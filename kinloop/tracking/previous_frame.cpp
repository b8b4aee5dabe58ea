#include "kinloop/tracking/previous_frame.hpp"

#include <algorithm>
#include <cmath>
#include <functional>

#include "kinloop/features/keypoint_measurements.hpp"
#include "kinloop/tracking/evidence/confirmed_first.hpp"

namespace kinloop {
namespace {

/// Points of the previous frame with known position: its landmarks if it observes any, else its own depth
/// measurements.
struct PreviousPoints {
  std::vector<Eigen::Vector3d> p_reference;
  std::vector<uint32_t> features;  // keypoints of the previous frame
  std::vector<bool> mapped;        // whether the point is a landmark
};

PreviousPoints points_of(const TrackedFrame& previous, const LocalMap& local_map,
                         const PinholeCamera& camera) {
  const Features& features = previous.features();
  const std::vector<LandmarkId> landmark_of = landmark_of_keypoint(previous);
  PreviousPoints points;
  for (uint32_t i = 0; i < features.size(); ++i) {
    const auto known = local_map.index_of.find(landmark_of[i]);
    const bool mapped = known != local_map.index_of.end();
    if (!mapped && !(features.depths_m[i] > 0)) continue;
    points.p_reference.push_back(mapped ? local_map.p_reference[known->second]
                                        : previous.T_reference_camera *
                                              camera.unproject(features.pixels[i].cast<double>(),
                                                               static_cast<double>(features.depths_m[i])));
    points.features.push_back(i);
    points.mapped.push_back(mapped);
  }
  return points;
}

/// Input of one tracking method.
struct TwoFrames {
  const TrackingInput& in;
  const TrackedFrame& previous;
  const PreviousPoints& points;
};

PoseObservation observation_of(const TwoFrames& t, size_t point, uint32_t feature) {
  const Features& before = t.previous.features();
  // A point known only from the previous frame is as uncertain as its keypoint there.
  const double sigma_before =
      t.points.mapped[point] ? 0.0 : static_cast<double>(before.sigmas_px[t.points.features[point]]);
  PoseObservation seen{compensated_measurement(*t.in.frame.features, feature), t.points.p_reference[point]};
  seen.sigma_px = std::hypot(seen.sigma_px, sigma_before);
  return seen;
}

FramePose keep_inliers(const AbsolutePoseSolution& solution, const std::vector<PoseObservation>& observations,
                       const std::vector<uint32_t>& features) {
  FramePose pose;
  pose.T_reference_camera = solution.T_reference_camera;
  pose.information = solution.information;
  for (size_t i = 0; i < observations.size(); ++i) {
    if (!solution.inliers[i]) continue;
    pose.inliers.push_back(observations[i]);
    pose.features.push_back(features[i]);
  }
  return pose;
}

std::optional<FramePose> solve(const TwoFrames& t, const std::vector<Match>& matches, const SE3& guess) {
  if (static_cast<int>(matches.size()) < t.in.options.min_matches) return std::nullopt;
  std::vector<PoseObservation> observations;
  std::vector<uint32_t> features;
  for (const Match& match : matches) {
    observations.push_back(observation_of(t, match.a, match.b));
    features.push_back(match.b);
  }
  const auto solution = solve_absolute_pose(t.in.sensor, observations, guess, t.in.options.pose);
  if (!solution || solution->inlier_count < t.in.options.min_inliers) return std::nullopt;
  FramePose pose = keep_inliers(*solution, observations, features);
  pose.matches = static_cast<int>(matches.size());
  return pose;
}

/// Half side of the search window for a point at `depth_m` on pyramid level 0.
using SearchRadius = std::function<double(double depth_m)>;

/// Prediction uncertainty.
SearchRadius predicted_window(const PredictedPose& predicted, const PinholeCamera& camera,
                              const TrackingOptions& options) {
  constexpr double kWindowSigmas = 3;
  return [=, fx = camera.fx](double depth_m) {
    const double sigma_px = fx * std::hypot(predicted.sigma_rad, predicted.sigma_m / depth_m);
    return std::min(options.window_px + kWindowSigmas * sigma_px, options.wide_window_px);
  };
}

std::optional<FramePose> track_by_projection(const TwoFrames& t, const SE3& T_reference_camera,
                                             const SearchRadius& window_px) {
  const Features& before = t.previous.features();
  const SE3 T_camera_reference = T_reference_camera.inverse();
  std::vector<ProjectedPoint> projected;
  std::vector<uint32_t> point_of;
  for (uint32_t i = 0; i < t.points.features.size(); ++i) {
    const Eigen::Vector3d p_camera = T_camera_reference * t.points.p_reference[i];
    if (p_camera.z() <= 0) continue;
    const Eigen::Vector2d pixel = t.in.sensor.camera.project(p_camera);
    if (!t.in.sensor.camera.contains(pixel)) continue;
    const uint32_t feature = t.points.features[i];
    const int level = before.levels[feature];
    projected.push_back({pixel, window_px(p_camera.z()) * static_cast<double>(before.sigmas_px[feature]),
                         p_camera.z(), level - 1, level + 1,
                         before.descriptors.ptr<uint8_t>(static_cast<int>(feature))});
    point_of.push_back(i);
  }
  auto matches = match_by_projection(projected, *t.in.frame.features, t.in.grid, {});
  for (Match& match : matches) match.a = point_of[match.a];
  return solve(t, matches, T_reference_camera);
}

/// Tracks the landmarks alone. What moves through the view has many keypoints, but no landmarks. nullopt if
/// too few are left or they do not agree.
std::optional<FramePose> track_mapped_points(const TwoFrames& t, const SE3& T_reference_camera,
                                             const SearchRadius& window_px) {
  PreviousPoints mapped;
  for (size_t i = 0; i < t.points.features.size(); ++i) {
    if (!t.points.mapped[i]) continue;
    mapped.p_reference.push_back(t.points.p_reference[i]);
    mapped.features.push_back(t.points.features[i]);
    mapped.mapped.push_back(true);
  }
  if (static_cast<int>(mapped.features.size()) < kMinConfirmed) return std::nullopt;
  auto pose = track_by_projection({t.in, t.previous, mapped}, T_reference_camera, window_px);
  if (!pose || static_cast<int>(pose->inliers.size()) < kMinConfirmed) return std::nullopt;
  if (static_cast<double>(pose->inliers.size()) < kMinConsistent * pose->matches) return std::nullopt;
  pose->attempts = 1;
  return pose;
}

/// Estimates rigid 3D-3D motion from the matches with depth on both sides.
std::optional<SE3> rigid_guess(const TwoFrames& t, const std::vector<PoseObservation>& observations,
                               uint64_t seed) {
  const SE3 T_previous_reference = t.previous.T_reference_camera.inverse();
  std::vector<PointPair> pairs;
  for (const PoseObservation& seen : observations) {
    if (!(seen.depth_m > 0)) continue;
    pairs.push_back({T_previous_reference * seen.p_reference,
                     t.in.sensor.camera.unproject(seen.pixel, seen.depth_m), seen.sigma_px, seen.sigma_px});
  }
  const auto solution = solve_rigid_ransac(t.in.sensor, pairs, t.in.options.rigid, seed);
  if (!solution) return std::nullopt;
  return t.previous.T_reference_camera * solution->T_a_b;
}

/// Brute-force Hamming matching with the match screening of the ORB paper, then RANSAC: P3P, and rigid 3D-3D
/// if that fails.
std::optional<FramePose> track_by_brute_force(const TwoFrames& t, uint64_t seed) {
  const cv::Mat& all = t.previous.features().descriptors;
  cv::Mat descriptors;
  for (const uint32_t feature : t.points.features) descriptors.push_back(all.row(static_cast<int>(feature)));
  const auto matches =
      filter_matches_by_distance(match_brute_force(descriptors, t.in.frame.features->descriptors, true));
  if (static_cast<int>(matches.size()) < t.in.options.min_matches) return std::nullopt;
  std::vector<PoseObservation> observations;
  for (const Match& match : matches) observations.push_back(observation_of(t, match.a, match.b));
  const std::optional<AbsolutePoseSolution> from_pixels =
      solve_pnp_ransac(t.in.sensor, observations, t.in.options.pnp, t.in.options.pose, seed);
  const std::optional<SE3> guess =
      from_pixels ? from_pixels->T_reference_camera : rigid_guess(t, observations, seed);
  auto pose = guess ? solve(t, matches, *guess) : std::nullopt;
  if (pose) pose->from_brute_force = true;
  return pose;
}

/// Estimates the pose of the frame by dense alignment of its depth and grey images to those of the previous
/// one, starting from `T_reference_camera_guess`. Its information is small in directions that surfaces and
/// intensities leave unconstrained. nullopt if the overlap is too small.
std::optional<FramePose> align_to_previous_frame(const TwoFrames& t, const SE3& T_reference_camera_guess) {
  constexpr double kMinOverlap = 0.4;  // fraction of the depth pixels; less overlap may be another place
  const auto& [in, previous, points] = t;
  const IcpCamera grids = make_icp_camera(in.sensor, in.options.icp);
  const auto aligned =
      align_icp(grids, make_icp_frame(grids, previous.frame->depth_m, previous.frame->gray),
                make_icp_frame(grids, in.frame.depth_m, in.frame.gray),
                previous.T_reference_camera.inverse() * T_reference_camera_guess, in.options.icp);
  if (!aligned || aligned->overlap < kMinOverlap) return std::nullopt;
  FramePose pose;
  pose.T_reference_camera = previous.T_reference_camera * aligned->T_reference_camera;
  pose.information = aligned->information;
  pose.dense = true;
  return pose;
}

}  // namespace

std::optional<FramePose> estimate_pose_from_previous_frame(const TrackingInput& in,
                                                           const TrackedFrame& previous,
                                                           const PredictedPose& predicted, uint64_t seed) {
  const TrackingOptions& options = in.options;
  const PreviousPoints points = points_of(previous, in.local_map, in.sensor.camera);
  const TwoFrames t{in, previous, points};
  std::optional<FramePose> best;
  int attempts = 0;
  // A few chance matches can agree on a wrong pose, so try the next method if the inliers are few.
  const auto accept = [&](std::optional<FramePose> pose) {
    ++attempts;
    if (pose && (!best || pose->inliers.size() > best->inliers.size())) best = std::move(pose);
    if (best) best->attempts = attempts;
    return best && static_cast<int>(best->inliers.size()) >= options.min_confident_inliers;
  };
  const SearchRadius window = predicted_window(predicted, in.sensor.camera, options);
  if (auto mapped = track_mapped_points(t, predicted.T, window)) return mapped;
  if (accept(track_by_projection(t, predicted.T, window))) return best;
  const auto wide = [&](double) { return options.wide_window_px; };
  if (accept(track_by_projection(t, predicted.T, wide))) return best;
  if (accept(track_by_brute_force(t, seed)) || best) return best;
  accept(align_to_previous_frame(t, predicted.T));
  return best;
}

std::optional<FramePose> align_with_previous_frame(const TrackingInput& in, const TrackedFrame& previous,
                                                   const SE3& T_reference_camera_guess) {
  const PreviousPoints none;
  return align_to_previous_frame({in, previous, none}, T_reference_camera_guess);
}

}  // namespace kinloop
