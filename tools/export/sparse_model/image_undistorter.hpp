#pragma once
// In: the images of a camera with lens distortion and a rolling shutter. Out: those of a pinhole camera whose
// rows were all exposed at the stamp, as programs for photogrammetry and view synthesis expect.

#include <opencv2/core/mat.hpp>

#include "dense/posed_image.hpp"
#include "kinloop/geometry/camera.hpp"

namespace kinloop {

/// Removes distortion, and the turning of the camera during the readout; its translation would require the
/// depth of every pixel. The pinhole camera has the same focal length; its image is the largest rectangle
/// without unknown pixels, at most twice as wide and high as the raw image.
class ImageUndistorter {
 public:
  /// `rolling_shutter_s` is the readout time of the colour image. Throws InputError if the distortion cannot
  /// be inverted.
  explicit ImageUndistorter(const DenseCamera& camera, double rolling_shutter_s = 0);

  /// The camera of the results, without distortion.
  [[nodiscard]] const PinholeCamera& pinhole() const { return pinhole_; }

  /// Returns whether the images are those of a pinhole camera already.
  [[nodiscard]] bool is_identity() const { return !camera_.color.has_distortion() && readout_s_ == 0; }

  /// Returns where a raw pixel is in the result; it may be outside.
  [[nodiscard]] Eigen::Vector2d undistort(const Eigen::Vector2d& raw, const Velocity& velocity) const;

  /// Inverse of `undistort`.
  [[nodiscard]] Eigen::Vector2d distort(const Eigen::Vector2d& undistorted, const Velocity& velocity) const;

  /// The raw pixel of every pixel of the result, 32FC2.
  [[nodiscard]] cv::Mat raw_pixels(const Velocity& velocity) const;

  /// Resamples a colour image, 8UC3.
  [[nodiscard]] cv::Mat color(const cv::Mat& raw, const cv::Mat& raw_pixels) const;

  /// Resamples depth, 32FC1 in metres, without mixing neighbours, and applies the estimated correction.
  [[nodiscard]] cv::Mat depth(const cv::Mat& raw_m, const cv::Mat& raw_pixels) const;

 private:
  [[nodiscard]] double time_of_row_s(double row) const {
    return readout_s_ * (row / camera_.color.height - 0.5);
  }

  DenseCamera camera_;
  double readout_s_;
  PinholeCamera pinhole_;
};

}  // namespace kinloop
