#pragma once
// The last step of a run: bundle adjustment of the whole map to convergence together with the sensor
// parameters, completion of tracks over all keyframes, and refinement of every frame pose on the final map.

#include "kinloop/back_end/options.hpp"
#include "kinloop/back_end/self_calibration.hpp"
#include "kinloop/core/progress.hpp"
#include "kinloop/map/frames/frame_log.hpp"
#include "kinloop/sensor/sensor_estimate.hpp"

namespace kinloop {

struct FinalBundleAdjustment {
  SensorEstimate sensor;
  /// Per keyframe, the covariance of x = (translation [m]; rotation [rad]), where the true pose is
  /// T_world_camera * exp(x), relative to the first keyframe of its component (whose covariance is zero).
  /// Without what the keypoints of a frame share, see pose_covariances. Empty if `progress` stopped early.
  std::vector<Matrix6d> keyframe_covariance;
};

/// Adjusts `map` and refines `log`, starting from the given sensor estimate.
FinalBundleAdjustment final_bundle_adjustment(Map& map, FrameLog& log, const SensorEstimate& initial_estimate,
                                              const BackEndOptions& options, const Progress& progress = {});

}  // namespace kinloop
