#pragma once
// What happens once all frames are there: the whole map is adjusted to convergence together with the sensor,
// its landmarks are looked for once more in all keyframes, and every frame is refined on the final map.

#include "kinloop/base/progress.hpp"
#include "kinloop/slam/frame_log.hpp"
#include "kinloop/slam/options.hpp"
#include "kinloop/slam/self_calibration.hpp"

namespace kinloop {

struct FinalBundleAdjustment {
  SensorEstimate sensor;
  /// Per keyframe: of x = (translation; rotation), where its true pose is T_world_camera * exp(x), relative
  /// to the first keyframe of its component (zero). Empty where `progress` ended it early.
  std::vector<Matrix6d> keyframe_covariance;
};

/// Adjusts `map` and refines `log`, starting from what is known of the sensor.
FinalBundleAdjustment final_bundle_adjustment(Map& map, FrameLog& log, const RgbdCamera& camera,
                                              const SensorEstimate& known, const SlamOptions& options,
                                              const Progress& progress = {});

/// Which of the tracked frames are refined.
enum class FrameSelection {
  kAll,
  kNearKeyframes,  ///< those that the velocities of keyframes are made of
};

/// Refines tracked frames on the landmarks they saw, as the map stands now, for a sensor with the given
/// corrections. The result does not depend on `threads`.
FrameLog refine_frames(FrameLog log, const Map& map, const PinholeCamera& camera, const SensorVector& sensor,
                       const AbsolutePoseOptions& options, FrameSelection which, int threads);

}  // namespace kinloop
