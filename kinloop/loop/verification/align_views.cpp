#include "kinloop/loop/verification/align_views.hpp"

#include <cmath>
#include <vector>

#include "kinloop/features/keypoint_measurements.hpp"
#include "kinloop/features/matcher.hpp"
#include "kinloop/loop/recognition/reproject.hpp"
#include "kinloop/loop/verification/relative_scale.hpp"
#include "kinloop/optimize/pose/absolute_pose.hpp"

namespace kinloop {
namespace {

/// Keypoints of a camera as the reference would see them, in windows as wide as drift may displace them.
struct ExpectedPoints {
  std::vector<ProjectedPoint> projected;
  std::vector<Eigen::Vector3d> p_camera;
};

ExpectedPoints expected_points(const Features& features, const PredictedView& predicted,
                               const PinholeCamera& camera) {
  const ErrorMagnitude error = largest_error(predicted.covariance);
  ExpectedPoints expected;
  for (uint32_t i = 0; i < features.size(); ++i) {
    const auto seen = reproject(features, i, predicted.T_reference_camera, camera, 0);
    if (!seen) continue;
    const int level =
        features.levels[i] + static_cast<int>(std::lround(seen->level_step(features.scale_factor)));
    const double radius_px = camera.fx * displaced_rad(error, seen->p_view);
    expected.projected.push_back({seen->pixel, radius_px, seen->p_view.z(), level - 1, level + 1,
                                  features.descriptors.ptr<uint8_t>(static_cast<int>(i))});
    expected.p_camera.push_back(seen->p_source);
  }
  return expected;
}

/// Two views, and the keypoints of `view` that were found in `reference`.
struct MatchedViews {
  const View &reference, &view;
  const ExpectedPoints& expected;
  const std::vector<Match>& matches;
};

/// The scale of matched keypoints in two views whose relative pose is known: a match is dropped if its points
/// are farther apart than the things of one room from those of its double, or if one may have moved.
RelativeScale scale_of(const MatchedViews& matched, const SE3& T_reference_camera, const Sensor& sensor) {
  const auto& [reference, view, expected, matches] = matched;
  constexpr double kMaxDisplacement_m = 0.3;
  std::vector<ScalePair> pairs;
  for (const Match& match : matches) {
    const auto depth_m = static_cast<double>(reference.features.depths_m[match.b]);
    if (!(depth_m > 0)) continue;
    const Eigen::Vector3d& p_camera = expected.p_camera[match.a];
    const Eigen::Vector3d p_reference =
        sensor.camera.unproject(reference.features.pixels[match.b].cast<double>(), depth_m);
    if ((T_reference_camera * p_camera - p_reference).norm() > kMaxDisplacement_m) continue;
    if (!is_at_rest(p_reference, reference) || !is_at_rest(p_camera, view)) continue;
    pairs.push_back({p_reference, p_camera, sensor.noise.plane.difference_sigma_m(depth_m, p_camera.z())});
  }
  return estimate_scale(pairs, T_reference_camera.R());
}

}  // namespace

std::optional<AlignedViews> align_views(const View& reference, const View& view,
                                        const PredictedView& predicted, const Sensor& sensor) {
  constexpr ProjectionMatchOptions kMatching{.max_distance = 64, .max_ratio = 0.8};
  constexpr AbsolutePoseOptions kPose{.min_inliers = 30};  // as many as a loop needs
  const ExpectedPoints expected = expected_points(view.features, predicted, sensor.camera);
  const FeatureGrid grid(reference.features, sensor.camera.width, sensor.camera.height);
  const auto matches = match_by_projection(expected.projected, reference.features, grid, kMatching);
  std::vector<PoseObservation> observations;
  for (const Match& match : matches)
    observations.push_back(
        {compensated_measurement(reference.features, match.b), expected.p_camera[match.a]});
  if (static_cast<int>(observations.size()) < kPose.min_inliers) return std::nullopt;
  const auto solution =
      solve_absolute_pose(sensor, observations, predicted.T_reference_camera.inverse(), kPose);
  if (!solution) return std::nullopt;
  const SE3 T_reference_camera = solution->T_reference_camera.inverse();
  if (!is_explained(predicted, T_reference_camera)) return std::nullopt;
  return AlignedViews{T_reference_camera,
                      scale_of({reference, view, expected, matches}, T_reference_camera, sensor)};
}

}  // namespace kinloop
