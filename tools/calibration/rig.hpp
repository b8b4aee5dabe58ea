#pragma once
// In: views of the board by a colour and an infrared camera on one rig. Out: the rigid motion between them.

#include <optional>
#include <string>
#include <vector>

#include "tools/calibration/lens.hpp"

namespace kinloop {

/// The views of both cameras at one moment.
struct PairedView {
  BoardView color, infrared;
};

/// Source of a camera's lens: known, or estimated along with the motion, using its own images as well.
struct LensSource {
  std::optional<PinholeCamera> known;
  std::vector<BoardView> stills;
};

/// A pair used.
struct FittedPair {
  std::string name;  ///< of the colour image
  SE3 T_infrared_board;
  double color_rms_px = 0, infrared_rms_px = 0;
};

struct RigCalibration {
  PinholeCamera color, infrared;
  LensCovariance color_covariance, infrared_covariance;  ///< zero if known
  SE3 T_color_infrared;
  Matrix6d extrinsics_covariance;  ///< of the translation (m) and the rotation vector (rad)
  double sigma_inflation = 1;      ///< as in LensCalibration
  std::vector<FittedPair> pairs;
  std::vector<RejectedView> rejected;
  std::optional<LensCalibration> color_alone, infrared_alone;  ///< each from its own images, if estimated
};

/// Jointly estimates both lenses (unless known), the motion and the board's poses. A board with 180 degree
/// symmetry is oriented so that the rotation between the cameras is smallest. Throws InputError for fewer
/// than two usable pairs. With `T_color_infrared` the motion is fixed, too, and only the poses are estimated.
RigCalibration calibrate_rig(const std::vector<PairedView>& pairs, const LensSource& color,
                             const LensSource& infrared, const Board& board,
                             const CalibrationOptions& options = {},
                             const std::optional<SE3>& T_color_infrared = {});

}  // namespace kinloop
