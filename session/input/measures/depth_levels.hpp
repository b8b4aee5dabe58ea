#pragma once
// In: depth images. Out: which values occur, and in which steps.

#include <cstdint>
#include <optional>
#include <vector>

#include <opencv2/core/mat.hpp>

namespace kinloop {

/// How often each value of depth occurs, over a grid of pixels of all frames. Values are those of a depth
/// file, where sensors leave their steps.
class DepthLevels {
 public:
  /// `depth_scale` is in units per metre.
  explicit DepthLevels(double depth_scale);

  /// Adds a depth image, 32FC1 in metres with 0 = unknown.
  void add(const cv::Mat& depth_m);

  /// A value that occurs.
  struct Level {
    double depth_m = 0;
    double share = 0;  ///< of all pixels with depth
  };

  /// Returns the levels that are more than stray values, in ascending order.
  [[nodiscard]] std::vector<Level> levels() const;

  [[nodiscard]] size_t pixels() const { return pixels_; }
  [[nodiscard]] double unit_m() const { return 1 / units_per_m_; }

 private:
  double units_per_m_;
  std::vector<uint32_t> counts_;  // by value in units
  size_t pixels_ = 0;
};

/// Returns the step in metres if most levels are multiples of one step.
std::optional<double> uniform_step_m(const std::vector<DepthLevels::Level>& levels);

}  // namespace kinloop
