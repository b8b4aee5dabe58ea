#pragma once
// In: an image or a sequence. Out: what each detector finds, how long that takes, and how well it matches.

#include <filesystem>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "kinloop/compare/measure_pair.hpp"
#include "kinloop/features/options.hpp"

namespace kinloop {

struct ComparisonArguments {
  std::string input;                ///< an image file, a folder in TUM layout or sim:room
  std::string camera;               ///< of a sequence, as for kinloop run
  std::vector<std::string> wanted;  ///< ids of detectors, all where empty
  std::filesystem::path pictures;   ///< folder of the PNGs, none where empty
  size_t pairs = 20;                ///< pairs of frames, evenly over the sequence
  size_t gap = 10;                  ///< frames between the two of a pair
  FeatureOptions features;
};

/// What was measured of one detector, over all pairs.
struct DetectorFigures {
  std::string name, id;
  std::vector<double> key_points;    ///< of each image
  std::vector<double> milliseconds;  ///< CPU time of each image, one thread
  std::vector<PairFigures> pairs;
};

/// Runs every detector on every pair. Throws UsageError and InputError as the other commands do.
std::vector<DetectorFigures> compare_detectors(const ComparisonArguments& arguments);

/// The figures as a table for people and as JSON for scripts.
std::string comparison_table(const std::vector<DetectorFigures>& figures);
nlohmann::json comparison_json(const std::vector<DetectorFigures>& figures);

}  // namespace kinloop
