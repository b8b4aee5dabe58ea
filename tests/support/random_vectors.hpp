#pragma once
// Random vectors, the same with every compiler. The order in which two arguments of a call are evaluated is
// the compiler's choice, so that Vector2d(random.gaussian(), random.gaussian()) is not.

#include <Eigen/Core>

#include "kinloop/core/random.hpp"

namespace kinloop::test {

/// Coordinates are drawn from the last to the first.
template <int kSize>
Eigen::Matrix<double, kSize, 1> gaussian_vector(Random& random) {
  Eigen::Matrix<double, kSize, 1> v;
  for (Eigen::Index i = kSize; i-- > 0;) v[i] = random.gaussian();
  return v;
}

/// Same, uniform between `low` and `high`.
template <int kSize>
Eigen::Matrix<double, kSize, 1> uniform_vector(Random& random, const Eigen::Matrix<double, kSize, 1>& low,
                                               const Eigen::Matrix<double, kSize, 1>& high) {
  Eigen::Matrix<double, kSize, 1> v;
  for (Eigen::Index i = kSize; i-- > 0;) v[i] = random.uniform(low[i], high[i]);
  return v;
}

}  // namespace kinloop::test
