#pragma once
// In: a list of errors. Out: the figures that the TUM tools print of it.

#include <cstddef>
#include <span>

namespace kinloop {

/// Summary of errors, in their unit; all zero when there are none.
struct ErrorStatistics {
  size_t count = 0;
  double rmse = 0;
  double mean = 0;
  double median = 0;
  double std = 0;  ///< of the population (divided by count, as numpy.std)
  double min = 0;
  double max = 0;
};

/// The figures of `errors`, which may be in any order.
ErrorStatistics compute_statistics(std::span<const double> errors);

}  // namespace kinloop
