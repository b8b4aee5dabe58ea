#pragma once
// In: the key points of two views and the pose between them. Out: whether the depths both measured can be
// those of one scene. Furniture that looks alike makes a pose certain wherever it stands; the room around it
// does not.

#include "kinloop/features/features.hpp"
#include "kinloop/geometry/camera.hpp"
#include "kinloop/geometry/se3.hpp"

namespace kinloop {

/// What two views say of each other's key points. Those that the other view hides say nothing: something
/// stands in between.
struct DepthAgreement {
  int on_surface = 0;    ///< lie where the other view measured a surface
  int seen_through = 0;  ///< lie clearly in front of it: the other view looks through them

  DepthAgreement& operator+=(const DepthAgreement& other);
};

/// Holds the key points of each view against the planes that the other one measured around its own, within
/// the noise of both depths and `position_sigma_m` of the pose.
DepthAgreement compare_depths(const Features& a, const Features& b, const SE3& T_a_b,
                              const PinholeCamera& camera, double position_sigma_m);

/// Whether more are seen through than one or two strays and that share of all: a scene of solid things does
/// not allow it.
bool contradicts(const DepthAgreement& depths, double max_share_seen_through);

}  // namespace kinloop
