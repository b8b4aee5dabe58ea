#pragma once
// In: the two images of a frame. Out: what tells whether they show the same view, the edges of colour and the
// borders of near objects in depth, both at a small size.

#include <vector>

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>

#include "kinloop/sensor/frame.hpp"

namespace kinloop {

/// Edges of a frame, in pixels of an image whose larger side is at most 160 px.
struct EdgeSample {
  static constexpr int kMargin_px = 12;  ///< of zeros around `edges`: the largest shift that is tried

  cv::Size size;                         ///< without the margin
  cv::Mat edges;                         ///< 32FC1 with the margin: contrast of colour edges, of zero mean
  std::vector<Eigen::Vector2f> borders;  ///< of near objects in depth, relative to the middle of the image
};

/// Returns the edges of a frame, prepared or not.
EdgeSample make_edge_sample(const Frame& frame);

}  // namespace kinloop
