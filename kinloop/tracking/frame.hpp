#pragma once
// A camera image prepared for tracking, and the part of it kept for the next frame.

#include <memory>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "kinloop/core/ids.hpp"
#include "kinloop/core/stopwatch.hpp"
#include "kinloop/features/image_octaves.hpp"
#include "kinloop/features/matcher.hpp"
#include "kinloop/geometry/se3.hpp"
#include "kinloop/sensor/rgbd_frame.hpp"

namespace kinloop {

/// A frame of the camera with everything computed from it alone; it may be prepared ahead on another thread.
struct PreparedFrame : RgbdFrame {
  cv::Mat gray;          ///< 8UC1
  ImageOctaves octaves;  ///< of `gray`
  /// All keypoints with descriptors; null if not extracted ahead. Of a frame tracked directly: only the
  /// landmarks found, without descriptors.
  std::shared_ptr<const Features> features;
  ElapsedTime decoding;    ///< time that the source took, for reports
  ElapsedTime preparing;   ///< time of the front end without features
  ElapsedTime extracting;  ///< time of the features, if they were extracted ahead
};

/// The previous frame as kept by the tracker.
struct TrackedFrame {
  PreparedFrame frame;
  SE3 T_reference_camera;               ///< in the frame of the reference keyframe of the local map
  std::vector<LandmarkId> landmark_of;  ///< per keypoint; invalid if it has no landmark
};

}  // namespace kinloop
