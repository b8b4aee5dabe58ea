#include "kinloop/slam/options.hpp"

namespace kinloop {
namespace {

/// Options that have moved since the previous version.
std::vector<RenamedOption> renamed_options() {
  return {{"view.max_keyframes", "local_map.max_keyframes"},
          {"view.max_landmarks", "local_map.max_landmarks"},
          {"full_adjustment", "global_ba_enabled"},
          {"full.*", "global_ba.*"},
          {"min_start_points", "min_initial_keypoints"},
          {"lost_frames_before_component", "lost_frames_before_new_component"},
          {"mapping.local_adjustment", "mapping.local_ba_enabled"},
          {"mapping.window_keyframes", "mapping.local_ba_keyframes"},
          {"mapping.attach_window_px", "mapping.local_map_window_px"},
          {"mapping.bundle.*", "mapping.local_ba.*"},
          {"mapping.parallax_keyframes", "mapping.triangulation_keyframes"},
          {"executor.full_lag_frames", "executor.global_ba_lag_frames"},
          {"executor.local_lag_frames", "executor.local_ba_lag_frames"},
          {"executor.verify_lag_frames", "executor.loop_verification_lag_frames"},
          {"executor.loop_lag_frames", "executor.loop_correction_lag_frames"},
          {"self_calibration.first_keyframes", "self_calibration.min_keyframes"},
          {"self_calibration.depth_offset_sigma_per_m", "self_calibration.inverse_depth_bias_sigma_per_m"},
          {"self_calibration.max_sigma_share", "self_calibration.max_sigma_ratio"},
          {"tracking.keyframe.min_tracked_share", "tracking.keyframe.min_tracked_ratio"},
          {"tracking.keyframe.max_shift", "tracking.keyframe.max_relative_translation"},
          {"tracking.keyframe.max_angle_rad", "tracking.keyframe.max_rotation_rad"},
          {"tracking.keyframe.min_unmapped", "tracking.keyframe.min_unmapped_keypoints"},
          {"tracking.keyframe.max_gap_frames", "tracking.keyframe.max_interval_frames"},
          {"tracking.view_window_px", "tracking.local_map_window_px"},
          {"tracking.certain_inliers", "tracking.min_confident_inliers"},
          {"tracking.enough_landmarks", "tracking.sufficient_landmarks"},
          {"tracking.min_found_share", "tracking.min_inlier_ratio"},
          {"tracking.pnp.pose.*", "tracking.pose.*"},
          {"loop.min_score_share", "loop.min_score_ratio"},
          {"loop.max_distance", "loop.max_hamming_distance"},
          {"loop.min_found_share", "loop.min_inlier_ratio"},
          {"loop.max_seen_through", "loop.max_free_space_violation_ratio"},
          {"loop.min_chance", "loop.min_p_value"},
          {"loop.edge_min_shared", "loop.covisibility_edge_min_landmarks"},
          {"loop.pose_graph.robust", "loop.pose_graph.robust_kernel"}};
}

/// Options of the previous version that are now constants.
std::vector<std::string> removed_options() {
  return {"view.min_shared",
          "local_map.min_shared_landmarks",
          "mapping.min_parallax_rad",
          "mapping.parallax_max_distance",
          "mapping.triangulation_max_hamming_distance",
          "mapping.window_min_shared",
          "mapping.local_ba_min_shared_landmarks",
          "mapping.window_max_fixed",
          "mapping.local_ba_max_fixed_keyframes",
          "tracking.window_sigmas",
          "tracking.refine_with_icp",
          "tracking.min_icp_overlap",
          "tracking.rigid.inlier_chi2",
          "tracking.rigid.inverse_depth_sigma_per_m",
          "tracking.rigid.refinements",
          "tracking.icp.max_distance_m",
          "tracking.icp.max_normal_angle_rad",
          "tracking.icp.robust_width",
          "tracking.icp.inverse_depth_sigma_per_m",
          "tracking.icp.correlated_px",
          "tracking.icp.correlation_length_px",
          "tracking.icp.intensity_sigma",
          "tracking.icp.guess_sigma_m",
          "tracking.icp.prior_sigma_m",
          "tracking.icp.guess_sigma_rad",
          "tracking.icp.prior_sigma_rad"};
}

}  // namespace

OptionHistory SlamOptions::history() {
  OptionHistory history{renamed_options(), removed_options()};
  for (const std::string solver : {"tracking.pose.", "mapping.local_ba.", "global_ba."}) {
    for (const char* name :
         {"inverse_depth_sigma_per_m", "robust_width", "inlier_chi2_pixel", "inlier_chi2_depth"})
      history.renamed.push_back({solver + name, std::string("noise.") + name});
    for (const char* name :
         {"free_velocities", "velocity_sigma_m_s", "velocity_sigma_rad_s", "pose_covariances"})
      history.removed.push_back(solver + name);
  }
  return history;
}

TrackerOptions tracker_options(const SlamOptions& o) {
  return {o.features,
          o.tracking,
          o.local_map,
          o.min_initial_keypoints,
          o.lost_frames_before_new_component,
          o.localize_only,
          static_cast<uint64_t>(o.seed)};
}

MapperOptions mapper_options(const SlamOptions& o) {
  return {o.local_map, o.mapping};
}

PlaceOptions place_options(const SlamOptions& o) {
  return {o.tracking, o.local_map, o.loop, static_cast<uint64_t>(o.seed)};
}

BackEndOptions back_end_options(const SlamOptions& o) {
  return {o.executor, o.tracking,  o.local_map,         o.mapping,
          o.loop,     o.global_ba, o.global_ba_enabled, o.self_calibration};
}

}  // namespace kinloop
