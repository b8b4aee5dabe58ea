#pragma once
// What a camera of 640 x 480 pixels sees of a wall that faces it.

#include <memory>

#include <opencv2/core.hpp>

#include "kinloop/core/random.hpp"
#include "kinloop/features/features.hpp"

namespace kinloop::test {

/// Returns keypoints all over the image, at the depth of the wall, that all look the same.
inline std::shared_ptr<const Features> wall_view(double wall_m) {
  Features features;
  for (float y = 20; y < 470; y += 15) {
    for (float x = 20; x < 630; x += 15) features.pixels.emplace_back(x, y);
  }
  features.depths_m.assign(features.size(), static_cast<float>(wall_m));
  features.inverse_depth_gradients.assign(features.size(), Eigen::Vector2f::Zero());
  features.levels.assign(features.size(), 0);
  features.sigmas_px.assign(features.size(), 1);
  features.descriptors = cv::Mat::zeros(static_cast<int>(features.size()), 32, CV_8UC1);
  return std::make_shared<const Features>(std::move(features));
}

/// Returns the same with keypoints that all look different, but like those of every other such view.
inline std::shared_ptr<const Features> painted_wall_view(double wall_m) {
  Features features = *wall_view(wall_m);
  Random random(1);
  for (auto byte = features.descriptors.begin<uint8_t>(); byte != features.descriptors.end<uint8_t>(); ++byte)
    *byte = static_cast<uint8_t>(random.next());
  return std::make_shared<const Features>(std::move(features));
}

/// Changes how the upper quarter of a view looks.
inline void repaint(Features& features) {
  cv::Mat upper = features.descriptors.rowRange(0, features.descriptors.rows / 4);
  cv::bitwise_not(upper, upper);
}

}  // namespace kinloop::test
