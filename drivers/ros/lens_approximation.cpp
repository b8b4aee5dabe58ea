#include "drivers/ros/lens_approximation.hpp"

#include <Eigen/Dense>

namespace kinloop {
namespace {

using Coefficients = std::array<double, 5>;  // k1, k2, p1, p2, k3

Eigen::Vector2d modified_brown_conrady(const Coefficients& c, const Eigen::Vector2d& ideal) {
  const double r2 = ideal.squaredNorm();
  const Eigen::Vector2d p = (1 + r2 * (c[0] + r2 * (c[1] + r2 * c[4]))) * ideal;
  return {p.x() + 2 * c[2] * p.x() * p.y() + c[3] * (r2 + 2 * p.x() * p.x()),
          p.y() + 2 * c[3] * p.x() * p.y() + c[2] * (r2 + 2 * p.y() * p.y())};
}

}  // namespace

std::array<double, 5> brown_conrady_from_modified(const Coefficients& coefficients,
                                                  const PinholeCamera& camera) {
  constexpr int kSteps = 20;  // per side
  constexpr int kEquations = 2 * (kSteps + 1) * (kSteps + 1);
  Eigen::MatrixXd A(kEquations, 5);
  Eigen::VectorXd b(kEquations);
  int row = 0;
  for (int i = 0; i <= kSteps; ++i) {
    for (int j = 0; j <= kSteps; ++j) {
      const Eigen::Vector2d pixel(camera.width * i / double{kSteps}, camera.height * j / double{kSteps});
      const Eigen::Vector2d ideal((pixel.x() - camera.cx) / camera.fx, (pixel.y() - camera.cy) / camera.fy);
      const double x = ideal.x(), y = ideal.y(), r2 = ideal.squaredNorm();
      A.row(row) << x * r2, x * r2 * r2, 2 * x * y, r2 + 2 * x * x, x * r2 * r2 * r2;
      A.row(row + 1) << y * r2, y * r2 * r2, r2 + 2 * y * y, 2 * x * y, y * r2 * r2 * r2;
      b.segment<2>(row) = modified_brown_conrady(coefficients, ideal) - ideal;
      row += 2;
    }
  }
  const Eigen::VectorXd fitted = A.colPivHouseholderQr().solve(b);
  return {fitted[0], fitted[1], fitted[2], fitted[3], fitted[4]};
}

}  // namespace kinloop
