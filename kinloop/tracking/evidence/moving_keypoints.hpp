#pragma once
// What moves by itself, found by new keypoints before they become landmarks: an image of a moment before does
// not show them where a scene at rest would. Surfaces cannot tell what enters the view together with a part
// of the room that was never seen.

#include <opencv2/core/mat.hpp>

#include "kinloop/map/frames/tracked_frame.hpp"
#include "kinloop/sensor/sensor.hpp"

namespace kinloop {

/// Returns the points of the surface grid of `tracked` around which most keypoints move, 8UC1; empty if there
/// are none, or if too few landmarks are found to tell how precise the comparison is. `earlier` is a frame of
/// a moment before, and `T_earlier_tracked` the motion of the camera since then. Both have their images and
/// octaves; keypoints of `tracked` that observe landmarks are taken to be at rest.
cv::Mat moving_points(const TrackedFrame& tracked, const TrackedFrame& earlier, const SE3& T_earlier_tracked,
                      const Sensor& sensor);

}  // namespace kinloop
