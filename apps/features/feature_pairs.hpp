#pragma once
// In: what the user wants features compared on. Out: pairs of images of one place, one after the other.

#include <functional>
#include <memory>
#include <optional>
#include <string>

#include <opencv2/core/mat.hpp>

#include "kinloop/geometry/camera.hpp"
#include "kinloop/sensor/frame_source.hpp"

namespace kinloop {

/// Where pairs come from.
struct PairsRequest {
  std::string input;        ///< an image file, a folder in TUM layout or sim:room
  std::string other_image;  ///< a second image file; empty: none
  std::string camera;       ///< of a sequence, as for kinloop run
  size_t pairs = 8;         ///< of frames, for each seed
  size_t gap = 10;          ///< frames between the two of a pair
  size_t seeds = 5;
};

/// One image, and what is known of where it was taken from.
struct PairView {
  cv::Mat gray, depth_m;  ///< no depth for image files
  std::optional<SE3> T_world_camera;
};

/// Two images of the same place.
struct ImagePair {
  PairView a, b;
  std::optional<Eigen::Matrix3d> H_b_a;  ///< of an image and its picture
  size_t seed = 0;                       ///< that chose it
  bool shown = false;                    ///< whether it is the one that pictures are made of
};

/// Pairs that are ready to be gone through.
struct OpenPairs {
  PairsRequest request;
  PinholeCamera camera;
  std::optional<ImagePair> images;      ///< of image files
  std::unique_ptr<FrameSource> source;  ///< else
};

/// Of one image: itself and a picture of it, turned and tilted. Of two: these. Of a sequence: pairs of
/// frames. Throws UsageError and InputError as the other commands do.
OpenPairs open_pairs(const PairsRequest& request);

/// Goes through all pairs: images once for every seed; of a sequence, for every seed other pairs, spread over
/// it.
void for_each_pair(OpenPairs& pairs, const std::function<void(const ImagePair&)>& visit);

}  // namespace kinloop
