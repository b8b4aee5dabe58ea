#pragma once
// In: the keypoints of a frame that match landmarks. Out: their positions to a fraction of a pixel.

#include <span>

#include "kinloop/map/frames/tracked_frame.hpp"
#include "kinloop/tracking/direct/patch_search.hpp"

namespace kinloop {

/// Moves the keypoints of `frame` to where the patches of their landmarks are found, so that every keyframe
/// observes the same point of a surface: corners are detected with an error of about a pixel of their level.
/// A keypoint whose patch is missing, or not found nearby, stays. Not motion-compensated afterwards.
Features refine_keypoints(const Frame& frame, std::span<const LandmarkMatch> matches,
                          const SE3& T_reference_camera, const PatchSearch& search);

}  // namespace kinloop
