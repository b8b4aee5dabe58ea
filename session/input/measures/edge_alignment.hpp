#pragma once
// In: the two images of some frames. Out: how depth lies to colour, by the mapping of depth borders that best
// meets colour edges: registered, mirrored, flipped, of another scale or shifted.

#include <optional>
#include <span>
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

/// Maps pixels of the depth image to those of colour: p - middle -> scale * (p - middle) + shift.
struct DepthMapping {
  Eigen::Vector2d scale = {1, 1};  ///< negative where mirrored
  Eigen::Vector2d shift = {0, 0};  ///< as a share of the larger side of the image

  [[nodiscard]] bool is_mirrored() const { return scale.x() < 0 || scale.y() < 0; }
};

/// How well depth borders meet colour edges, in standard deviations over shifts that mean nothing.
struct EdgeAlignment {
  DepthMapping best;
  double best_score = 0;
  double registered_score = 0;  ///< of the depth image as it is, shifted by hardly more than motion explains
  double other_score = 0;       ///< of the best mapping unlike `best` and unlike the depth image as it is
};

/// Which mappings are tried: all, or only the image as it is and mirrored, at a thirtieth of the time.
enum class AlignmentSearch { kMirrored, kAll };

/// Returns nullopt if there are too few borders.
std::optional<EdgeAlignment> align_edges(std::span<const EdgeSample> samples, AlignmentSearch search);

}  // namespace kinloop
