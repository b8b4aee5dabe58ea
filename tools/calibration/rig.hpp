#pragma once
// In: shots of the board by a colour and an infrared camera in one case. Out: the rigid motion between them.

#include <optional>
#include <string>
#include <vector>

#include "tools/calibration/lens.hpp"

namespace kinloop {

/// What both cameras saw at one moment.
struct PairedView {
  BoardView color, infrared;
};

/// Where a camera's lens comes from: known, or estimated along with the motion from its own stills as well.
struct LensSource {
  std::optional<PinholeCamera> known;
  std::vector<BoardView> stills;
};

/// A pair that took part.
struct FittedPair {
  std::string name;  ///< of the colour image
  SE3 T_infrared_board;
  double color_rms_px = 0, infrared_rms_px = 0;
};

struct RigCalibration {
  PinholeCamera color, infrared;
  LensCovariance color_covariance, infrared_covariance;  ///< zero where known
  SE3 T_color_infrared;
  Matrix6d extrinsics_covariance;  ///< of the translation (m) and the rotation vector (rad)
  double sigma_inflation = 1;      ///< as in LensCalibration
  std::vector<FittedPair> pairs;
  std::vector<RejectedView> rejected;
  std::optional<LensCalibration> color_alone, infrared_alone;  ///< each from its own images, where estimated
};

/// All at once: both lenses where not known, the motion, the board's poses. A board that looks the same when
/// turned is read the way that turns the cameras least against each other. Throws InputError for fewer than
/// two usable pairs. With `T_color_infrared` the motion is kept, too, and only the poses are estimated.
RigCalibration calibrate_rig(const std::vector<PairedView>& pairs, const LensSource& color,
                             const LensSource& infrared, const Board& board,
                             const CalibrationOptions& options = {},
                             const std::optional<SE3>& T_color_infrared = {});

}  // namespace kinloop
