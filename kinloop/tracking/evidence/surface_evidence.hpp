#pragma once
// What the surfaces of a frame say of its pose. They count by area, so that a wall weighs as much as a
// poster, and they can contradict a pose on which a few landmarks agree by chance.

#include "kinloop/tracking/keypoint_tracking.hpp"

namespace kinloop {

/// Compares the surfaces of a frame with those of the reference keyframe; all zero if either are unknown.
SurfaceAgreement agreement_with_reference(const LocalMap& local_map, const Frame& frame,
                                          const SE3& T_reference_camera);

/// Whether so many keypoints agree with the pose that hardly any other place can be mistaken for this one.
bool is_confident(const TrackedFrame& found, const Features& features);

/// Whether surfaces contradict a pose that was not expected: found after a gap or a loss, far from its
/// prediction, or in another part of the map. In another place some surfaces agree by chance, but many do
/// not; in a static scene hardly any point lies where the other view saw through. Many landmarks outweigh
/// more contradiction, since something may move in front of them. A camera that turns at `turning_rad_s`
/// distorts surfaces.
bool contradicts_unexpected_pose(const SurfaceAgreement& agreement, const TrackedFrame& found,
                                 const Frame& frame, double turning_rad_s = 0);

/// Returns why a pose is in doubt although it continues the previous one; none if it is not: by what surfaces
/// contradict it, by how much of the image moves, by how few landmarks support it, or because dense odometry
/// has accumulated a standard deviation of the position of more than `max_sigma_m`. Doubt ends only where
/// hardly any surface contradicts the pose. Needs the velocity.
DoubtCause cause_of_doubt(const TrackedFrame& tracked, bool doubtful_before, double max_sigma_m);

/// Whether nothing holds the scale of a pose. Triangulated landmarks do not: others must, or surfaces. Once
/// it has been lacking, only landmarks of known depth restore it, since surfaces also agree with a reference
/// whose own pose has drifted.
bool lacks_scale(const TrackedFrame& tracked, bool lacked_before);

}  // namespace kinloop
