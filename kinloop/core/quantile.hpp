#pragma once
// Quantiles by partial sorting.

#include <algorithm>
#include <cstddef>
#include <utility>
#include <vector>

namespace kinloop {

/// Returns the element at index `rank` of the sorted values; T{} if there are none.
template <class T>
T nth_smallest(std::vector<T> values, size_t rank) {
  if (values.empty()) return {};
  const auto at = values.begin() + static_cast<std::ptrdiff_t>(rank);
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

/// Returns the quantile at `share` (0 to 1), rounding down to an element; T{} if there are no values.
template <class T>
T quantile(std::vector<T> values, double share) {
  if (values.empty()) return {};
  const auto rank = static_cast<size_t>(share * static_cast<double>(values.size() - 1));
  return nth_smallest(std::move(values), rank);
}

/// Returns the median, the larger middle element if their number is even; T{} if there are no values.
template <class T>
T median(std::vector<T> values) {
  const size_t middle = values.size() / 2;
  return nth_smallest(std::move(values), middle);
}

}  // namespace kinloop
