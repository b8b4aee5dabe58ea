#pragma once
// What jobs of the back end are made of, and what becomes of their solutions.
//
// Each kind of job is a class with
//   kName, Problem, Solution
//   kMovesWholeMap                   such jobs wait for corrections, and are due again where stale
//   lag_frames()                     frames until the solution is applied, in lagged mode
//   is_due(context)                  whether one should start
//   make_problem(context)            copies all it takes out of the map
//   static solve(problem)            pure; runs on another thread
//   apply(map, solution)             nothing where the solution is stale
//   on_stale(solution)               keeps what the next problem needs of it

#include <optional>
#include <vector>

#include "kinloop/loop/verify_loop.hpp"
#include "kinloop/slam/frame_log.hpp"
#include "kinloop/slam/options.hpp"

namespace kinloop {

/// The state of a run as jobs see it.
struct JobContext {
  const Map& map;
  const FrameLog& log;
  const SensorVector& sensor;
  KeyframeId new_keyframe;  ///< valid where one was just inserted
};

/// What an applied solution did.
struct AppliedSolution {
  bool map_changed = true;
  std::vector<LoopConstraint> loops = {};     ///< added to the map, to be corrected
  bool loops_corrected = false;               ///< the pose graph was solved with all its loops
  std::optional<SensorEstimate> sensor = {};  ///< where it was estimated anew
};

}  // namespace kinloop
