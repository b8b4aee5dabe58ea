#pragma once
// In: the keypoints of two images of the same place, and the true pixels of the first one's keypoints in the
// second. Out: the number of matches, of those that pass the distance filter of the paper (docs/lab/paper.md)
// and RANSAC, and the repeatability of keypoints.

#include <functional>
#include <optional>
#include <vector>

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>

#include "kinloop/features/features.hpp"
#include "kinloop/geometry/camera.hpp"
#include "kinloop/geometry/se3.hpp"

namespace kinloop {

/// Keypoint `a` of the first image matches keypoint `b` of the second.
struct DescriptorMatch {
  uint32_t a = 0;
  uint32_t b = 0;
  double distance = 0;  ///< bits for binary descriptors, Euclidean otherwise
};

/// Returns mutual nearest neighbours by brute force, for any kind of descriptor.
std::vector<DescriptorMatch> match_descriptors(const Features& a, const Features& b);

/// The distance filter of the paper: at most four times the smallest distance; for binary
/// descriptors the limit is at least `kMinDistanceLimitBits`, since a perfect pair would reject all others.
std::vector<DescriptorMatch> filter_by_distance(const std::vector<DescriptorMatch>& matches, bool binary);

/// True positions of the first image's keypoints in the second (undistorted pixels): nullopt if unknown, out
/// of view or occluded. One entry per keypoint.
using GroundTruthPixels = std::vector<std::optional<Eigen::Vector2d>>;

/// Computes them from true motion and measured depth.
GroundTruthPixels ground_truth_pixels_from_motion(const Features& a, const cv::Mat& depth_a_m,
                                                  const cv::Mat& depth_b_m, const PinholeCamera& camera,
                                                  const SE3& T_b_a);

/// Same for an image and its warp under a homography.
GroundTruthPixels ground_truth_pixels_from_homography(const Features& a, const cv::Size& size,
                                                      const Eigen::Matrix3d& H_b_a);

/// Results of a detector on one pair of images.
struct PairMetrics {
  size_t matches = 0;
  size_t screened = 0;
  size_t inliers = 0;             ///< of RANSAC on the filtered matches
  size_t visible = 0;             ///< keypoints of the first image with a true pixel in the second
  size_t repeated = 0;            ///< of these with a keypoint of the second within `kRepeatabilityRadiusPx`
  size_t checked = 0;             ///< filtered matches of a visible keypoint
  size_t correct = 0;             ///< of these within `kRepeatabilityRadiusPx` of the true pixel
  std::vector<double> errors_px;  ///< distances of the correct ones from the true pixel
};

constexpr double kRepeatabilityRadiusPx = 3;
constexpr int kMinDistanceLimitBits = 40;

/// The keypoints of two images and their matches.
struct MatchedFeatures {
  const Features& a;
  const Features& b;
  const std::vector<DescriptorMatch>& matches;
};

/// Returns the matches consistent with one camera motion (P3P and RANSAC on the first image's depths); none
/// if no motion is found. RANSAC samples by `seed`, here and below.
std::vector<DescriptorMatch> motion_inliers(const MatchedFeatures& pair, const cv::Mat& depth_a_m,
                                            const PinholeCamera& camera, uint64_t seed);

/// Returns the matches consistent with one homography.
std::vector<DescriptorMatch> homography_inliers(const MatchedFeatures& pair, uint64_t seed);

/// Returns the matches consistent with one epipolar geometry, which needs neither depth nor calibration.
std::vector<DescriptorMatch> epipolar_inliers(const MatchedFeatures& pair, uint64_t seed);

/// Evaluates the matches against the true pixels; without these (empty), `visible` and `checked` stay 0.
PairMetrics evaluate_pair(const Features& b, const std::vector<DescriptorMatch>& matches,
                          const std::vector<DescriptorMatch>& screened, const GroundTruthPixels& true_pixels);

}  // namespace kinloop
