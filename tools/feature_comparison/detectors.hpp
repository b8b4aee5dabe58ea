#pragma once
// In: a grey image. Out: keypoints and descriptors by SIFT, SURF, OpenCV's ORB and ours, all as `Features`.

#include <functional>
#include <string>
#include <vector>

#include "kinloop/features/features.hpp"
#include "kinloop/features/options.hpp"
#include "kinloop/geometry/camera.hpp"

namespace kinloop {

/// One way to find and describe keypoints.
struct Detector {
  std::string name;                                     ///< "ORB (ours)"
  std::string id;                                       ///< for file names and JSON: "orb"
  std::function<Features(const cv::Mat& gray)> detect;  ///< of an 8UC1 image; depths stay unknown
};

/// All that this build has, each asked for `options.count` keypoints: SIFT (Lowe 2004), SURF (Bay et al.
/// 2006; where dlib was found), cv::ORB (Rublee et al. 2011) and `extract_features`.
std::vector<Detector> make_detectors(const FeatureOptions& options, const PinholeCamera& camera);

}  // namespace kinloop
