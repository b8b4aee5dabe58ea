#pragma once
// In: depth images. Out: the step of inverse depth of a sensor that measures disparities in steps, by the
// differences between neighbouring pixels. They outlive registration to another camera, which moves each
// depth by a smooth amount.

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>

#include <opencv2/core/mat.hpp>

namespace kinloop {

/// Counts the differences of inverse depth between horizontal neighbours, by distance.
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
