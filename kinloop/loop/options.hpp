#pragma once

#include <cstdint>

#include "kinloop/core/options.hpp"
#include "kinloop/geometry/camera.hpp"
#include "kinloop/map/local_map.hpp"
#include "kinloop/optimize/pose_graph/pose_graph.hpp"
#include "kinloop/sensor/sensor.hpp"
#include "kinloop/tracking/options.hpp"

namespace kinloop {

struct LoopOptions {
  bool enabled = true;
  int min_gap_keyframes = 10;
  int max_candidates = 5;
  double min_score_ratio = 0.8;
  int max_hamming_distance = 64;
  int min_matches = 20;
  int min_inliers = 30;
  double min_inlier_ratio = 0.2;
  double max_free_space_violation_ratio = 0.005;
  double min_p_value = 1e-3;
  double window_px = 10;
  int covisibility_edge_min_landmarks = 60;
  double landmark_sigma_m = 0.05;
  double landmark_sigma_rad = 0.02;
  PoseGraphOptions pose_graph;

  template <class Self, class Visit>
  static void fields(Self& self, Visit&& visit) {
    visit("enabled", self.enabled, "detect and close loops");
    visit("min_gap_keyframes", self.min_gap_keyframes,
          "minimum number of keyframes between the two ends of a loop", Range{1, 100000});
    visit("max_candidates", self.max_candidates, "maximum number of loop candidates to verify", Range{1, 100},
          Expert{});
    visit("min_score_ratio", self.min_score_ratio,
          "minimum similarity score of a candidate relative to the lowest score of a covisible keyframe",
          Range{0, 10}, Expert{});
    visit("max_hamming_distance", self.max_hamming_distance,
          "maximum Hamming distance of a match in relocalization, bits", Range{1, 256}, Expert{});
    visit("min_matches", self.min_matches, "minimum descriptor matches of a candidate in relocalization",
          Range{4, 1000}, Expert{});
    visit("min_inliers", self.min_inliers, "minimum inlier landmarks of a verified loop", Range{10, 1000});
    visit("min_inlier_ratio", self.min_inlier_ratio,
          "minimum inlier fraction of the visible landmarks, or of the keypoints if there are "
          "fewer",
          Range{0, 1}, Expert{});
    visit("max_free_space_violation_ratio", self.max_free_space_violation_ratio,
          "maximum fraction of keypoints that violate free space observed by the other view", Range{0, 1},
          Expert{});
    visit("min_p_value", self.min_p_value,
          "minimum p-value of the appearance check; lower means the two views show different scenes",
          Range{0, 1}, Expert{});
    visit("window_px", self.window_px, "search radius of guided matching, px", Range{1, 100}, Expert{});
    visit("covisibility_edge_min_landmarks", self.covisibility_edge_min_landmarks,
          "minimum shared landmarks for a covisibility edge in the pose graph", Range{1, 10000}, Expert{});
    visit("landmark_sigma_m", self.landmark_sigma_m,
          "relative position uncertainty per shared landmark (1 sigma), m", Range{1e-6, 10}, Expert{});
    visit("landmark_sigma_rad", self.landmark_sigma_rad,
          "relative rotation uncertainty per shared landmark (1 sigma), rad", Range{1e-6, 10}, Expert{});
    visit("pose_graph", self.pose_graph);
  }
};

/// What place recognition uses.
struct PlaceOptions {
  TrackingOptions tracking;
  LocalMapOptions local_map;
  LoopOptions loop;
  uint64_t seed = 1;
};

/// The sensor and the options with which places are recognised. The corrections of the sensor are not used:
/// frames and keyframes are motion-compensated.
struct PlaceContext {
  Sensor sensor;
  PlaceOptions options = {};
};

}  // namespace kinloop
