#pragma once
// In: points. Out: the largest planes among them, by RANSAC (Fischler and Bolles 1981) and least squares: a
// way to the vertical that knows nothing of normals, cameras or what kinloop thinks of up.

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
