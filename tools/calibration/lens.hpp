#pragma once
// In: views of a board by one camera. Out: the camera, its uncertainty, and the quality of the views.

#include <optional>
#include <string>
#include <vector>

#include "tools/calibration/board/board.hpp"
#include "tools/calibration/options.hpp"
#include "tools/calibration/rig_adjustment.hpp"

namespace kinloop {

using LensCovariance = Eigen::Matrix<double, kLensParameters, kLensParameters>;

/// A view used, and its reprojection errors.
struct FittedView {
  BoardView view;
  SE3 T_camera_board;
  std::vector<Eigen::Vector2d> errors_px;
  double rms_px = 0;
};

/// A view that was rejected, and why.
struct RejectedView {
  std::string name;
  std::string reason;
};

/// Image area covered by the corners of all views.
struct ImageCoverage {
  static constexpr int kColumns = 8, kRows = 6;
  double cells_share = 0;  ///< share of kColumns x kRows equal cells that contain a corner
  double radius_share =
      0;  ///< distance of the farthest corner from the centre, relative to that of the image's corner
};

struct LensCalibration {
  /// Zhang's closed-form solution alone; of a fisheye lens the best equidistant one with the image's centre.
  PinholeCamera closed_form;
  double closed_form_rms_px = 0;
  PinholeCamera camera;
  LensCovariance covariance = LensCovariance::Zero();
  double rms_px = 0;    ///< of the length of the errors, as OpenCV reports it
  double sigma_px = 0;  ///< standard deviation of a corner's coordinate, from the errors
  /// Factor by which the standard deviations exceed those of independent errors; at least 1.
  double sigma_inflation = 1;
  std::vector<FittedView> views;
  std::vector<RejectedView> rejected;
  size_t distinct_tilts = 0;  ///< boards whose normals differ by options.min_tilt_difference_deg or more
  ImageCoverage coverage;
  std::vector<std::string> warnings;

  /// Returns one standard deviation per parameter, in the order of kLensParameterNames.
  [[nodiscard]] Eigen::Matrix<double, kLensParameters, 1> std_deviations() const {
    return covariance.diagonal().cwiseSqrt();
  }
};

/// Zhang's method: homographies, closed form, refinement with distortion (a fisheye lens has no homographies:
/// its refinement begins with the focal length that fits an equidistant lens best); views that disagree with
/// the rest are rejected, worst first. Throws InputError for fewer than three views, or if the views do not
/// determine a camera.
LensCalibration calibrate_lens(const std::vector<BoardView>& views, const CalibrationOptions& options = {});

}  // namespace kinloop
