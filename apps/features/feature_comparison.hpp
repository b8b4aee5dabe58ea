#pragma once
// In: pairs of images. Out: keypoints, CPU time and matching quality of each detector.

#include <filesystem>
#include <string>
#include <vector>

#include "apps/features/feature_pairs.hpp"
#include "kinloop/features/options.hpp"
#include "tools/feature_comparison/evaluate_pair.hpp"

namespace kinloop {

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
