#pragma once
// Sparse image alignment (Forster et al. 2014, "SVO: Fast semi-direct monocular visual odometry", section
// IV.A): estimates a camera motion from the intensities around points of known depth, coarse to fine. It
// tolerates larger prediction errors than the alignment of single patches, since all points move together.

#include <optional>
#include <span>

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>

#include "kinloop/features/extraction/image_octaves.hpp"
#include "kinloop/features/patches.hpp"
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

// Finds a small patch in an image to a fraction of a pixel: inverse compositional alignment (Baker and
// Matthews 2004), independent of gain and offset of the intensity.

/// The appearance of a patch under an affine warp, prepared for alignment.
struct PatchTemplate {
  static constexpr int kSize = 8;                         ///< texels per side
  using Texels = Eigen::Matrix<float, kSize * kSize, 1>;  ///< row by row

  Texels intensity;   ///< zero mean, unit norm
  Texels gradient_x;  ///< of `intensity`, orthogonal to constants and to `intensity`
  Texels gradient_y;
  Eigen::Matrix2f inverse_hessian;
};

/// Warps a patch: an offset d from the centre of the template shows the texel at `source_per_target * d` from
/// the keypoint. nullopt if the warped template leaves the patch or lacks the texture of a corner.
std::optional<PatchTemplate> make_template(const Patch& patch, const Eigen::Matrix2f& source_per_target);

/// A patch found in an image.
struct AlignedPatch {
  Eigen::Vector2f position;  ///< of its centre, px
  float correlation = 0;     ///< normalised cross-correlation, at most 1
};

/// Aligns the template with `image` (8UC1), starting at `guess`. nullopt if it does not converge within
/// `max_shift_px` of the guess or leaves the image.
std::optional<AlignedPatch> align_patch(const PatchTemplate& patch, const cv::Mat& image,
                                        const Eigen::Vector2f& guess, float max_shift_px);

}  // namespace kinloop
