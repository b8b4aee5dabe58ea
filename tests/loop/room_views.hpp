#pragma once

#include <gtest/gtest.h>

#include "kinloop/core/random.hpp"
#include "tests/support/synthetic_world.hpp"

namespace kinloop::test {

/// Two views of one wall in a room of points.
class RoomViews : public testing::Test {
 protected:
  RoomViews() {
    noise_.missing_depth_fraction = 0;  // keypoints without depth are not compared
    a_ = *observe(world_, T_world_a_, noise_, 1).features;
    b_ = *observe(world_, T_world_b_, noise_, 2).features;
  }

  /// Changes the keypoints of `b_` in the window, as if the image differed there.
  template <class Change>
  void in_window(double size_px, const Change& change) {
    const Eigen::Vector2f center(320, 240);
    for (uint32_t i = 0; i < b_.size(); ++i) {
      if ((b_.pixels[i] - center).lpNorm<Eigen::Infinity>() < size_px / 2) change(static_cast<int>(i));
    }
  }

  void repaint(int row, Random& random) {
    for (int byte = 0; byte < kOrbBytes; ++byte) {
      b_.descriptors.at<uint8_t>(row, byte) = static_cast<uint8_t>(random.next());
    }
  }

  SyntheticWorld world_ = make_world(12000, 1);
  ObservationNoise noise_;
  SE3 T_world_a_ = camera_at(0.05, {-0.1, 0, 0}), T_world_b_ = camera_at(-0.05, {0.1, 0, 0.1});
  Features a_, b_;
};

}  // namespace kinloop::test
