#pragma once
// In: descriptors, distributed over the processes of `Communicator`. Out: k centres and the nearest centre of
// each descriptor, by Lloyd's k-means. Under the Hamming distance the best centre is the bitwise majority
// (k-majority, Grana et al. 2013), under the Euclidean one the mean.

#include <cstdint>
#include <memory_resource>
#include <span>
#include <vector>

#include "kinloop/core/options.hpp"
#include "kinloop/place/vocabulary/descriptor_space.hpp"
#include "tools/vocabulary_training/communicator.hpp"

namespace kinloop {

/// How the initial centres are chosen.
enum class Seeding { kRandom, kKmeansPlusPlus, kKmeansParallel };

constexpr auto option_names(Seeding) {
  using enum Seeding;
  return std::to_array<EnumName<Seeding>>(
      {{kKmeansPlusPlus, "kmeans++"}, {kKmeansParallel, "kmeans||"}, {kRandom, "random"}});
}

struct ClusterOptions {
  int clusters = 10;
  Seeding seeding = Seeding::kKmeansPlusPlus;
  int iterations = 10;  ///< maximum Lloyd iterations; 0 = use the seeds unchanged
  uint64_t seed = 1;
  int candidates = 0;  ///< drawn for each k-means++ centre, the best is kept; 0 = 2 + ln(clusters), 1 = plain
  int threads = 1;     ///< does not change the result
  std::pmr::memory_resource* memory = std::pmr::get_default_resource();  ///< for the data kept per point
};

template <class Space>
struct Clusters {
  std::vector<typename Space::Point> centres;  ///< fewer than requested if there are fewer distinct points
  std::pmr::vector<uint32_t> cluster_of;  ///< per local point: its nearest centre, ties to the lower index
  uint64_t distance_sum = 0;              ///< of all points in all processes to their centres
};

/// Clusters `points` (at least one in some process). No cluster is empty: an empty one gets the point
/// farthest from its own centre. All sums are integers and all choices follow the order of the points,
/// process by process, so the result depends neither on `threads` nor on the distribution of the points.
template <class Space>
Clusters<Space> cluster(std::span<const typename Space::Point> points, const ClusterOptions& options,
                        const Communicator& communicator = Communicator());

}  // namespace kinloop
