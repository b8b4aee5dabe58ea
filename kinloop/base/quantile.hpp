#pragma once
// Values of which a given share is not larger, without sorting all.

#include <algorithm>
#include <cstddef>
#include <utility>
#include <vector>

namespace kinloop {

/// The value at place `rank` of the sorted values; T{} of none.
template <class T>
T nth_smallest(std::vector<T> values, size_t rank) {
  if (values.empty()) return {};
  const auto at = values.begin() + static_cast<std::ptrdiff_t>(rank);
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

/// The value at `share` (0 to 1) of the way from the smallest to the largest, the smaller of two; T{} of
/// none.
template <class T>
T quantile(std::vector<T> values, double share) {
  if (values.empty()) return {};
  const auto rank = static_cast<size_t>(share * static_cast<double>(values.size() - 1));
  return nth_smallest(std::move(values), rank);
}

/// The middle value, the larger of the two where their number is even; T{} of none.
template <class T>
T median(std::vector<T> values) {
  const size_t middle = values.size() / 2;
  return nth_smallest(std::move(values), middle);
}

}  // namespace kinloop
