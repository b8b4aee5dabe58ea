#pragma once
// Points of which each process has some: the first of them the first process, and so on.

#include <algorithm>
#include <numeric>

#include "kinloop/base/parallel_for.hpp"
#include "kinloop/base/random.hpp"
#include "kinloop/place/clustering.hpp"

namespace kinloop {

/// One number per point of this process.
using PerPoint = std::pmr::vector<uint32_t>;

template <class Space>
class SharedPoints {
 public:
  using Point = typename Space::Point;

  /// `weights` (one per point here, or none: all 1) say how many points each stands for.
  SharedPoints(std::span<const Point> here, const ClusterOptions& options, const Ranks& ranks,
               std::span<const uint64_t> weights = {})
      : here_(here),
        weights_(weights),
        threads_(options.threads),
        memory_(options.memory),
        ranks_(ranks),
        counts_(ranks.all(here.size())) {}

  [[nodiscard]] std::span<const Point> here() const { return here_; }
  [[nodiscard]] const Ranks& ranks() const { return ranks_; }
  [[nodiscard]] int threads() const { return threads_; }
  [[nodiscard]] uint64_t total() const {
    return std::accumulate(counts_.begin(), counts_.end(), uint64_t{0});
  }
  /// The number of this process's first point.
  [[nodiscard]] uint64_t first() const {
    return std::accumulate(counts_.begin(), counts_.begin() + ranks_.rank(), uint64_t{0});
  }

  [[nodiscard]] PerPoint per_point(uint32_t value) const { return PerPoint(here_.size(), value, memory_); }

  /// Point `number`, wherever it is.
  [[nodiscard]] Point at(uint64_t number) const {
    const uint64_t begin = first();
    return fetch(number >= begin && number - begin < here_.size(), number - begin);
  }

  /// Sum of `distances`, each as often as its point counts, over all points.
  [[nodiscard]] uint64_t sum(const PerPoint& distances) const { return ranks_.sum_of(sum_here(distances)); }

  /// A point drawn with probability proportional to its distance; `sum` is sum(distances), above 0.
  [[nodiscard]] Point draw(const PerPoint& distances, uint64_t sum, Random& random) const {
    auto left = static_cast<uint64_t>(random.uniform() * static_cast<double>(sum));
    const auto sums = ranks_.all(sum_here(distances));
    int owner = 0;
    while (left >= sums[static_cast<size_t>(owner)]) left -= sums[static_cast<size_t>(owner++)];
    size_t drawn = 0;
    if (owner == ranks_.rank()) {
      while (left >= weight(drawn) * distances[drawn]) left -= weight(drawn) * distances[drawn], ++drawn;
    }
    return fetch(owner == ranks_.rank(), drawn);
  }

  /// The distances with one more centre.
  [[nodiscard]] PerPoint with_centre(const PerPoint& distances, const Point& centre) const {
    PerPoint lowered = per_point(0), nearest = per_point(0);
    parallel_for(here_.size(), threads_, [&](size_t begin, size_t end) {
      assign_to_nearest<Space>(here_.subspan(begin, end - begin), {&centre, 1}, &nearest[begin],
                               &lowered[begin]);
      for (size_t i = begin; i < end; ++i) lowered[i] = std::min(lowered[i], distances[i]);
    });
    return lowered;
  }

 private:
  [[nodiscard]] uint64_t weight(size_t i) const { return weights_.empty() ? 1 : weights_[i]; }

  [[nodiscard]] uint64_t sum_here(const PerPoint& distances) const {
    uint64_t sum = 0;
    for (size_t i = 0; i < distances.size(); ++i) sum += weight(i) * distances[i];
    return sum;
  }

  /// The point with `index` of the one process that says it is `mine`.
  [[nodiscard]] Point fetch(bool mine, uint64_t index) const {
    std::array<uint64_t, std::tuple_size_v<Point>> bytes{};
    if (mine) std::copy(here_[index].begin(), here_[index].end(), bytes.begin());
    ranks_.sum(bytes);
    Point point;
    std::transform(bytes.begin(), bytes.end(), point.begin(),
                   [](uint64_t byte) { return static_cast<uint8_t>(byte); });
    return point;
  }

  std::span<const Point> here_;
  std::span<const uint64_t> weights_;
  int threads_;
  std::pmr::memory_resource* memory_;
  const Ranks& ranks_;
  std::vector<uint64_t> counts_;  ///< per process
};

}  // namespace kinloop
