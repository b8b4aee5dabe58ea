#pragma once
// Triangulates landmarks for keypoints without depth from two views.

#include <optional>

#include "kinloop/geometry/camera.hpp"
#include "kinloop/map/map.hpp"
#include "kinloop/mapping/options.hpp"

namespace kinloop {

/// A keypoint as a bearing: its ray in camera axes, and the angle of its uncertainty.
struct Bearing {
  Eigen::Vector3d ray = Eigen::Vector3d::UnitZ();  ///< unit vector
  double sigma_rad = 0;
};

/// Returns, in the frame of camera a, the point between the two rays where they are closest, weighted by
/// their sigmas (Lee and Civera 2019, "Triangulation: why optimize?": such a midpoint suffices at the
/// parallaxes required here, and adjustment does the rest). nullopt if the rays are nearly parallel, meet
/// behind a camera, or are farther apart than 95 % of pairs with these sigmas.
std::optional<Eigen::Vector3d> triangulate(const Bearing& a, const Bearing& b, const SE3& T_a_b,
                                           double min_parallax_rad);

/// Triangulates keypoints without depth that the keyframe shares with its covisible neighbours. Returns the
/// number of new landmarks.
int triangulate_landmarks(Map& map, KeyframeId keyframe, const PinholeCamera& camera,
                          const MappingOptions& options);

}  // namespace kinloop
