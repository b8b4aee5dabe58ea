#pragma once
// Maximum likelihood estimate of cameras, their rigid motion and the board's poses from all corners at once
// (Zhang 2000, section 3.2 and 3.3, for one camera or two on a rig).

#include <vector>

#include <Eigen/Core>

#include "kinloop/geometry/camera.hpp"
#include "tools/calibration/board/board.hpp"

namespace kinloop {

/// Parameters of all lens models. Those that a model does not have are 0 and constant.
constexpr int kLensParameters = 12;
constexpr const char* kLensParameterNames[kLensParameters] = {"fx", "fy", "cx", "cy", "k1", "k2",
                                                              "p1", "p2", "k3", "k4", "k5", "k6"};

/// Returns the indices of the parameters that the model has.
std::vector<int> parameters_of(LensModel model);

Eigen::Matrix<double, kLensParameters, 1> lens_parameters(const PinholeCamera& camera);

/// One camera of the rig.
struct RigCamera {
  PinholeCamera lens;
  SE3 T_camera_rig;     ///< the identity for the first camera, and constant
  double sigma_px = 1;  ///< standard deviation of its corners
  bool lens_fixed = false;
  bool pose_fixed = false;
};

/// One camera's view of one shot.
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
  /// Of all camera parameters, assuming independent errors with deviation sigma_px: for each camera its
  /// kLensParameters, then the six of T_camera_rig (metres; rotation vector, radians). Zero for constant
  /// ones.
  Eigen::MatrixXd covariance;
  /// Factor by which the covariance exceeds that of independent errors, from the disagreement between shots
  /// (the sandwich of White 1980, by shots, as one number). Errors within a shot are correlated: blur, a
  /// board that is not flat. About 1 (sigma_px squared) if they are not.
  double dispersion = 1;
};

/// Number of rows per camera in `RigSolution::covariance`.
constexpr int kRigCameraParameters = kLensParameters + 6;

/// Returns projected minus detected corners, px.
std::vector<Eigen::Vector2d> reprojection_errors(const PinholeCamera& camera, const SE3& T_camera_board,
                                                 const BoardView& view);

/// Returns the root mean square of the length of errors, px.
double rms_px(const std::vector<Eigen::Vector2d>& errors);

/// Least squares solution from the initial values in `problem`. Of a Brown-Conrady lens the first
/// `distortion_terms` of k1 k2 p1 p2 k3 (0, 2, 4 or 5) are estimated, of other models all coefficients.
RigSolution adjust_rig(const RigProblem& problem, int distortion_terms);

}  // namespace kinloop
