#pragma once
// In: views of a board by one camera. Out: the camera, how sure it is, and what the views were worth.

#include <optional>
#include <string>
#include <vector>

#include "tools/calibration/board.hpp"
#include "tools/calibration/options.hpp"
#include "tools/calibration/rig_adjustment.hpp"

namespace kinloop {

using LensCovariance = Eigen::Matrix<double, kLensParameters, kLensParameters>;

/// A view that took part, and how well the camera explains it.
struct FittedView {
  BoardView view;
  SE3 T_camera_board;
  std::vector<Eigen::Vector2d> errors_px;
  double rms_px = 0;
};

/// A view that was left out, and why.
struct RejectedView {
  std::string name;
  std::string reason;
};

/// How much of the image the corners of all views reach.
struct ImageCoverage {
  static constexpr int kColumns = 8, kRows = 6;
  double cells_share = 0;   ///< of kColumns x kRows equal cells, those with a corner
  double radius_share = 0;  ///< the farthest corner from the middle, of the way to the image's corner
};

struct LensCalibration {
  PinholeCamera closed_form;  ///< Zhang's closed form alone
  double closed_form_rms_px = 0;
  PinholeCamera camera;
  LensCovariance covariance = LensCovariance::Zero();
  double rms_px = 0;    ///< of the length of the errors, as OpenCV gives it
  double sigma_px = 0;  ///< standard deviation of a corner's coordinate, from the errors
  /// How many times larger the deviations are than independent errors would make them; at least 1.
  double sigma_inflation = 1;
  std::vector<FittedView> views;
  std::vector<RejectedView> rejected;
  size_t distinct_tilts = 0;  ///< boards whose normals differ by options.min_tilt_difference_deg or more
  ImageCoverage coverage;
  std::vector<std::string> warnings;

  /// One standard deviation of each parameter, in the order of kLensParameterNames.
  [[nodiscard]] Eigen::Matrix<double, kLensParameters, 1> std_deviations() const {
    return covariance.diagonal().cwiseSqrt();
  }
};

/// Zhang's method: homographies, closed form, refinement with distortion; views that do not agree with the
/// rest are left out, worst first. Throws InputError for fewer than three views, and where the views do not
/// fix a camera.
LensCalibration calibrate_lens(const std::vector<BoardView>& views, const CalibrationOptions& options = {});

}  // namespace kinloop
