#pragma once
// In: binary descriptors. Out: k centres and the nearest centre of each descriptor: Lloyd's k-means under the
// Hamming distance, where the best centre is the bitwise majority (k-majority, Grana et al. 2013).

#include <cstdint>
#include <span>
#include <vector>

#include "kinloop/place/binary_descriptor.hpp"

namespace kinloop {

/// How the first centres are chosen.
enum class Seeding { kRandom, kKmeansPlusPlus };

struct ClusterOptions {
  int clusters = 10;
  Seeding seeding = Seeding::kKmeansPlusPlus;
  int iterations = 10;  ///< most Lloyd iterations; 0 = the seeds as they are
  uint64_t seed = 1;
  int candidates = 0;  ///< drawn for each k-means++ centre, the best is kept; 0 = 2 + ln(clusters), 1 = plain
  int threads = 1;     ///< does not change the result
};

struct Clusters {
  std::vector<BinaryDescriptor> centres;  ///< fewer than asked for where there are fewer different points
  std::vector<uint32_t> cluster_of;       ///< per point: its nearest centre, ties to the lower index
  uint64_t distance_sum = 0;              ///< of all points to their centres, bits
};

/// Clusters `points` (at least one). No cluster is empty: one that runs empty gets the point farthest from
/// its own centre. All sums are of integers, so the result does not depend on `threads`.
Clusters cluster_binary(std::span<const BinaryDescriptor> points, const ClusterOptions& options);

/// Distinct points as first centres: uniformly, or by k-means++ (Arthur and Vassilvitskii 2007), which draws
/// each next one with probability proportional to D^2, the squared Euclidean distance to the nearest centre
/// so far. On bits the squared Euclidean distance *is* the Hamming distance, so that is the weight.
std::vector<BinaryDescriptor> seed_centres(std::span<const BinaryDescriptor> points,
                                           const ClusterOptions& options);

/// The bitwise majority, which minimises the sum of Hamming distances to `points`; ties keep the bit of
/// `current`, so that an optimal centre does not move.
BinaryDescriptor majority_centre(std::span<const BinaryDescriptor> points, const BinaryDescriptor& current);

}  // namespace kinloop
