#pragma once
// In: pairs of images. Out: what each detector finds, how long that takes, and how well it matches.

#include <filesystem>
#include <string>
#include <vector>

#include "apps/feature_pairs.hpp"
#include "kinloop/compare/measure_pair.hpp"
#include "kinloop/features/options.hpp"

namespace kinloop {

struct ComparisonArguments {
  PairsRequest request;
  std::vector<std::string> wanted;  ///< ids of detectors, all where empty
  std::filesystem::path pictures;   ///< folder of the PNGs, none where empty
  FeatureOptions features;
};

/// What was measured with one seed.
struct SeedFigures {
  std::vector<double> key_points;    ///< of each image
  std::vector<double> milliseconds;  ///< CPU time of each image, one thread
  std::vector<PairFigures> pairs;
};

/// What was measured of one detector.
struct DetectorFigures {
  std::string name, id;
  std::vector<SeedFigures> seeds;
};

/// Runs every detector on every pair. Throws UsageError and InputError as the other commands do.
std::vector<DetectorFigures> compare_detectors(const ComparisonArguments& arguments);

}  // namespace kinloop
