#include "kinloop/optimize/pose/icp.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Cholesky>

#include "kinloop/core/errors.hpp"
#include "kinloop/geometry/pixel_grid.hpp"
#include "kinloop/geometry/robust_loss.hpp"

namespace kinloop {
namespace {

/// Normal equations over one grid.
struct GridNormal {
  Matrix6d H = Matrix6d::Zero();  // lower triangle
  Vector6d g = Vector6d::Zero();

  void add(const Vector6d& J, double residual, double weight) {
    for (int c = 0; c < 6; ++c) {
      const double scaled = weight * J(c);
      g(c) += scaled * residual;
      for (int r = c; r < 6; ++r) H(r, c) += scaled * J(r);
    }
  }
};

/// Result of one pass over a grid.
struct Pass {
  GridNormal depth, gray;
  size_t points = 0, partners = 0, gray_pixels = 0;
  double squared_m2 = 0;       // sum of squared distances
  double depth_chi2 = 0;       // robust cost of the normalised distances
  double gray_chi2 = 0;        // robust cost of the intensity differences
  double gray_difference = 0;  // sum of the intensity differences, to estimate the change of exposure
};

/// Interpolated intensity and its gradient per px; nullopt outside the image.
struct GraySample {
  double value = 0, slope_x = 0, slope_y = 0;
};

std::optional<GraySample> sample_gray(const cv::Mat& gray, double u, double v) {
  if (!(u >= 0 && v >= 0 && u < gray.cols - 1 && v < gray.rows - 1)) return std::nullopt;
  const int x = static_cast<int>(u), y = static_cast<int>(v);
  const double a = u - x, b = v - y;
  const float* top = gray.ptr<float>(y) + x;
  const float* bottom = gray.ptr<float>(y + 1) + x;
  const double g00 = top[0], g10 = top[1], g01 = bottom[0], g11 = bottom[1];
  return GraySample{(1 - b) * ((1 - a) * g00 + a * g10) + b * ((1 - a) * g01 + a * g11),
                    (1 - b) * (g10 - g00) + b * (g11 - g01), (1 - a) * (g01 - g00) + a * (g11 - g10)};
}

/// Alignment of one pyramid level.
class Aligner {
 public:
  Aligner(const IcpCamera& camera, size_t level, const IcpFrame& reference, const IcpFrame& frame,
          const IcpOptions& options)
      : camera_(camera.levels[level].camera),
        noise_(camera.noise),
        reference_(reference.levels[level]),
        frame_(frame.levels[level]),
        options_(options) {
    photometric_ = options.photometric_weight > 0 && !reference_.gray.empty() && !frame_.gray.empty();
  }

  /// Accumulates all points of the frame. `exposure` is the mean intensity difference from the previous pass.
  [[nodiscard]] Pass pass(const SE3& T_reference_camera, double exposure) const {
    Pass sum;
    const Eigen::Matrix3d R = T_reference_camera.R();
    for (size_t i = 0; i < frame_.points.size(); ++i) {
      if (!(frame_.points[i].z() > 0)) continue;
      const Eigen::Vector3d p = frame_.points[i].cast<double>();
      const Eigen::Vector3d q = R * p + T_reference_camera.translation;
      ++sum.points;
      if (!(q.z() > kMinDepth_m)) continue;
      const Eigen::Vector2d pixel = camera_.project(q);
      const MovedPoint point{i, p, q, pixel};
      if (photometric_) add_gray(point, R, exposure, sum);
      add_depth(point, R, sum);
    }
    return sum;
  }

 private:
  /// A point of the frame, where the pose moves it, and the pixel of the reference where it is seen.
  struct MovedPoint {
    size_t i;
    const Eigen::Vector3d &p, &q;
    const Eigen::Vector2d& pixel;
  };

  static constexpr double kMinDepth_m = 1e-3;
  static constexpr double kMaxDistance_m = 0.15;  // from a point to its correspondence
  static constexpr double kMaxNormalAngleRad = 0.7;
  static constexpr double kRobustWidth = 1.5;   // scale of the Huber loss, standard deviations
  static constexpr double kIntensitySigma = 6;  // intensity levels, of 255

  /// Point-to-plane distance (Chen and Medioni 1992) with projective association.
  void add_depth(const MovedPoint& point, const Eigen::Matrix3d& R, Pass& sum) const {
    const auto& [i, p, q, pixel] = point;
    if (!(pixel.x() > -0.5 && pixel.y() > -0.5)) return;
    // The first cell starts half a pixel before its centre.
    const Eigen::Vector2d from_corner = pixel.array() + 0.5;
    if (!(from_corner.x() < reference_.width && from_corner.y() < reference_.height)) return;
    const int x = static_cast<int>(from_corner.x()), y = static_cast<int>(from_corner.y());
    const size_t partner = grid_index(reference_.width, x, y);
    const Eigen::Vector3d n = reference_.normals[partner].cast<double>();
    if (n.isZero()) return;
    const Eigen::Vector3d apart = q - reference_.points[partner].cast<double>();
    if (apart.squaredNorm() > kMaxDistance_m * kMaxDistance_m) return;
    const Eigen::Vector3d other_normal = frame_.normals[i].cast<double>();
    if (other_normal.isZero()) return;
    const Eigen::Vector3d n_camera = R.transpose() * n;
    if (n_camera.dot(other_normal) < std::cos(kMaxNormalAngleRad)) return;

    const double distance = n.dot(apart);
    const double z_partner = static_cast<double>(reference_.points[partner].z());
    const double sigma = noise_.difference_sigma_m(p.z(), z_partner);
    const double squared = distance * distance / (sigma * sigma);
    const HuberLoss loss{kRobustWidth};
    Vector6d J;  // with respect to x of T * exp(x): the point moves by R (rho + omega x p)
    J << n_camera, p.cross(n_camera);
    sum.depth.add(J, distance, loss.weight(squared) / (sigma * sigma));
    sum.depth_chi2 += loss.rho(squared);
    sum.squared_m2 += distance * distance;
    ++sum.partners;
  }

  /// Photometric residual (Steinbruecker et al. 2011, Kerl et al. 2013): constant brightness except for
  /// exposure.
  void add_gray(const MovedPoint& point, const Eigen::Matrix3d& R, double exposure, Pass& sum) const {
    const auto& [i, p, q, pixel] = point;
    const auto sample = sample_gray(reference_.gray, pixel.x(), pixel.y());
    if (!sample) return;
    const int row = static_cast<int>(i) / frame_.width, column = static_cast<int>(i) % frame_.width;
    const double difference = sample->value - static_cast<double>(frame_.gray.at<float>(row, column));
    const double residual = difference - exposure;
    const double inverse_z = 1.0 / q.z();
    const double gu = sample->slope_x * camera_.fx * inverse_z, gv = sample->slope_y * camera_.fy * inverse_z;
    const Eigen::Vector3d slope(gu, gv, -(gu * q.x() + gv * q.y()) * inverse_z);  // with respect to q
    const Eigen::Vector3d slope_camera = R.transpose() * slope;
    Vector6d J;
    J << slope_camera, p.cross(slope_camera);
    const double variance = kIntensitySigma * kIntensitySigma;
    const double squared = residual * residual / variance;
    const HuberLoss loss{kRobustWidth};
    sum.gray.add(J, residual, options_.photometric_weight * loss.weight(squared) / variance);
    sum.gray_chi2 += loss.rho(squared);
    sum.gray_difference += difference;
    ++sum.gray_pixels;
  }

  const PinholeCamera& camera_;
  const DepthNoise& noise_;
  const IcpFrame::Level& reference_;
  const IcpFrame::Level& frame_;
  const IcpOptions& options_;
  bool photometric_ = false;
};

/// Information of the surfaces with its covariance inflated for correlated errors of neighbours and for a
/// poor fit.
Matrix6d inflated_information(const Pass& pass, double correlated) {
  const auto deflate = [&](const GridNormal& normal, double chi2, size_t count) -> Matrix6d {
    const double misfit = count > 0 ? std::max(1.0, chi2 / static_cast<double>(count)) : 1.0;
    return Matrix6d(normal.H.selfadjointView<Eigen::Lower>()) / (correlated * misfit);
  };
  return deflate(pass.depth, pass.depth_chi2, pass.partners) +
         deflate(pass.gray, pass.gray_chi2, pass.gray_pixels);
}

/// Weak prior that constrains the directions left free by the surfaces.
Matrix6d guess_information() {
  constexpr double kPriorSigma_m = 0.1, kPriorSigmaRad = 0.1;
  Vector6d diagonal;
  diagonal << Eigen::Vector3d::Constant(std::pow(kPriorSigma_m, -2)),
      Eigen::Vector3d::Constant(std::pow(kPriorSigmaRad, -2));
  return diagonal.asDiagonal();
}

}  // namespace

std::optional<IcpSolution> align_icp(const IcpCamera& camera, const IcpFrame& reference,
                                     const IcpFrame& frame, const SE3& T_reference_camera_guess,
                                     const IcpOptions& options) {
  constexpr double kCorrelationLengthPx = 64;  // of the depth error
  constexpr double kStepConverged = 5e-5;      // m and rad, well below the noise
  require(reference.levels.size() == camera.levels.size() && frame.levels.size() == camera.levels.size(),
          "align_icp: frames of another camera");
  if (!T_reference_camera_guess.is_finite()) return std::nullopt;
  // In grid points.
  const double correlated = std::max(1.0, std::pow(kCorrelationLengthPx / camera.block, 2));
  const Matrix6d prior = guess_information() * correlated;
  SE3 T = T_reference_camera_guess;
  Pass pass;
  for (size_t level = camera.levels.size(); level-- > 0;) {
    const Aligner aligner(camera, level, reference, frame, options);
    pass = aligner.pass(T, 0);
    for (int i = 0; i < options.iterations; ++i) {
      Matrix6d H = (pass.depth.H + pass.gray.H).selfadjointView<Eigen::Lower>();
      H += prior;
      const Vector6d g = pass.depth.g + pass.gray.g + prior * (T_reference_camera_guess.inverse() * T).log();
      const Vector6d step = -H.ldlt().solve(g);
      if (!step.allFinite()) return std::nullopt;
      T = T * SE3::exp(step);
      const double exposure =
          pass.gray_pixels > 0 ? pass.gray_difference / static_cast<double>(pass.gray_pixels) : 0;
      pass = aligner.pass(T, exposure);
      if (step.norm() < kStepConverged) break;
    }
  }
  if (pass.partners == 0 ||
      static_cast<double>(pass.partners) < options.min_overlap * static_cast<double>(pass.points)) {
    return std::nullopt;
  }
  IcpSolution solution;
  solution.T_reference_camera = T;
  solution.information = inflated_information(pass, correlated);
  solution.overlap = static_cast<double>(pass.partners) / static_cast<double>(pass.points);
  solution.rmse_m = std::sqrt(pass.squared_m2 / static_cast<double>(pass.partners));
  return solution;
}

}  // namespace kinloop
