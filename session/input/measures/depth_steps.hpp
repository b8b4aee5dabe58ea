#pragma once
// In: depth images. Out: which values occur, and in which steps, of depth and of inverse depth.

#include <array>
#include <cstddef>
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

/// Counts the differences of inverse depth between horizontal neighbours, by distance: the steps of a sensor
/// that measures disparities. They outlive registration to another camera, which moves each depth by a smooth
/// amount.
class DisparitySteps {
 public:
  /// `unit_m` is the resolution of the depth values.
  explicit DisparitySteps(double unit_m) : unit_m_(unit_m) {}

  /// Adds a depth image, 32FC1 in metres with 0 = unknown.
  void add(const cv::Mat& depth_m);

  /// Returns k if neighbours differ by k z^2 at several distances z, 1/m; nullopt if they do not, as those of
  /// time of flight, or if the values are too coarse to tell.
  [[nodiscard]] std::optional<double> per_m() const;

 private:
  static constexpr int kDistances = 13;  ///< of a factor of sqrt(2) each
  static constexpr int kBins = 150;      ///< of a factor of 1.05 each

  /// The differences at one distance.
  struct Histogram {
    size_t differing = 0;  ///< pairs of other values, also those below
    std::array<uint32_t, kBins> counts = {};

    [[nodiscard]] std::optional<double> peak_per_m() const;
  };

  void add_pair(float a_m, float b_m);

  double unit_m_;
  std::array<Histogram, kDistances> histograms_;
};

}  // namespace kinloop
