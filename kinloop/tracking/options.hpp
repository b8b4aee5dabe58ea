#pragma once

#include "kinloop/base/options.hpp"
#include "kinloop/optimize/absolute_pose.hpp"
#include "kinloop/optimize/icp.hpp"
#include "kinloop/optimize/pnp_ransac.hpp"
#include "kinloop/optimize/rigid_ransac.hpp"

namespace kinloop {

struct KeyframeOptions {
  double min_tracked_share = 0.85;
  double max_angle_rad = 0.20;
  double max_shift = 0.08;
  int min_landmarks = 100;
  int min_unmapped = 100;
  int max_gap_frames = 45;

  template <class Self, class Visit>
  static void fields(Self& self, Visit&& visit) {
    visit(
        "min_tracked_share", self.min_tracked_share,
        "a new keyframe is made when fewer of the reference keyframe's landmarks than this share are tracked",
        Range{0.05, 1});
    visit("max_angle_rad", self.max_angle_rad, "turn since the last keyframe that asks for a new one, rad",
          Range{0.01, 3.2});
    visit("max_shift", self.max_shift,
          "shift since the last keyframe that asks for a new one, per median depth", Range{0.005, 10});
    visit("min_landmarks", self.min_landmarks,
          "tracked landmarks below which unmapped key points ask for a keyframe", Range{0, 10000});
    visit("min_unmapped", self.min_unmapped, "key points with depth but no landmark that then make one",
          Range{0, 10000});
    visit("max_gap_frames", self.max_gap_frames, "frames after which a moving camera gets a keyframe anyway",
          Range{1, 100000});
  }
};

struct TrackingOptions {
  double window_px = 6;
  double window_sigmas = 3;
  double wide_window_px = 60;
  double view_window_px = 5;
  int min_matches = 20;
  int min_inliers = 15;
  int certain_inliers = 60;
  int enough_landmarks = 60;
  double min_found_share = 0.1;
  bool refine_with_icp = false;
  double min_icp_overlap = 0.4;
  KeyframeOptions keyframe;
  AbsolutePoseOptions pose;
  PnpRansacOptions pnp;
  RigidRansacOptions rigid;
  IcpOptions icp;

  template <class Self, class Visit>
  static void fields(Self& self, Visit&& visit) {
    visit("window_px", self.window_px,
          "search window around a key point (half side) if its place were predicted exactly, px",
          Range{2, 200});
    visit("window_sigmas", self.window_sigmas,
          "widens the window by so many standard deviations of the predicted place", Range{0, 10});
    visit("wide_window_px", self.wide_window_px,
          "search window of the second try (half side), and the widest of the first, px", Range{2, 400});
    visit("view_window_px", self.view_window_px, "search window for the local map (half side), px",
          Range{1, 100});
    visit("min_matches", self.min_matches, "matches without which a way of tracking is given up",
          Range{4, 1000});
    visit("min_inliers", self.min_inliers, "inliers below which a pose is not believed", Range{4, 1000});
    visit("certain_inliers", self.certain_inliers,
          "inliers of the pose against the previous frame below which wider searches are tried as well",
          Range{4, 10000});
    visit("enough_landmarks", self.enough_landmarks,
          "tracked landmarks that do without the previous frame's unmapped points", Range{0, 10000});
    visit("min_found_share", self.min_found_share,
          "share of the landmarks in sight (or of the key points, where these are fewer) without which a "
          "pose found by brute force or from the map alone is not believed",
          Range{0, 1});
    visit("refine_with_icp", self.refine_with_icp,
          "also lay each depth and grey image onto the one before, and hold the pose to it as far as "
          "the surfaces tell");
    visit("min_icp_overlap", self.min_icp_overlap, "share of depth pixels that must agree in dense alignment",
          Range{0, 1});
    visit("keyframe", self.keyframe);
    visit("pose", self.pose);
    visit("pnp", self.pnp);
    visit("rigid", self.rigid);
    visit("icp", self.icp);
  }
};

}  // namespace kinloop
