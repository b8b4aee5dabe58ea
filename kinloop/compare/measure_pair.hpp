#pragma once
// In: the key points of two images of the same place, and where each of the first should appear in the
// second. Out: how many match, how many of those survive the founding paper's screen and RANSAC, and how many
// key points come back.

#include <functional>
#include <optional>
#include <vector>

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>

#include "kinloop/features/features.hpp"
#include "kinloop/geometry/camera.hpp"
#include "kinloop/geometry/se3.hpp"

namespace kinloop {

/// Key point `a` of the first image and `b` of the second look alike.
struct LookAlike {
  uint32_t a = 0;
  uint32_t b = 0;
  double distance = 0;  ///< bits of binary descriptors, Euclidean of others
};

/// Pairs each of which is the nearest of the other, by brute force, whatever the kind of descriptor.
std::vector<LookAlike> match_descriptors(const Features& a, const Features& b);

/// The screen of the founding paper: at most four times the smallest distance; for binary descriptors never
/// less than `kScreenFloorBits`, as a perfect pair would reject all others.
std::vector<LookAlike> screen_look_alikes(const std::vector<LookAlike>& matches, bool binary);

/// Where the second image shows each key point of the first (undistorted pixels): nothing where it is
/// unknown, out of view or hidden. One entry per key point.
using TrueSights = std::vector<std::optional<Eigen::Vector2d>>;

/// Where the second of two frames sees the first one's key points, by true motion and measured depth.
TrueSights sights_by_motion(const Features& a, const cv::Mat& depth_a_m, const cv::Mat& depth_b_m,
                            const PinholeCamera& camera, const SE3& T_b_a);

/// The same for an image and its picture under a homography.
TrueSights sights_by_homography(const Features& a, const cv::Size& size, const Eigen::Matrix3d& H_b_a);

/// What one pair of images shows of a detector.
struct PairFigures {
  size_t matches = 0;
  size_t screened = 0;
  size_t inliers = 0;             ///< of RANSAC on the screened matches
  size_t visible = 0;             ///< key points of the first image with a true sight in the second
  size_t repeated = 0;            ///< of these with a key point of the second within `kRepeatRadiusPx`
  size_t checked = 0;             ///< screened matches of a visible key point
  size_t right = 0;               ///< of these within `kRepeatRadiusPx` of the true sight
  std::vector<double> errors_px;  ///< distances of the right ones from the true sight
};

constexpr double kRepeatRadiusPx = 3;
constexpr int kScreenFloorBits = 40;

/// Two images' key points and what was matched of them.
struct MatchedFeatures {
  const Features& a;
  const Features& b;
  const std::vector<LookAlike>& matches;
};

/// The matches that agree with one camera motion (P3P and RANSAC on the first image's depths); none where no
/// motion is found. RANSAC draws its samples by `seed`, here and below.
std::vector<LookAlike> motion_inliers(const MatchedFeatures& pair, const cv::Mat& depth_a_m,
                                      const PinholeCamera& camera, uint64_t seed);

/// The matches that agree with one homography.
std::vector<LookAlike> homography_inliers(const MatchedFeatures& pair, uint64_t seed);

/// The matches that agree with one epipolar geometry: all that two images tell without depth or calibration.
std::vector<LookAlike> epipolar_inliers(const MatchedFeatures& pair, uint64_t seed);

/// Fills in what can be said by the true sights; without them (empty) `visible` and `checked` stay 0.
PairFigures measure_pair(const Features& b, const std::vector<LookAlike>& matches,
                         const std::vector<LookAlike>& screened, const TrueSights& sights);

}  // namespace kinloop
