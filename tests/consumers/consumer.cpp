// A program outside of the project that uses kinloop as a library.

#include <cstdio>

#include "kinloop/geometry/se3.hpp"

int main() {
  const kinloop::SE3 T_world_a{Eigen::Quaterniond::Identity(), {1, 2, 3}};
  const double error_m = (T_world_a * T_world_a.inverse()).translation.norm();
  std::puts(error_m < 1e-12 ? "kinloop works" : "kinloop does not work");
  return error_m < 1e-12 ? 0 : 1;
}
