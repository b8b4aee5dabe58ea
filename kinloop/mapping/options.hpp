#pragma once

#include "kinloop/base/options.hpp"
#include "kinloop/optimize/bundle.hpp"

namespace kinloop {

struct MappingOptions {
  double max_depth_m = 6.0;
  int cull_after_keyframes = 3;
  int cull_min_observations = 2;
  double attach_window_px = 4;
  int parallax_keyframes = 4;
  double min_parallax_rad = 0.03;
  int parallax_max_distance = 50;
  bool complete_tracks = true;
  bool local_adjustment = true;
  int window_keyframes = 12;
  int window_min_shared = 15;
  int window_max_fixed = 20;
  // The next keyframe goes on from there.
  BundleOptions bundle = {.rounds = 1, .max_iterations = 4, .tolerance = 1e-3};

  template <class Self, class Visit>
  static void fields(Self& self, Visit&& visit) {
    visit("max_depth_m", self.max_depth_m, "key points farther than this make no landmarks, m",
          Range{0.5, 100});
    visit("cull_after_keyframes", self.cull_after_keyframes,
          "keyframes after which a landmark must have proven itself", Range{1, 100});
    visit("cull_min_observations", self.cull_min_observations, "observations that prove a landmark",
          Range{1, 100});
    visit("attach_window_px", self.attach_window_px,
          "search window (half side) in which a keyframe looks for older landmarks, px", Range{0.5, 50});
    visit("parallax_keyframes", self.parallax_keyframes,
          "covisible keyframes with which key points without depth are triangulated; 0 = none",
          Range{0, 100});
    visit("min_parallax_rad", self.min_parallax_rad,
          "angle between the two rays of a triangulated point at least, rad", Range{0.001, 1});
    visit("parallax_max_distance", self.parallax_max_distance,
          "Hamming distance of key points that are triangulated at most, bits", Range{1, 256});
    visit("complete_tracks", self.complete_tracks,
          "look for all landmarks once more in all keyframes around them when the map is finished");
    visit("local_adjustment", self.local_adjustment,
          "adjust the newest keyframes and their landmarks together");
    visit("window_keyframes", self.window_keyframes, "keyframes moved by the local adjustment",
          Range{2, 200});
    visit("window_min_shared", self.window_min_shared,
          "shared landmarks that bring a keyframe into the window", Range{1, 1000});
    visit("window_max_fixed", self.window_max_fixed, "keyframes around the window that hold it in place",
          Range{1, 1000});
    visit("bundle", self.bundle);
  }
};

}  // namespace kinloop
