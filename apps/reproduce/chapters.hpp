#pragma once
// The chapters of the page of `kinloop reproduce`. Each runs commands of the program on the given data, or on
// what the simulated Kinect gives.

#include <filesystem>
#include <string>

#include "apps/reproduce/chapter.hpp"

namespace kinloop {

struct ReproduceArguments {
  std::string sequence;          ///< empty: the simulated room
  std::filesystem::path images;  ///< to train vocabularies on; empty: those of the simulated room
  std::filesystem::path stills;  ///< of a chessboard; empty: drawn ones
  std::string board = "5x7";     ///< of the stills
  double square_m = 0.03;
  std::filesystem::path output = "reproduced";
};

/// Where the chapters find their data and put their results.
struct ReproduceFolder {
  ReproduceArguments arguments;
  std::string sequence;  ///< the folder of the sequence

  /// Returns a path in the output folder.
  [[nodiscard]] std::string at(const std::string& name) const { return (arguments.output / name).string(); }
};

/// Renders the simulated room if no sequence is given.
Chapter data_chapter(ReproduceFolder& folder);

/// Table 1, Figs. 3 and 4: SIFT, SURF and ORB; matches before and after the screen.
Chapter feature_chapter(const ReproduceFolder& folder);

/// The vocabulary: how the initial centres of k-means are chosen.
Chapter vocabulary_chapter(const ReproduceFolder& folder);

/// The calibration of a camera.
Chapter calibration_chapter(const ReproduceFolder& folder);

/// Figs. 5 and 7: the sequence with and without loops, a map of a million points; and the rolling shutter.
Chapter mapping_chapter(const ReproduceFolder& folder);

}  // namespace kinloop
