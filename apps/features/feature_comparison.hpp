#pragma once
// In: pairs of images. Out: keypoints, CPU time and matching quality of each detector.

#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "kinloop/features/options.hpp"
#include "kinloop/geometry/camera.hpp"
#include "kinloop/sensor/source/frame_source.hpp"
#include "session/source/open_frame_source.hpp"
#include "tools/feature_comparison/evaluate_pair.hpp"

namespace kinloop {

/// Source of the pairs.
struct PairsRequest {
  std::string input;        ///< an image file, a folder in TUM layout or sim:room
  std::string other_image;  ///< a second image file; empty: none
  std::string chosen;       ///< of several sequences in the folder, as for kinloop run
  CameraOptions camera;     ///< of a sequence, as for kinloop run
  size_t pairs = 8;         ///< of frames, for each seed
  size_t gap = 10;          ///< frames between the two images of a pair
  size_t seeds = 5;
};

/// An image and its viewpoint, as far as known.
struct PosedPicture {
  cv::Mat gray, depth_m;  ///< no depth for image files
  std::optional<SE3> T_world_camera;
};

/// Two images of the same place.
struct ImagePair {
  PosedPicture a, b;
  std::optional<Eigen::Matrix3d> H_b_a;  ///< from an image to its warped copy
  size_t seed = 0;                       ///< the seed that chose it
  bool shown = false;                    ///< whether it is the pair to draw
};

/// Pairs ready for iteration.
struct OpenPairs {
  PairsRequest request;
  PinholeCamera camera;
  std::optional<ImagePair> images;      ///< of image files
  std::unique_ptr<FrameSource> source;  ///< else
};

/// Opens the pairs: of one image, itself and a warped copy; of two, these; of a sequence, pairs of frames.
/// Throws UsageError and InputError as the other commands do.
OpenPairs open_pairs(const PairsRequest& request);

/// Iterates over all pairs: image files once for every seed; for a sequence, different pairs for every seed,
/// spread over it.
void for_each_pair(OpenPairs& pairs, const std::function<void(const ImagePair&)>& visit);

struct ComparisonArguments {
  PairsRequest request;
  std::vector<std::string> wanted;  ///< ids of detectors; all if empty
  std::filesystem::path pictures;   ///< folder of the PNGs; none if empty
  FeatureOptions features;
};

/// Measurements with one seed.
struct SeedMetrics {
  std::vector<double> keypoints;     ///< per image
  std::vector<double> milliseconds;  ///< CPU time per image, one thread
  std::vector<PairMetrics> pairs;
};

/// Measurements of one detector.
struct DetectorMetrics {
  std::string name, id;
  std::vector<SeedMetrics> seeds;
};

/// Runs every detector on every pair. Throws UsageError and InputError as the other commands do.
std::vector<DetectorMetrics> compare_detectors(const ComparisonArguments& arguments);

}  // namespace kinloop
