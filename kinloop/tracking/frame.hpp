#pragma once
// A camera image prepared for tracking, and what is kept of it afterwards.

#include <memory>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "kinloop/base/ids.hpp"
#include "kinloop/base/stopwatch.hpp"
#include "kinloop/features/matcher.hpp"
#include "kinloop/geometry/se3.hpp"

namespace kinloop {

/// Everything computed from one image alone; it may be prepared ahead on another thread.
struct PreparedFrame {
  FrameId id;
  int64_t stamp_ns = 0;
  cv::Mat color;    ///< 8UC3 BGR
  cv::Mat gray;     ///< 8UC1
  cv::Mat depth_m;  ///< 32FC1
  std::shared_ptr<const Features> features;
  ElapsedTime preparing;  ///< for reports
};

/// The previous frame as kept by the tracker.
struct TrackedFrame {
  PreparedFrame frame;
  SE3 T_reference_camera;               ///< in the frame of the reference keyframe of the local map
  std::vector<LandmarkId> landmark_of;  ///< per keypoint; invalid if it has no landmark
};

}  // namespace kinloop
