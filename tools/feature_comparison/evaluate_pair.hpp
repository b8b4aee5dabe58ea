#pragma once
// In: the keypoints of two images of the same place, and where each of the first should appear in the
// second. Out: how many match, how many of those survive the founding paper's screen and RANSAC, and how many
// keypoints come back.

#include <functional>
#include <optional>
#include <vector>

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>

#include "kinloop/features/features.hpp"
#include "kinloop/geometry/camera.hpp"
#include "kinloop/geometry/se3.hpp"

namespace kinloop {

/// Keypoint `a` of the first image and `b` of the second look alike.
struct DescriptorMatch {
  uint32_t a = 0;
  uint32_t b = 0;
  double distance = 0;  ///< bits of binary descriptors, Euclidean of others
};

/// Pairs each of which is the nearest of the other, by brute force, whatever the kind of descriptor.
std::vector<DescriptorMatch> match_descriptors(const Features& a, const Features& b);

/// The screen of the founding paper: at most four times the smallest distance; for binary descriptors never
/// less than `kMinDistanceLimitBits`, as a perfect pair would reject all others.
std::vector<DescriptorMatch> filter_by_distance(const std::vector<DescriptorMatch>& matches, bool binary);

/// Where the second image shows each keypoint of the first (undistorted pixels): nothing where it is
/// unknown, out of view or hidden. One entry per keypoint.
using GroundTruthPixels = std::vector<std::optional<Eigen::Vector2d>>;

/// Where the second of two frames sees the first one's keypoints, by true motion and measured depth.
GroundTruthPixels ground_truth_pixels_from_motion(const Features& a, const cv::Mat& depth_a_m,
                                                  const cv::Mat& depth_b_m, const PinholeCamera& camera,
                                                  const SE3& T_b_a);

/// The same for an image and its picture under a homography.
GroundTruthPixels ground_truth_pixels_from_homography(const Features& a, const cv::Size& size,
                                                      const Eigen::Matrix3d& H_b_a);

/// What one pair of images shows of a detector.
struct PairMetrics {
  size_t matches = 0;
  size_t screened = 0;
  size_t inliers = 0;             ///< of RANSAC on the screened matches
  size_t visible = 0;             ///< keypoints of the first image with a true pixel in the second
  size_t repeated = 0;            ///< of these with a keypoint of the second within `kRepeatabilityRadiusPx`
  size_t checked = 0;             ///< screened matches of a visible keypoint
  size_t correct = 0;             ///< of these within `kRepeatabilityRadiusPx` of the true pixel
  std::vector<double> errors_px;  ///< distances of the correct ones from the true pixel
};

constexpr double kRepeatabilityRadiusPx = 3;
constexpr int kMinDistanceLimitBits = 40;

/// Two images' keypoints and what was matched of them.
struct MatchedFeatures {
  const Features& a;
  const Features& b;
  const std::vector<DescriptorMatch>& matches;
};

/// The matches that agree with one camera motion (P3P and RANSAC on the first image's depths); none where no
/// motion is found. RANSAC draws its samples by `seed`, here and below.
std::vector<DescriptorMatch> motion_inliers(const MatchedFeatures& pair, const cv::Mat& depth_a_m,
                                            const PinholeCamera& camera, uint64_t seed);

/// The matches that agree with one homography.
std::vector<DescriptorMatch> homography_inliers(const MatchedFeatures& pair, uint64_t seed);

/// The matches that agree with one epipolar geometry: all that two images tell without depth or calibration.
std::vector<DescriptorMatch> epipolar_inliers(const MatchedFeatures& pair, uint64_t seed);

/// Fills in what can be said by the true pixels; without them (empty) `visible` and `checked` stay 0.
PairMetrics evaluate_pair(const Features& b, const std::vector<DescriptorMatch>& matches,
                          const std::vector<DescriptorMatch>& screened, const GroundTruthPixels& true_pixels);

}  // namespace kinloop
