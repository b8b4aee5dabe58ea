#pragma once
// The interface of back-end jobs and the results of their solutions.
//
// Each kind of job is a class with
//   kName, Problem, Solution
//   kMovesWholeMap                   such jobs wait for each other and are repeated when stale
//   lag_frames()                     frames until the solution is applied, in lagged mode
//   is_due(context)                  whether a job should start
//   make_problem(context)            copies all its data out of the map
//   static solve(problem)            pure function; runs on another thread
//   apply(map, solution)             returns nothing if the solution is stale
//   on_stale(solution)               keeps what the next problem needs of it

#include <optional>
#include <vector>

#include "kinloop/back_end/options.hpp"
#include "kinloop/loop/correction/correct_loop.hpp"
#include "kinloop/loop/verification/verify_loop.hpp"
#include "kinloop/map/frames/frame_log.hpp"
#include "kinloop/map/map.hpp"
#include "kinloop/sensor/sensor_estimate.hpp"

namespace kinloop {

/// State of the run passed to jobs.
struct JobContext {
  const Map& map;
  const FrameLog& log;
  const Sensor& sensor;     ///< with the current corrections
  KeyframeId new_keyframe;  ///< valid if one was just inserted
};

/// A sensor that was estimated during the run.
struct AppliedSensor {
  SensorEstimate estimate;
  size_t compensated_keyframes = 0;  ///< so many have keypoints compensated by its times, in order of ids
};

/// By keyframe.
using VerifiedLoops = std::vector<std::vector<LoopVerificationResult>>;

/// Effects of an applied solution.
struct AppliedSolution {
  bool map_changed = true;
  VerifiedLoops verified = {};          ///< loop closures to be decided on
  bool loops_added = false;             ///< loop closures were added, for which the map must be corrected
  std::vector<LoopMerges> merges = {};  ///< landmarks that those loop closures identify
  std::vector<LoopEnds> contradicted_joins =
      {};                        ///< loop closures taken back because the visits look different
  bool loops_corrected = false;  ///< the pose graph was solved with all its loops
  /// If components were parted: T_world_camera of all keyframes before.
  std::vector<SE3> T_world_keyframe_before = {};
  std::optional<AppliedSensor> sensor = {};  ///< set if newly estimated
};

}  // namespace kinloop
