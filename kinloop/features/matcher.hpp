#pragma once
// In: the descriptors of two images, or projected landmarks and an image. Out: matches.

#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "kinloop/features/features.hpp"

namespace kinloop {

/// Keypoint `a` of the first set matches keypoint `b` of the second.
struct Match {
  uint32_t a = 0;
  uint32_t b = 0;
  int distance = 0;  ///< Hamming distance, bits

  auto operator<=>(const Match&) const = default;  // NOLINT(modernize-use-nullptr): false alarm on <=>
};

/// Matches every row of `a` with its nearest row of `b` by brute force; with `cross_check` only mutual
/// nearest neighbours. Ties go to the lower index.
std::vector<Match> match_brute_force(const cv::Mat& a, const cv::Mat& b, bool cross_check);

/// Keeps matches whose distance is at most `factor` times the smallest one, as in "Kinect Based 3D Visual
/// SLAM". A perfect match would reject all others, so the limit is at least `floor` bits.
std::vector<Match> filter_matches_by_distance(std::span<const Match> matches, double factor = 4.0,
                                              int floor = 40);

/// Keypoints binned into square cells for fast radius search.
class FeatureGrid {
 public:
  FeatureGrid(const Features& features, int width_px, int height_px);

  /// Finds the keypoints within `radius_px` (per axis) of `pixel`, in ascending order of cell, then index.
  void features_in_area(const Eigen::Vector2d& pixel, double radius_px, std::vector<uint32_t>& found) const;

 private:
  [[nodiscard]] size_t cell_index(int row, int column) const;
  [[nodiscard]] int column_of(double x) const;
  [[nodiscard]] int row_of(double y) const;

  int columns_;
  int rows_;
  std::vector<uint32_t> first_of_cell_;  ///< start of each cell in `indices_`, plus one end entry
  std::vector<uint32_t> indices_;
  std::vector<Eigen::Vector2f> pixels_;  ///< in the order of `indices_`
};

/// A landmark projected into the image.
struct ProjectedPoint {
  Eigen::Vector2d pixel;  ///< undistorted
  double radius_px = 0;   ///< half side of the search window
  double depth_m = 0;     ///< expected z
  int level_low = 0;      ///< pyramid levels on which it may be detected
  int level_high = 0;
  const uint8_t* descriptor = nullptr;  ///< 32 bytes
};

struct ProjectionMatchOptions {
  int max_distance = 100;         ///< bits
  double max_ratio = 0.9;         ///< best to second-best distance, if both are on the same level
  double max_depth_error = 0.15;  ///< |measured z - expected z| / expected z, if z was measured
};

/// Guided matching: for each projected point (index `a`), finds the keypoint `b` with the smallest descriptor
/// distance in its window. Each keypoint is assigned to at most one point, the most similar.
std::vector<Match> match_by_projection(std::span<const ProjectedPoint> points, const Features& features,
                                       const FeatureGrid& grid, const ProjectionMatchOptions& options);

}  // namespace kinloop
