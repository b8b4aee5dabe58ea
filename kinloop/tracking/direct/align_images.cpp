#include <algorithm>
#include <array>
#include <cmath>

#include <Eigen/Cholesky>

#include "kinloop/tracking/direct/alignment.hpp"

namespace kinloop {
namespace {

constexpr int kPointSize = 4;  // texels per side of the neighbourhood of a point
constexpr int kPointTexels = kPointSize * kPointSize;
constexpr int kParameters = 7;  // translation, rotation, intensity offset
constexpr float kHalfPoint = (kPointSize - 1) / 2.0F;

using PointTexels = Eigen::Matrix<float, kPointTexels, 1>;
using PixelJacobian = Eigen::Matrix<double, 2, 6>;

/// The neighbourhood of a point in the previous image, on one octave.
struct Neighborhood {
  const AlignmentPoint* point;
  PointTexels intensity, gradient_x, gradient_y;
  PixelJacobian pixel_by_pose;  // derivative of its pixel in the current octave by the camera pose
};

struct AlignmentEquations {
  Eigen::Matrix<double, kParameters, kParameters> H = Eigen::Matrix<double, kParameters, kParameters>::Zero();
  Eigen::Matrix<double, kParameters, 1> g = Eigen::Matrix<double, kParameters, 1>::Zero();
  int points = 0;
};

bool holds(const cv::Mat& image, const Eigen::Vector2d& position, double margin) {
  return position.x() >= margin && position.y() >= margin && position.x() < image.cols - 1 - margin &&
         position.y() < image.rows - 1 - margin;
}

void sample_4x4(const cv::Mat& image, const Eigen::Vector2f& position, PointTexels& values) {
  const float left = position.x() - kHalfPoint, top = position.y() - kHalfPoint;
  const int column = static_cast<int>(left), first_row = static_cast<int>(top);
  const float fx = left - static_cast<float>(column), fy = top - static_cast<float>(first_row);
  const float w00 = (1 - fx) * (1 - fy), w01 = fx * (1 - fy), w10 = (1 - fx) * fy, w11 = fx * fy;
  for (int row = 0; row < kPointSize; ++row) {
    const uint8_t* upper = image.ptr(first_row + row) + column;
    const uint8_t* lower = image.ptr(first_row + row + 1) + column;
    for (int x = 0; x < kPointSize; ++x) {
      values[row * kPointSize + x] =
          w00 * static_cast<float>(upper[x]) + w01 * static_cast<float>(upper[x + 1]) +
          w10 * static_cast<float>(lower[x]) + w11 * static_cast<float>(lower[x + 1]);
    }
  }
}

PixelJacobian pixel_by_pose(const PinholeCamera& camera, const Eigen::Vector3d& p_camera, int octave) {
  Eigen::Matrix<double, 3, 6> point_by_pose;  // of exp(x)^-1 * p
  point_by_pose << -Eigen::Matrix3d::Identity(), skew(p_camera);
  return camera.project_jacobian(p_camera) * point_by_pose / (1 << octave);
}

std::vector<Neighborhood> neighborhoods(const cv::Mat& image, std::span<const AlignmentPoint> points,
                                        const PinholeCamera& camera, int octave) {
  constexpr double kMargin = kHalfPoint + 2;
  std::vector<Neighborhood> all;
  for (const AlignmentPoint& point : points) {
    const Eigen::Vector2d at = to_octave(point.previous, octave);
    if (!holds(image, at, kMargin)) continue;
    Neighborhood made{&point, {}, {}, {}, pixel_by_pose(camera, point.p_camera, octave)};
    const Eigen::Vector2f center = at.cast<float>();
    PointTexels before, after;
    sample_4x4(image, center, made.intensity);
    sample_4x4(image, center - Eigen::Vector2f::UnitX(), before);
    sample_4x4(image, center + Eigen::Vector2f::UnitX(), after);
    made.gradient_x = (after - before) / 2;
    sample_4x4(image, center - Eigen::Vector2f::UnitY(), before);
    sample_4x4(image, center + Eigen::Vector2f::UnitY(), after);
    made.gradient_y = (after - before) / 2;
    all.push_back(made);
  }
  return all;
}

/// Adds the 16 intensity differences of a point, with the robust weight of their root mean square.
void add_point(AlignmentEquations& sum, const Neighborhood& n, const PointTexels& residual) {
  constexpr double kRobustWidth = 10;  // intensity levels
  const double rms = std::sqrt(static_cast<double>(residual.squaredNorm()) / kPointTexels);
  const double weight = rms <= kRobustWidth ? 1 : kRobustWidth / rms;
  Eigen::Matrix2d gradients;
  const auto xy = static_cast<double>(n.gradient_x.dot(n.gradient_y));
  gradients << static_cast<double>(n.gradient_x.squaredNorm()), xy, xy,
      static_cast<double>(n.gradient_y.squaredNorm());
  const Eigen::Vector2d sums(static_cast<double>(n.gradient_x.sum()),
                             static_cast<double>(n.gradient_y.sum()));
  const Eigen::Vector2d slope(static_cast<double>(n.gradient_x.dot(residual)),
                              static_cast<double>(n.gradient_y.dot(residual)));
  const auto J = n.pixel_by_pose.transpose();
  sum.H.topLeftCorner<6, 6>() += weight * J * gradients * n.pixel_by_pose;
  sum.H.topRightCorner<6, 1>() += weight * J * sums;
  sum.H(6, 6) += weight * kPointTexels;
  sum.g.head<6>() += weight * J * slope;
  sum.g(6) += weight * static_cast<double>(residual.sum());
  ++sum.points;
}

/// What is estimated: the pose, and the intensity offset of the current image.
struct AlignmentState {
  SE3 T_predicted_camera;
  double offset = 0;
};

/// Normal equations at this state.
AlignmentEquations linearize_points(const std::vector<Neighborhood>& all, const cv::Mat& image,
                                    const PinholeCamera& camera, int octave, const AlignmentState& state) {
  constexpr double kMargin = kHalfPoint + 1;
  const SE3 T_camera_predicted = state.T_predicted_camera.inverse();
  AlignmentEquations sum;
  PointTexels values;
  for (const Neighborhood& n : all) {
    const Eigen::Vector3d p_camera = T_camera_predicted * n.point->p_camera;
    if (!(p_camera.z() > 0)) continue;
    const Eigen::Vector2d shift = camera.project(p_camera) - camera.project(n.point->p_camera);
    const Eigen::Vector2d at = to_octave(n.point->current + shift, octave);
    if (!holds(image, at, kMargin)) continue;
    sample_4x4(image, at.cast<float>(), values);
    values.array() -= static_cast<float>(state.offset);
    add_point(sum, n, values - n.intensity);
  }
  sum.H.bottomLeftCorner<1, 6>() = sum.H.topRightCorner<6, 1>().transpose();
  return sum;
}

}  // namespace

SE3 align_images(const ImageOctaves& previous, const ImageOctaves& current,
                 std::span<const AlignmentPoint> points, const PinholeCamera& camera) {
  constexpr int kFinestOctave = 2;
  constexpr int kMaxIterations = 10, kMinPoints = 10;
  constexpr double kConverged = 1e-4;  // m and rad; the alignment of single patches follows
  SE3 T_predicted_camera;
  const int coarsest = static_cast<int>(std::min(previous.size(), current.size())) - 1;
  for (int octave = coarsest; octave >= std::min(kFinestOctave, coarsest); --octave) {
    const auto level = static_cast<size_t>(octave);
    const auto all = neighborhoods(previous[level], points, camera, octave);
    double offset = 0;
    for (int iteration = 0; iteration < kMaxIterations; ++iteration) {
      const AlignmentEquations sum =
          linearize_points(all, current[level], camera, octave, {T_predicted_camera, offset});
      if (sum.points < kMinPoints) break;
      const Eigen::Matrix<double, kParameters, 1> step = -sum.H.ldlt().solve(sum.g);
      if (!step.allFinite()) break;
      T_predicted_camera = T_predicted_camera * SE3::exp(step.head<6>());
      offset -= step(6);
      if (step.head<6>().norm() < kConverged) break;
    }
  }
  return T_predicted_camera;
}

}  // namespace kinloop
