#include "tools/calibration/board/homography.hpp"

#include <cmath>

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <Eigen/SVD>

#include "kinloop/core/errors.hpp"

namespace kinloop {
namespace {

/// The similarity that moves the points' mean to 0 and their mean distance from it to sqrt(2).
Eigen::Matrix3d normalizing(std::span<const Eigen::Vector2d> points) {
  const auto count = static_cast<double>(points.size());
  Eigen::Vector2d mean = Eigen::Vector2d::Zero();
  for (const auto& p : points) mean += p / count;
  double distance = 0;
  for (const auto& p : points) distance += (p - mean).norm() / count;
  const double scale = std::sqrt(2.0) / distance;
  Eigen::Matrix3d N;
  N << scale, 0, -scale * mean.x(), 0, scale, -scale * mean.y(), 0, 0, 1;
  return N;
}

/// v_ij of Zhang 2000, Eq. (7), without the skew entry B12.
Eigen::Matrix<double, 1, 5> constraint(const Eigen::Matrix3d& H, int i, int j) {
  const Eigen::Vector3d a = H.col(i), b = H.col(j);
  Eigen::Matrix<double, 1, 5> v;
  v << a.x() * b.x(), a.y() * b.y(), a.z() * b.x() + a.x() * b.z(), a.z() * b.y() + a.y() * b.z(),
      a.z() * b.z();
  return v;
}

}  // namespace

std::optional<Eigen::Matrix3d> fit_homography(std::span<const Eigen::Vector2d> plane,
                                              std::span<const Eigen::Vector2d> pixels) {
  require(plane.size() == pixels.size(), "fit_homography: the numbers of pixels and points differ");
  constexpr double kDegenerate = 1e-9;  // ratio of the second smallest singular value to the largest
  if (plane.size() < 4) return std::nullopt;
  const Eigen::Matrix3d N_plane = normalizing(plane), N_pixels = normalizing(pixels);
  if (!N_plane.allFinite() || !N_pixels.allFinite()) return std::nullopt;
  Eigen::MatrixXd A(2 * static_cast<Eigen::Index>(plane.size()), 9);
  for (size_t i = 0; i < plane.size(); ++i) {
    const Eigen::RowVector3d p = (N_plane * plane[i].homogeneous()).transpose();
    const Eigen::Vector3d q = N_pixels * pixels[i].homogeneous();
    const auto row = 2 * static_cast<Eigen::Index>(i);
    A.row(row) << p, Eigen::RowVector3d::Zero(), -q.x() * p;
    A.row(row + 1) << Eigen::RowVector3d::Zero(), p, -q.y() * p;
  }
  const Eigen::JacobiSVD<Eigen::MatrixXd> svd(A, Eigen::ComputeFullV);
  if (svd.singularValues()(7) < kDegenerate * svd.singularValues()(0)) return std::nullopt;
  const Eigen::VectorXd h = svd.matrixV().col(8);
  Eigen::Matrix3d H_normalized;
  H_normalized << h.segment<3>(0).transpose(), h.segment<3>(3).transpose(), h.segment<3>(6).transpose();
  const Eigen::Matrix3d H = N_pixels.inverse() * H_normalized * N_plane;
  return H / H.norm();
}

std::optional<PinholeCamera> camera_from_homographies(std::span<const Eigen::Matrix3d> homographies,
                                                      int width, int height) {
  constexpr double kDegenerate = 1e-6;  // ratio of the second smallest singular value to the largest
  // Maps pixels to about [-1, 1], which balances the columns of the equations; skew stays 0.
  const double scale = 2.0 / (width + height);
  Eigen::Matrix3d N;
  N << scale, 0, -scale * width / 2, 0, scale, -scale * height / 2, 0, 0, 1;
  Eigen::MatrixXd V(2 * static_cast<Eigen::Index>(homographies.size()), 5);
  for (size_t i = 0; i < homographies.size(); ++i) {
    Eigen::Matrix3d H = N * homographies[i];
    H /= std::sqrt(H.col(0).norm() * H.col(1).norm());
    const auto row = 2 * static_cast<Eigen::Index>(i);
    V.row(row) = constraint(H, 0, 1);
    V.row(row + 1) = constraint(H, 0, 0) - constraint(H, 1, 1);
  }
  if (homographies.size() < 2) return std::nullopt;
  const Eigen::JacobiSVD<Eigen::MatrixXd> svd(V, Eigen::ComputeFullV);
  if (svd.singularValues().size() < 4 || svd.singularValues()(3) < kDegenerate * svd.singularValues()(0)) {
    return std::nullopt;
  }
  const Eigen::VectorXd b = svd.matrixV().col(4);
  // Zhang 2000, appendix B, with B12 = 0.
  const double B11 = b(0), B22 = b(1), B13 = b(2), B23 = b(3), B33 = b(4);
  const double lambda = B33 - B13 * B13 / B11 - B23 * B23 / B22;
  if (!(lambda / B11 > 0) || !(lambda / B22 > 0)) return std::nullopt;
  PinholeCamera camera;
  camera.width = width;
  camera.height = height;
  camera.fx = std::sqrt(lambda / B11) / scale;
  camera.fy = std::sqrt(lambda / B22) / scale;
  camera.cx = -B13 / B11 / scale + width / 2.0;
  camera.cy = -B23 / B22 / scale + height / 2.0;
  return camera;
}

SE3 pose_from_homography(const PinholeCamera& camera, const Eigen::Matrix3d& H) {
  Eigen::Matrix3d K;
  K << camera.fx, 0, camera.cx, 0, camera.fy, camera.cy, 0, 0, 1;
  Eigen::Matrix3d M = K.inverse() * H;
  M /= std::sqrt(M.col(0).norm() * M.col(1).norm());
  if (M(2, 2) < 0) M = -M;  // the board is in front of the camera
  Eigen::Matrix3d Q;
  Q << M.col(0), M.col(1), M.col(0).cross(M.col(1));
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(Q, Eigen::ComputeFullU | Eigen::ComputeFullV);
  const Eigen::Matrix3d R = svd.matrixU() * svd.matrixV().transpose();
  return {Eigen::Quaterniond(R), M.col(2)};
}

std::optional<SE3> board_pose(const PinholeCamera& camera, const BoardView& view) {
  std::vector<Eigen::Vector2d> undistorted;
  for (const auto& pixel : view.pixels) undistorted.push_back(camera.undistort(pixel));
  const auto H = fit_homography(view.board_m, undistorted);
  if (!H) return std::nullopt;
  return pose_from_homography(camera, *H);
}

}  // namespace kinloop
