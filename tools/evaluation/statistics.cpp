#include "tools/evaluation/statistics.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

namespace kinloop {

ErrorStatistics compute_statistics(std::span<const double> errors) {
  if (errors.empty()) return {};
  std::vector<double> sorted(errors.begin(), errors.end());
  std::sort(sorted.begin(), sorted.end());
  const auto n = static_cast<double>(sorted.size());

  double sum = 0, sum_of_squares = 0;
  for (const double error : sorted) {
    sum += error;
    sum_of_squares += error * error;
  }
  const double mean = sum / n;
  double deviations = 0;
  for (const double error : sorted) deviations += (error - mean) * (error - mean);

  const size_t middle = sorted.size() / 2;
  return {.count = sorted.size(),
          .rmse = std::sqrt(sum_of_squares / n),
          .mean = mean,
          .median = sorted.size() % 2 == 1 ? sorted[middle] : (sorted[middle - 1] + sorted[middle]) / 2,
          .std = std::sqrt(deviations / n),
          .min = sorted.front(),
          .max = sorted.back()};
}

}  // namespace kinloop
