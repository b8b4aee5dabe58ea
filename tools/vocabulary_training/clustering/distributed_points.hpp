#pragma once
// Points distributed over processes: process 0 holds the first ones, and so on; and the first centres of
// their clusters.

#include <algorithm>
#include <numeric>

#include "kinloop/core/random.hpp"
#include "kinloop/core/threads/parallel_for.hpp"
#include "tools/vocabulary_training/clustering/clustering.hpp"

namespace kinloop {

/// One number per local point.
using PointValues = std::pmr::vector<uint32_t>;

template <class Space>
class DistributedPoints {
 public:
  using Point = typename Space::Point;

  /// `weights` (one per local point, or none: all 1) give the multiplicity of each point.
  DistributedPoints(std::span<const Point> local, const ClusterOptions& options,
                    const Communicator& communicator, std::span<const uint64_t> weights = {})
      : local_(local),
        weights_(weights),
        threads_(options.threads),
        memory_(options.memory),
        communicator_(communicator),
        counts_(communicator.all_gather(local.size())) {}

  [[nodiscard]] std::span<const Point> local() const { return local_; }
  [[nodiscard]] const Communicator& communicator() const { return communicator_; }
  [[nodiscard]] int threads() const { return threads_; }
  [[nodiscard]] uint64_t total() const {
    return std::accumulate(counts_.begin(), counts_.end(), uint64_t{0});
  }
  /// Number of this process's first point.
  [[nodiscard]] uint64_t first() const {
    return std::accumulate(counts_.begin(), counts_.begin() + communicator_.rank(), uint64_t{0});
  }

  [[nodiscard]] PointValues make_point_values(uint32_t value) const {
    return PointValues(local_.size(), value, memory_);
  }

  /// Returns point `number`, wherever it is stored.
  [[nodiscard]] Point at(uint64_t number) const {
    const uint64_t begin = first();
    return fetch(number >= begin && number - begin < local_.size(), number - begin);
  }

  /// Returns the sum of `distances`, weighted by multiplicity, over all points.
  [[nodiscard]] uint64_t sum(const PointValues& distances) const {
    return communicator_.all_reduce_sum(local_sum(distances));
  }

  /// Draws a point with probability proportional to its distance; `sum` is sum(distances), above 0.
  [[nodiscard]] Point draw(const PointValues& distances, uint64_t sum, Random& random) const {
    auto left = static_cast<uint64_t>(random.uniform() * static_cast<double>(sum));
    const auto sums = communicator_.all_gather(local_sum(distances));
    int owner = 0;
    while (left >= sums[static_cast<size_t>(owner)]) left -= sums[static_cast<size_t>(owner++)];
    size_t drawn = 0;
    if (owner == communicator_.rank()) {
      while (left >= weight(drawn) * distances[drawn]) left -= weight(drawn) * distances[drawn], ++drawn;
    }
    return fetch(owner == communicator_.rank(), drawn);
  }

  /// Returns the distances after adding a centre.
  [[nodiscard]] PointValues update_distances(const PointValues& distances, const Point& centre) const {
    PointValues lowered = make_point_values(0), nearest = make_point_values(0);
    parallel_for(local_.size(), threads_, [&](size_t begin, size_t end) {
      assign_to_nearest<Space>(local_.subspan(begin, end - begin), {&centre, 1}, &nearest[begin],
                               &lowered[begin]);
      for (size_t i = begin; i < end; ++i) lowered[i] = std::min(lowered[i], distances[i]);
    });
    return lowered;
  }

 private:
  [[nodiscard]] uint64_t weight(size_t i) const { return weights_.empty() ? 1 : weights_[i]; }

  [[nodiscard]] uint64_t local_sum(const PointValues& distances) const {
    uint64_t sum = 0;
    for (size_t i = 0; i < distances.size(); ++i) sum += weight(i) * distances[i];
    return sum;
  }

  /// Returns the point with `index` from the one process with `mine` set.
  [[nodiscard]] Point fetch(bool mine, uint64_t index) const {
    std::array<uint64_t, std::tuple_size_v<Point>> bytes{};
    if (mine) std::copy(local_[index].begin(), local_[index].end(), bytes.begin());
    communicator_.sum(bytes);
    Point point;
    std::transform(bytes.begin(), bytes.end(), point.begin(),
                   [](uint64_t byte) { return static_cast<uint8_t>(byte); });
    return point;
  }

  std::span<const Point> local_;
  std::span<const uint64_t> weights_;
  int threads_;
  std::pmr::memory_resource* memory_;
  const Communicator& communicator_;
  std::vector<uint64_t> counts_;  ///< per process
};

/// Returns at most `options.clusters` distinct points, the initial centres of k-means, in one of three ways:
/// - random: distinct points, drawn uniformly;
/// - k-means++ (Arthur and Vassilvitskii 2007): each next one with probability proportional to D^2, the
///   squared Euclidean distance to the nearest centre so far. On bits the squared Euclidean distance *is* the
///   Hamming distance, so that is the weight. Of several drawn, the best is kept (greedy);
/// - k-means|| (Bahmani et al. 2012, "Scalable k-means++"): a few rounds, in each of which every point
///   independently becomes a candidate with probability l D^2 / sum D^2; then k-means++ among the candidates,
///   each weighted by the number of points nearest to it.
template <class Space>
std::vector<typename Space::Point> seed_centres(const DistributedPoints<Space>& points,
                                                const ClusterOptions& options);

}  // namespace kinloop
