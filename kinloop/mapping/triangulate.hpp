#pragma once
// In: a new keyframe. Out: landmarks where no depth was measured, from two views of different places.

#include <optional>

#include "kinloop/geometry/camera.hpp"
#include "kinloop/map/map.hpp"
#include "kinloop/mapping/options.hpp"

namespace kinloop {

/// A keypoint as a bearing: its ray in camera axes, and how far a pixel turns it.
struct Bearing {
  Eigen::Vector3d ray = Eigen::Vector3d::UnitZ();  ///< of unit length
  double sigma_rad = 0;
};

/// The point, in the axes of camera a, between the two rays where they come nearest, as far from each as its
/// sigma lets it be off (Lee and Civera 2019, "Triangulation: why optimize?": such a midpoint serves at the
/// parallaxes asked for here, and adjustment does the rest). Nothing where the rays are nearly parallel, meet
/// behind a camera, or miss each other by more than 95 % of pairs with these sigmas do.
std::optional<Eigen::Vector3d> triangulate(const Bearing& a, const Bearing& b, const SE3& T_a_b,
                                           double min_parallax_rad);

/// Makes landmarks of keypoints without depth that the keyframe shares with its covisible neighbours.
/// Returns how many.
int triangulate_landmarks(Map& map, KeyframeId keyframe, const PinholeCamera& camera,
                          const MappingOptions& options);

}  // namespace kinloop
