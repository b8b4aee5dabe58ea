#pragma once
// Steps of bundle adjustment: eliminates the points from the normal equations (Schur complement; Triggs et
// al. 2000, section 6.1), solves the reduced camera system and back-substitutes the points.

#include <limits>
#include <optional>
#include <vector>

#include "kinloop/optimize/bundle/bundle_normal.hpp"

namespace kinloop {

/// Step of all unknowns.
struct BundleStep {
  Eigen::VectorXd cameras;  ///< blocks of 6
  SensorVector sensor = SensorVector::Zero();
  std::vector<Eigen::Vector3d> points;
};

class BundleSchur {
 public:
  explicit BundleSchur(const BundleTask& task);

  /// Computes residuals and derivatives at `state`.
  void linearize(const BundleState& state) { normal_.linearize(state); }

  /// Returns the damped Gauss-Newton step from the linearised state, or nullopt if the system is singular.
  /// Sensor parameters for which `sensor_steps` is not NaN take these steps.
  std::optional<BundleStep> solve(double damping,
                                  const SensorVector& sensor_steps = SensorVector::Constant(kNaN));

  [[nodiscard]] BundleState apply(const BundleState& state, const BundleStep& step) const;

  /// Returns the covariance of the sensor and, if requested in the options, of the poses, at the linearised
  /// state.
  BundleCovariance covariance();

 private:
  static constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
  using Normal = BundleNormalEquations;
  static constexpr int kCameraDof = Normal::kCameraDof;

  /// The reduced system of cameras c and sensor s after eliminating the points: [A B; B' S] (c; s) = -(a; b).
  struct Reduced {
    BlockMatrix<kCameraDof> A;
    Eigen::MatrixXd a_B;  ///< a, B
    Eigen::MatrixXd S;    ///< first row and column: b

    [[nodiscard]] auto a() const { return a_B.col(0); }
    [[nodiscard]] auto B() const { return a_B.rightCols(a_B.cols() - 1); }
    [[nodiscard]] auto b() const { return S.col(0).tail(S.rows() - 1); }
    [[nodiscard]] auto sensor() const { return S.bottomRightCorner(S.rows() - 1, S.cols() - 1); }
  };

  void eliminate_points(double damping);
  [[nodiscard]] Reduced reduce(double damping);
  [[nodiscard]] BundleCovariance unconstrained_covariance() const;
  [[nodiscard]] BundleCovariance covariance_of(const Reduced& system) const;
  void reduce_column(size_t camera, Reduced& system) const;
  void reduce_sensor(Reduced& system) const;
  [[nodiscard]] std::optional<Eigen::VectorXd> sensor_step(const Reduced& system,
                                                           const Eigen::MatrixXd& A_inverse_a_B,
                                                           const SensorVector& sensor_steps) const;
  [[nodiscard]] std::vector<Eigen::Vector3d> point_steps(const Eigen::VectorXd& cameras,
                                                         const Eigen::VectorXd& sensor) const;

  Normal normal_;
  EliminationPlan plan_;
  SparseCholesky<kCameraDof> cholesky_;
  std::vector<PointFactor> factors_;  // per point, of the damped point block
  size_t border_stride_;
  std::vector<double> border_;  // per point [axis][border]: L^-1 of gradient and sensor
};

}  // namespace kinloop
