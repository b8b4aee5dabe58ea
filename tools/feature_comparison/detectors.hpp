#pragma once
// In: a grey image. Out: keypoints and descriptors by SIFT, SURF, OpenCV's ORB and kinloop's ORB, all as
// `Features`.

#include <functional>
#include <string>
#include <vector>

#include "kinloop/features/features.hpp"
#include "kinloop/features/options.hpp"
#include "kinloop/geometry/camera.hpp"

namespace kinloop {

/// A keypoint detector with its descriptor.
struct Detector {
  std::string name;                                     ///< "ORB (ours)"
  std::string id;                                       ///< for file names and JSON: "orb"
  std::function<Features(const cv::Mat& gray)> detect;  ///< of an 8UC1 image; depths stay unknown
};

/// Returns all detectors of this build, each limited to `options.count` keypoints: SIFT (Lowe 2004), SURF
/// (Bay et al. 2006; with dlib), cv::ORB (Rublee et al. 2011) and `extract_features`.
std::vector<Detector> make_detectors(const FeatureOptions& options, const PinholeCamera& camera);

}  // namespace kinloop
