#pragma once
// The residual of the rig adjustment: where a camera of the rig sees the corners of a board.

#include <array>
#include <cmath>

#include <ceres/autodiff_cost_function.h>
#include <ceres/rotation.h>

#include "kinloop/geometry/lens.hpp"
#include "tools/calibration/board/board.hpp"

namespace kinloop {

// Parameter blocks of an observation: fx fy cx cy | k1 k2 | p1 p2 | k3 | k4 | k5 k6 | T_camera_rig |
// T_rig_board. The lens has six blocks, so that the terms to estimate are whole blocks for every model and
// number of terms. A motion is a translation and a rotation vector; calibration boards never turn by a full
// turn, where the vector is singular.
constexpr std::array<int, 8> kBlockSizes = {4, 2, 2, 1, 1, 2, 6, 6};
constexpr int kSharedBlocks = 7;  ///< all but T_rig_board

/// Applies a motion to a point.
template <class T>
Eigen::Matrix<T, 3, 1> moved_point(const T* motion, const Eigen::Matrix<T, 3, 1>& point) {
  Eigen::Matrix<T, 3, 1> rotated;
  ceres::AngleAxisRotatePoint(motion + 3, point.data(), rotated.data());
  return rotated + Eigen::Map<const Eigen::Matrix<T, 3, 1>>(motion);
}

/// LensDistortion::distort of the direction p, for automatic differentiation.
template <class T>
struct LensTerms {
  LensModel model;
  const T *radial, *tangential, *k3, *k4, *k56;

  [[nodiscard]] Eigen::Matrix<T, 2, 1> distort(const Eigen::Matrix<T, 3, 1>& p) const {
    if (model == LensModel::kKannalaBrandt) return distort_fisheye(p);
    const T x = p.x() / p.z(), y = p.y() / p.z(), r2 = x * x + y * y;
    T scale = T(1) + r2 * (radial[0] + r2 * (radial[1] + r2 * k3[0]));
    if (model == LensModel::kRational) scale /= T(1) + r2 * (k4[0] + r2 * (k56[0] + r2 * k56[1]));
    const T &p1 = tangential[0], &p2 = tangential[1];
    return {x * scale + T(2) * p1 * x * y + p2 * (r2 + T(2) * x * x),
            y * scale + p1 * (r2 + T(2) * y * y) + T(2) * p2 * x * y};
  }

  /// Also of directions behind the camera.
  [[nodiscard]] Eigen::Matrix<T, 2, 1> distort_fisheye(const Eigen::Matrix<T, 3, 1>& p) const {
    using std::atan2, std::sqrt;
    constexpr double kOnAxis = 1e-18;  // where the root has no derivative
    const T across2 = p.x() * p.x() + p.y() * p.y();
    if (across2 < kOnAxis * p.z() * p.z()) return {p.x() / p.z(), p.y() / p.z()};
    const T across = sqrt(across2), angle = atan2(across, p.z()), a2 = angle * angle;
    const T radius = angle * (T(1) + a2 * (radial[0] + a2 * (radial[1] + a2 * (k3[0] + a2 * k4[0]))));
    return {p.x() * radius / across, p.y() * radius / across};
  }
};

/// All corners of one observation, in standard deviations.
struct BoardResidual {
  const BoardView* view;
  double sigma_px;
  LensModel model;

  template <class T>
  bool operator()(const T* pinhole, const T* radial, const T* tangential, const T* k3, const T* k4,
                  const T* k56, const T* camera, const T* board, T* residuals) const {
    const LensTerms<T> lens{model, radial, tangential, k3, k4, k56};
    for (size_t i = 0; i < view->pixels.size(); ++i) {
      const auto on_board = view->board_m[i].cast<T>();
      const Eigen::Matrix<T, 3, 1> in_rig =
          moved_point(board, Eigen::Matrix<T, 3, 1>(on_board.x(), on_board.y(), T(0)));
      const Eigen::Matrix<T, 3, 1> p = moved_point(camera, in_rig);
      const Eigen::Matrix<T, 2, 1> d = lens.distort(p);
      residuals[2 * i] = (pinhole[0] * d.x() + pinhole[2] - view->pixels[i].x()) / sigma_px;
      residuals[2 * i + 1] = (pinhole[1] * d.y() + pinhole[3] - view->pixels[i].y()) / sigma_px;
    }
    return true;
  }
};

using BoardCost = ceres::AutoDiffCostFunction<BoardResidual, ceres::DYNAMIC, 4, 2, 2, 1, 1, 2, 6, 6>;

}  // namespace kinloop
