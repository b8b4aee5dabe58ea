#pragma once
// In: two trajectories as files have them. Out: their differences, and what a user should know of them. Input
// whose figures would mean nothing is refused, with the remedy.

#include <string>
#include <vector>

#include "tools/evaluation/evaluate.hpp"
#include "tools/evaluation/trajectory_files/trajectory_file.hpp"

namespace kinloop {

/// A trajectory with the name that messages give it.
struct NamedTrajectory {
  std::string name;
  TrajectoryFile file;
};

/// Which trajectories to compare, and how.
struct ComparisonRequest {
  NamedTrajectory estimate;
  NamedTrajectory truth;
  EvaluationOptions options = {};
  bool estimate_offset = false;  ///< find the clock offset, instead of EvaluationOptions::offset_ns
};

/// The figures, the trajectories as they were compared, and one line for each thing that was recognised or
/// odd.
struct Comparison {
  Evaluation evaluation;
  Trajectory estimate;  ///< with the stamps of the truth's clock
  Trajectory truth;
  std::vector<std::string> notes;
};

/// Compares them. Throws InputError where no figure would be right: positions beyond any world, stamps that
/// repeat, poses without stamps in other numbers, times that do not overlap, a clock offset that the motion
/// does not tell.
Comparison compare(ComparisonRequest request);

}  // namespace kinloop
