#pragma once
// Maximum likelihood: cameras, their rigid motion and the board's poses from all corners at once (Zhang 2000,
// section 3.2 and 3.3, for one camera or two in one case).

#include <vector>

#include <Eigen/Core>

#include "kinloop/geometry/camera.hpp"
#include "tools/calibration/board.hpp"

namespace kinloop {

/// fx fy cx cy k1 k2 p1 p2 k3.
constexpr int kLensParameters = 9;
constexpr const char* kLensParameterNames[kLensParameters] = {"fx", "fy", "cx", "cy", "k1",
                                                              "k2", "p1", "p2", "k3"};
Eigen::Matrix<double, kLensParameters, 1> lens_parameters(const PinholeCamera& camera);

/// One camera of the rig.
struct RigCamera {
  PinholeCamera lens;
  SE3 T_camera_rig;     ///< the first camera's is the identity and stays so
  double sigma_px = 1;  ///< standard deviation of its corners
  bool lens_fixed = false;
  bool pose_fixed = false;
};

/// What one camera saw in one shot.
struct BoardObservation {
  size_t camera = 0;
  size_t shot = 0;
  BoardView view;
};

struct RigProblem {
  std::vector<RigCamera> cameras;
  std::vector<SE3> T_rig_board;  ///< of each shot
  std::vector<BoardObservation> observations;
};

struct RigSolution {
  std::vector<RigCamera> cameras;
  std::vector<SE3> T_rig_board;
  bool converged = false;
  /// Of all cameras' parameters, were all errors independent with the deviation sigma_px: for each camera its
  /// kLensParameters, then the six of T_camera_rig (metres; rotation vector, radians). Zero for those held.
  Eigen::MatrixXd covariance;
  /// How many times larger the covariance is than that of independent errors: from how much the shots
  /// disagree (the sandwich of White 1980, by shots, as one number). Errors within a shot depend on each
  /// other: blur, a board that is not flat. About 1 (sigma_px squared) where they do not.
  double dispersion = 1;
};

/// Rows of a camera in `RigSolution::covariance`.
constexpr int kRigCameraParameters = kLensParameters + 6;

/// Corners as `camera` sees them less where they were found, px.
std::vector<Eigen::Vector2d> reprojection_errors(const PinholeCamera& camera, const SE3& T_camera_board,
                                                 const BoardView& view);

/// Root mean square of the length of errors, px.
double rms_px(const std::vector<Eigen::Vector2d>& errors);

/// The solution of least squares from the start values in `problem`. `distortion_terms` of k1 k2 p1 p2 k3 are
/// estimated (0, 2, 4 or 5), the others stay.
RigSolution adjust_rig(const RigProblem& problem, int distortion_terms);

}  // namespace kinloop
