#include "kinloop/core/association.hpp"

#include <algorithm>
#include <cstdlib>
#include <numeric>
#include <tuple>

namespace kinloop {
namespace {

/// Indices sorted by time; equal stamps keep their order in the list.
std::vector<size_t> sort_by_time(std::span<const int64_t> stamps_ns) {
  std::vector<size_t> order(stamps_ns.size());
  std::iota(order.begin(), order.end(), size_t{0});
  std::stable_sort(order.begin(), order.end(),
                   [&](size_t i, size_t j) { return stamps_ns[i] < stamps_ns[j]; });
  return order;
}

/// All pairs within the tolerance, sorted by a's time, then b's.
std::vector<StampPair> close_pairs(std::span<const int64_t> a_ns, std::span<const int64_t> b_ns,
                                   int64_t max_difference_ns) {
  const auto order_b = sort_by_time(b_ns);
  std::vector<StampPair> pairs;
  size_t first = 0;  // first b that is not too early for this a; later ones cannot need an earlier b
  for (const size_t a : sort_by_time(a_ns)) {
    while (first < order_b.size() && b_ns[order_b[first]] < a_ns[a] - max_difference_ns) ++first;
    for (size_t k = first; k < order_b.size() && b_ns[order_b[k]] <= a_ns[a] + max_difference_ns; ++k) {
      pairs.push_back({a, order_b[k]});
    }
  }
  return pairs;
}

}  // namespace

std::vector<StampPair> associate_stamps(std::span<const int64_t> a_ns, std::span<const int64_t> b_ns,
                                        int64_t max_difference_ns) {
  auto candidates = close_pairs(a_ns, b_ns, max_difference_ns);
  const auto difference_ns = [&](const StampPair& p) { return std::abs(a_ns[p.a] - b_ns[p.b]); };
  std::stable_sort(candidates.begin(), candidates.end(),
                   [&](const auto& p, const auto& q) { return difference_ns(p) < difference_ns(q); });

  std::vector<bool> a_taken(a_ns.size()), b_taken(b_ns.size());
  std::vector<StampPair> chosen;
  for (const StampPair& pair : candidates) {
    if (a_taken[pair.a] || b_taken[pair.b]) continue;
    a_taken[pair.a] = b_taken[pair.b] = true;
    chosen.push_back(pair);
  }
  std::sort(chosen.begin(), chosen.end(), [&](const auto& p, const auto& q) {
    return std::tie(a_ns[p.a], p.a) < std::tie(a_ns[q.a], q.a);
  });
  return chosen;
}

}  // namespace kinloop
