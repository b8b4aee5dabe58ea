#pragma once
// In: points. Out: the largest planes among them, by RANSAC (Fischler and Bolles 1981) and least squares:
// determines the vertical independently of normals, cameras and kinloop's estimate.

#include <vector>

#include <Eigen/Core>

namespace kinloop {

struct Plane {
  Eigen::Vector3d normal;
  double offset_m = 0;  ///< normal . p = offset
  double share = 0;     ///< of all points
  double rms_m = 0;
};

std::vector<Plane> largest_planes(std::vector<Eigen::Vector3d> points, int count);

}  // namespace kinloop
