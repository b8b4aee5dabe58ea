#pragma once
// Sparse image alignment (Forster et al. 2014, "SVO: Fast semi-direct monocular visual odometry", section
// IV.A): estimates a camera motion from the intensities around points of known depth, coarse to fine. It
// tolerates larger prediction errors than the alignment of single patches, since all points move together.

#include <span>

#include "kinloop/features/extraction/image_octaves.hpp"
#include "kinloop/geometry/camera.hpp"

namespace kinloop {

/// A point seen in the previous image.
struct AlignmentPoint {
  Eigen::Vector3d p_camera;  ///< in the predicted camera frame of the current image, m
  Eigen::Vector2d previous;  ///< raw pixel in the previous image
  Eigen::Vector2d current;   ///< predicted raw pixel in the current image
};

/// Returns T_predicted_camera, the correction of the predicted pose; identity if too few points are in view.
SE3 align_images(const ImageOctaves& previous, const ImageOctaves& current,
                 std::span<const AlignmentPoint> points, const PinholeCamera& camera);

}  // namespace kinloop
