#pragma once

#include "kinloop/core/options.hpp"
#include "kinloop/optimize/pose/absolute_pose.hpp"
#include "kinloop/optimize/pose/icp.hpp"
#include "kinloop/optimize/pose/ransac/pnp_ransac.hpp"
#include "kinloop/optimize/pose/ransac/rigid_ransac.hpp"

namespace kinloop {

struct KeyframeOptions {
  double min_tracked_ratio = 0.85;
  double max_rotation_rad = 0.20;
  double max_relative_translation = 0.08;
  int min_landmarks = 100;
  int min_unmapped_keypoints = 100;
  int max_interval_frames = 45;

  template <class Self, class Visit>
  static void fields(Self& self, Visit&& visit) {
    visit(
        "min_tracked_ratio", self.min_tracked_ratio,
        "insert a keyframe when the tracked fraction of the reference keyframe's landmarks falls below this",
        Range{0.05, 1}, Expert{});
    visit("max_rotation_rad", self.max_rotation_rad,
          "rotation since the nearest keyframe that triggers a new one, rad", Range{0.01, 3.2});
    visit("max_relative_translation", self.max_relative_translation,
          "translation since the nearest keyframe that triggers a new one, relative to the median depth; "
          "half as much "
          "again for frames that are tracked directly",
          Range{0.005, 10});
    visit("min_landmarks", self.min_landmarks,
          "insert a keyframe when fewer landmarks are tracked and enough keypoints are unmapped",
          Range{0, 10000}, Expert{});
    visit("min_unmapped_keypoints", self.min_unmapped_keypoints,
          "unmapped keypoints with depth required for that", Range{0, 10000}, Expert{});
    visit("max_interval_frames", self.max_interval_frames,
          "maximum number of frames between keyframes while the camera moves", Range{1, 100000});
  }
};

struct TrackingOptions {
  double window_px = 6;
  double wide_window_px = 60;
  double local_map_window_px = 5;
  int min_matches = 20;
  int min_inliers = 15;
  int min_confident_inliers = 60;
  int sufficient_landmarks = 60;
  double min_inlier_ratio = 0.1;
  KeyframeOptions keyframe;
  AbsolutePoseOptions pose;
  PnpRansacOptions pnp;
  RigidRansacOptions rigid;
  IcpOptions icp;

  template <class Self, class Visit>
  static void fields(Self& self, Visit&& visit) {
    visit("window_px", self.window_px, "minimum search radius around a predicted keypoint, px",
          Range{2, 200});
    visit("wide_window_px", self.wide_window_px,
          "search radius of the second attempt and upper limit of the first, px", Range{2, 400});
    visit("local_map_window_px", self.local_map_window_px, "search radius for local map landmarks, px",
          Range{1, 100}, Expert{});
    visit("min_matches", self.min_matches, "minimum number of matches for a tracking attempt", Range{4, 1000},
          Expert{});
    visit("min_inliers", self.min_inliers, "minimum number of inliers for a valid pose", Range{4, 1000});
    visit("min_confident_inliers", self.min_confident_inliers,
          "inliers against the previous frame below which wider searches are attempted", Range{4, 10000},
          Expert{});
    visit("sufficient_landmarks", self.sufficient_landmarks,
          "with fewer tracked landmarks, also use unmapped points of the previous frame", Range{0, 10000},
          Expert{});
    visit("min_inlier_ratio", self.min_inlier_ratio,
          "minimum fraction of the visible landmarks (or keypoints, if fewer) that must be inliers for a "
          "pose found by brute-force matching or from the map alone",
          Range{0, 1}, Expert{});
    visit("keyframe", self.keyframe);
    visit("pose", self.pose, Expert{});
    visit("pnp", self.pnp, Expert{});
    visit("rigid", self.rigid, Expert{});
    visit("icp", self.icp, Expert{});
  }
};

}  // namespace kinloop
