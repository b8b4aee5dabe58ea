#pragma once
// The chapters of the page of `kinloop reproduce`. Each runs commands of the program on the given data, or on
// what the simulated Kinect gives.

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include <nlohmann/json.hpp>

namespace kinloop {

/// Rows of text, the first of which is the heading.
using MarkdownTable = std::vector<std::vector<std::string>>;

/// Commands of the program, and the tables and pictures that they gave.
struct Chapter {
  std::string title;
  std::string text;                   ///< what the paper has, and what follows
  std::vector<std::string> commands;  ///< in the order in which they ran
  std::vector<MarkdownTable> tables;
  std::vector<std::pair<std::string, std::string>> pictures;  ///< caption, and name relative to the page
  std::vector<std::pair<std::string, std::string>> links;     ///< the same for reports
  nlohmann::json figures;                                     ///< of the tables, with all digits
};

/// Runs `kinloop WORDS...` as a process of its own, notes it in the chapter and returns its standard output.
/// Throws InputError if it fails; its messages go to standard error.
std::string run_program(Chapter& chapter, const std::vector<std::string>& words);

/// Returns the chapter in Markdown.
std::string to_markdown(const Chapter& chapter);

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
