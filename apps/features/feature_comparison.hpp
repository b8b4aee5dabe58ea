#pragma once
// In: pairs of images. Out: what each detector finds, how long that takes, and how well it matches.

#include <filesystem>
#include <string>
#include <vector>

#include "apps/features/feature_pairs.hpp"
#include "kinloop/features/options.hpp"
#include "tools/feature_comparison/evaluate_pair.hpp"

namespace kinloop {

struct ComparisonArguments {
  PairsRequest request;
  std::vector<std::string> wanted;  ///< ids of detectors, all where empty
  std::filesystem::path pictures;   ///< folder of the PNGs, none where empty
  FeatureOptions features;
};

/// What was measured with one seed.
struct SeedMetrics {
  std::vector<double> keypoints;     ///< of each image
  std::vector<double> milliseconds;  ///< CPU time of each image, one thread
  std::vector<PairMetrics> pairs;
};

/// What was measured of one detector.
struct DetectorMetrics {
  std::string name, id;
  std::vector<SeedMetrics> seeds;
};

/// Runs every detector on every pair. Throws UsageError and InputError as the other commands do.
std::vector<DetectorMetrics> compare_detectors(const ComparisonArguments& arguments);

}  // namespace kinloop
