#include "bench/up/planes.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>

#include "kinloop/core/random.hpp"

namespace kinloop {
namespace {

constexpr double kNear_m = 0.02;

std::vector<Eigen::Vector3d> near(const std::vector<Eigen::Vector3d>& points, const Plane& plane,
                                  bool inside) {
  std::vector<Eigen::Vector3d> kept;
  for (const auto& p : points) {
    if ((std::abs(plane.normal.dot(p) - plane.offset_m) < kNear_m) == inside) kept.push_back(p);
  }
  return kept;
}

Plane fitted(const std::vector<Eigen::Vector3d>& points) {
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (const auto& p : points) mean += p / static_cast<double>(points.size());
  Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
  for (const auto& p : points)
    spread += (p - mean) * (p - mean).transpose() / static_cast<double>(points.size());
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(spread);
  const Eigen::Vector3d normal = solver.eigenvectors().col(0);
  return {normal, normal.dot(mean), 0, std::sqrt(std::max(0.0, solver.eigenvalues()(0)))};
}

}  // namespace

std::vector<Plane> largest_planes(std::vector<Eigen::Vector3d> points, int count) {
  constexpr int kTries = 1000;
  const auto all = static_cast<double>(points.size());
  Random random(1);
  std::vector<Plane> planes;
  while (static_cast<int>(planes.size()) < count && points.size() > 100) {
    Plane best;
    size_t most = 0;
    const auto any = [&] { return points[random.index(static_cast<uint32_t>(points.size()))]; };
    for (int i = 0; i < kTries; ++i) {
      const Eigen::Vector3d a = any(), b = any(), c = any();
      const Eigen::Vector3d normal = (b - a).cross(c - a).normalized();
      const Plane plane{normal, normal.dot(a), 0, 0};
      size_t inside = 0;
      for (size_t k = 0; k < points.size(); k += 10) {
        inside += static_cast<size_t>(std::abs(plane.normal.dot(points[k]) - plane.offset_m) < kNear_m);
      }
      if (inside > most) most = inside, best = plane;
    }
    for (int i = 0; i < 3; ++i) best = fitted(near(points, best, true));
    const size_t before = points.size();
    points = near(points, best, false);
    best.share = static_cast<double>(before - points.size()) / all;
    planes.push_back(best);
  }
  return planes;
}

}  // namespace kinloop
