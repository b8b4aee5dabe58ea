#pragma once

#include "kinloop/core/options.hpp"
#include "kinloop/optimize/bundle/bundle.hpp"

namespace kinloop {

struct MappingOptions {
  double max_depth_m = 6.0;
  int cull_after_keyframes = 3;
  int cull_min_observations = 2;
  double local_map_window_px = 4;
  int triangulation_keyframes = 4;
  bool complete_tracks = true;
  bool local_ba_enabled = true;
  int local_ba_keyframes = 12;
  // max_iterations: the next local bundle adjustment continues the optimization.
  BundleOptions local_ba = {.rounds = 1, .max_iterations = 3, .tolerance = 1e-3};

  template <class Self, class Visit>
  static void fields(Self& self, Visit&& visit) {
    visit("max_depth_m", self.max_depth_m, "maximum depth of new landmarks, m", Range{0.5, 100});
    visit("cull_after_keyframes", self.cull_after_keyframes,
          "keyframes after which a new landmark is checked for culling", Range{1, 100}, Expert{});
    visit("cull_min_observations", self.cull_min_observations,
          "minimum observations for a landmark to be kept", Range{1, 100}, Expert{});
    visit("local_map_window_px", self.local_map_window_px,
          "search radius when matching local map landmarks to a new keyframe, px", Range{0.5, 50}, Expert{});
    visit("triangulation_keyframes", self.triangulation_keyframes,
          "covisible keyframes used to triangulate keypoints without depth; 0 = off", Range{0, 100},
          Expert{});
    visit("complete_tracks", self.complete_tracks,
          "complete and merge landmark tracks before the final bundle adjustment", Expert{});
    visit("local_ba_enabled", self.local_ba_enabled, "run local bundle adjustment after each keyframe");
    visit("local_ba_keyframes", self.local_ba_keyframes, "free keyframes in local bundle adjustment",
          Range{2, 200});
    visit("local_ba", self.local_ba, Expert{});
  }
};

}  // namespace kinloop
