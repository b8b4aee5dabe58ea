#pragma once

#include "kinloop/base/options.hpp"
#include "kinloop/map/local_view.hpp"
#include "kinloop/optimize/pnp_ransac.hpp"
#include "kinloop/optimize/pose_graph.hpp"

namespace kinloop {

struct LoopOptions {
  bool enabled = true;
  int min_gap_keyframes = 10;
  int max_candidates = 5;
  double min_score_share = 0.8;
  int consistent_keyframes = 2;
  int max_distance = 64;
  int min_matches = 20;
  int min_inliers = 30;
  double min_found_share = 0.2;
  double max_seen_through = 0.005;
  double min_chance = 1e-3;
  double window_px = 10;
  int edge_min_shared = 60;
  double landmark_sigma_m = 0.05;
  double landmark_sigma_rad = 0.02;
  PoseGraphOptions pose_graph;

  template <class Self, class Visit>
  static void fields(Self& self, Visit&& visit) {
    visit("enabled", self.enabled, "look for loops and close them");
    visit("min_gap_keyframes", self.min_gap_keyframes, "keyframes between the two ends of a loop at least",
          Range{1, 100000});
    visit("max_candidates", self.max_candidates, "places of the index that are looked at closely",
          Range{1, 100});
    visit("min_score_share", self.min_score_share,
          "likeness of a candidate against the least alike neighbour of the keyframe", Range{0, 10});
    visit("consistent_keyframes", self.consistent_keyframes,
          "keyframes in a row that must point to the same place", Range{1, 20});
    visit("max_distance", self.max_distance, "Hamming distance of a match at most, bits", Range{1, 256});
    visit("min_matches", self.min_matches, "descriptor matches without which a candidate is dropped",
          Range{4, 1000});
    visit("min_inliers", self.min_inliers, "landmarks that must agree with the loop", Range{10, 1000});
    visit(
        "min_found_share", self.min_found_share,
        "share that must be found and agree of the landmarks in sight, or of the key points where these are "
        "fewer",
        Range{0, 1});
    visit("max_seen_through", self.max_seen_through,
          "share of key points that may lie clearly in front of what the other view measured there",
          Range{0, 1});
    visit("min_chance", self.min_chance,
          "chance that views of one place differ as much as these where they differ most", Range{0, 1});
    visit("window_px", self.window_px, "search window of the guided matching (half side), px", Range{1, 100});
    visit("edge_min_shared", self.edge_min_shared,
          "shared landmarks that tie two keyframes in the pose graph", Range{1, 10000});
    visit("landmark_sigma_m", self.landmark_sigma_m,
          "what one shared landmark tells of a relative position, standard deviation, m", Range{1e-6, 10});
    visit("landmark_sigma_rad", self.landmark_sigma_rad,
          "what one shared landmark tells of a relative rotation, standard deviation, rad", Range{1e-6, 10});
    visit("pose_graph", self.pose_graph);
  }
};

}  // namespace kinloop
