#pragma once

#include "kinloop/core/options.hpp"

namespace kinloop {

/// Keypoint detector and descriptor: ORB (Rublee et al. 2011), SIFT (Lowe 2004), SURF (Bay et al. 2006).
enum class FeatureKind { kOrb, kSift, kSurf };

constexpr auto option_names(FeatureKind) {
  return std::to_array<EnumName<FeatureKind>>(
      {{FeatureKind::kOrb, "orb"}, {FeatureKind::kSift, "sift"}, {FeatureKind::kSurf, "surf"}});
}

struct FeatureOptions {
  FeatureKind kind = FeatureKind::kOrb;
  int count = 1000;
  double scale_factor = 1.2;
  int levels = 8;
  int fast_threshold = 7;
  int cell_px = 32;
  double max_depth_step = 0.04;

  template <class Self, class Visit>
  static void fields(Self& self, Visit&& visit) {
    visit("kind", self.kind, "keypoint type; must match that of the vocabulary");
    visit("count", self.count, "maximum keypoints per image", Range{50, 20000});
    visit("scale_factor", self.scale_factor, "size ratio of one pyramid level to the next", Range{1.05, 2},
          Expert{});
    visit("levels", self.levels, "pyramid levels", Range{1, 16});
    visit("fast_threshold", self.fast_threshold,
          "FAST threshold: minimum contrast of a corner, intensity levels", Range{1, 100});
    visit("cell_px", self.cell_px, "cell size of the grid that distributes corners evenly, px of each level",
          Range{8, 256}, Expert{});
    visit("max_depth_step", self.max_depth_step,
          "maximum relative depth change around a keypoint for its depth to be used", Range{0, 1}, Expert{});
  }
};

}  // namespace kinloop
