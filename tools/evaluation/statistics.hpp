#pragma once
// In: a list of errors. Out: the statistics that the TUM tools print.

#include <cstddef>
#include <span>

namespace kinloop {

/// Statistics of errors, in their unit; all zero if there are none.
struct ErrorStatistics {
  size_t count = 0;
  double rmse = 0;
  double mean = 0;
  double median = 0;
  double std = 0;  ///< of the population (divided by count, as numpy.std)
  double min = 0;
  double max = 0;
};

/// Computes the statistics of `errors`, in any order.
ErrorStatistics compute_statistics(std::span<const double> errors);

}  // namespace kinloop
