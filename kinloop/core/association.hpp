#pragma once
// Association of two time-stamped lists: colour with depth, an estimate with ground truth.

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace kinloop {

/// A pair of associated stamps, as indices into the two lists.
struct StampPair {
  size_t a = 0;
  size_t b = 0;

  auto operator<=>(const StampPair&) const = default;
};

/// Default tolerance of the TUM tools.
constexpr int64_t kMaxAssociationNs = 20'000'000;

/// Pairs stamps that differ by at most `max_difference_ns`, closest pairs first, using each entry once (the
/// algorithm of the TUM benchmark's associate.py). The result is sorted by time; the input lists may be in
/// any order.
std::vector<StampPair> associate_stamps(std::span<const int64_t> a_ns, std::span<const int64_t> b_ns,
                                        int64_t max_difference_ns = kMaxAssociationNs);

}  // namespace kinloop
