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

/// What the edges of a frame are found in. It costs a fraction of finding them.
struct EdgeImages {
  cv::Mat gray;     ///< 8UC1, not smaller than the sample
  cv::Mat depth_m;  ///< 32FC1 of the size of the sample, 0 = unknown
};

/// Returns the images of a frame, prepared or not.
EdgeImages edge_images_of(const Frame& frame);

/// Returns the edges in these images, or in those of a frame.
EdgeSample make_edge_sample(const EdgeImages& images);
EdgeSample make_edge_sample(const Frame& frame);

}  // namespace kinloop
