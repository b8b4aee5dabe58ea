#include "kinloop/place/kmajority.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "kinloop/base/errors.hpp"
#include "kinloop/base/parallel_for.hpp"
#include "kinloop/base/random.hpp"

namespace kinloop {
namespace {

constexpr int kBits = kOrbBytes * 8;

using Points = std::span<const BinaryDescriptor>;

/// The nearest centre of each point and how far it is.
struct Assignment {
  std::vector<uint32_t> cluster_of;
  std::vector<uint32_t> distance;
};

KINLOOP_POPCOUNT_CLONES void assign_range(Points points, Points centres, uint32_t* cluster_of,
                                          uint32_t* distance) {
  for (size_t i = 0; i < points.size(); ++i) {
    int best = std::numeric_limits<int>::max();
    for (size_t j = 0; j < centres.size(); ++j) {
      const int candidate = hamming_distance(points[i].data(), centres[j].data());
      if (candidate < best) {
        best = candidate;
        cluster_of[i] = static_cast<uint32_t>(j);
      }
    }
    distance[i] = static_cast<uint32_t>(best);
  }
}

KINLOOP_POPCOUNT_CLONES void lower_distances(Points points, const BinaryDescriptor& centre,
                                             uint32_t* distance) {
  for (size_t i = 0; i < points.size(); ++i) {
    const auto candidate = static_cast<uint32_t>(hamming_distance(points[i].data(), centre.data()));
    distance[i] = std::min(distance[i], candidate);
  }
}

Assignment assign(Points points, Points centres, int threads) {
  Assignment result{std::vector<uint32_t>(points.size()), std::vector<uint32_t>(points.size())};
  parallel_for(points.size(), threads, [&](size_t begin, size_t end) {
    assign_range(points.subspan(begin, end - begin), centres, &result.cluster_of[begin],
                 &result.distance[begin]);
  });
  return result;
}

/// Counts, bit by bit, how many points have it set.
struct Votes {
  uint32_t points = 0;
  std::array<uint32_t, kBits> set{};

  void add(const BinaryDescriptor& point) {
    ++points;
    for (size_t byte = 0; byte < point.size(); ++byte) {
      for (size_t bit = 0; bit < 8; ++bit) set[8 * byte + bit] += (uint32_t{point[byte]} >> bit) & 1U;
    }
  }

  void add(const Votes& other) {
    points += other.points;
    for (size_t bit = 0; bit < set.size(); ++bit) set[bit] += other.set[bit];
  }

  [[nodiscard]] BinaryDescriptor majority(const BinaryDescriptor& current) const {
    BinaryDescriptor centre{};
    for (size_t bit = 0; bit < set.size(); ++bit) {
      const uint32_t twice = 2 * set[bit];
      const bool one = twice == points ? ((current[bit / 8] >> (bit % 8)) & 1) != 0 : twice > points;
      if (one) centre[bit / 8] = static_cast<uint8_t>(centre[bit / 8] | (1U << (bit % 8)));
    }
    return centre;
  }
};

/// One vote per cluster, summed over the pieces of all threads.
std::vector<Votes> count_votes(Points points, const std::vector<uint32_t>& cluster_of, size_t clusters,
                               int threads) {
  const auto pieces = static_cast<size_t>(std::max(threads, 1));
  std::vector<std::vector<Votes>> of_piece(pieces);
  parallel_for(pieces, threads, [&](size_t first, size_t last) {
    for (size_t piece = first; piece < last; ++piece) {
      auto& votes = of_piece[piece];
      votes.resize(clusters);
      const size_t end = points.size() * (piece + 1) / pieces;
      for (size_t i = points.size() * piece / pieces; i < end; ++i) votes[cluster_of[i]].add(points[i]);
    }
  });
  for (size_t piece = 1; piece < pieces; ++piece) {
    for (size_t j = 0; j < clusters; ++j) of_piece[0][j].add(of_piece[piece][j]);
  }
  return std::move(of_piece[0]);
}

/// Gives each empty cluster the point farthest from its own centre, as long as there is one away from it.
void fill_empty_clusters(Assignment& assignment, size_t clusters) {
  std::vector<uint32_t> sizes(clusters);
  for (const uint32_t cluster : assignment.cluster_of) ++sizes[cluster];
  for (uint32_t cluster = 0; cluster < clusters; ++cluster) {
    if (sizes[cluster] > 0) continue;
    const auto farthest = std::max_element(assignment.distance.begin(), assignment.distance.end());
    if (*farthest == 0) return;
    auto& moved = assignment.cluster_of[static_cast<size_t>(farthest - assignment.distance.begin())];
    if (sizes[moved] == 1) return;  // alone in its cluster: the coming vote makes it the centre
    --sizes[moved];
    moved = cluster;
    sizes[cluster] = 1;
    *farthest = 0;
  }
}

std::vector<BinaryDescriptor> drop_empty(const std::vector<BinaryDescriptor>& centres,
                                         std::vector<uint32_t>& cluster_of) {
  std::vector<uint32_t> renumbered(centres.size(), 0);
  for (const uint32_t cluster : cluster_of) renumbered[cluster] = 1;
  std::vector<BinaryDescriptor> kept;
  for (size_t j = 0; j < centres.size(); ++j) {
    if (renumbered[j] == 0) continue;
    renumbered[j] = static_cast<uint32_t>(kept.size());
    kept.push_back(centres[j]);
  }
  for (uint32_t& cluster : cluster_of) cluster = renumbered[cluster];
  return kept;
}

/// An index drawn with probability proportional to its weight; `sum` is the sum of all weights, above 0.
size_t draw(const std::vector<uint32_t>& weights, uint64_t sum, Random& random) {
  auto left = static_cast<uint64_t>(random.uniform() * static_cast<double>(sum));
  size_t drawn = 0;
  while (left >= weights[drawn]) left -= weights[drawn++];
  return drawn;
}

uint64_t sum_of(const std::vector<uint32_t>& distances) {
  return std::accumulate(distances.begin(), distances.end(), uint64_t{0});
}

/// The distances with one more centre.
std::vector<uint32_t> with_centre(Points points, std::vector<uint32_t> distances,
                                  const BinaryDescriptor& centre, int threads) {
  parallel_for(points.size(), threads, [&](size_t begin, size_t end) {
    lower_distances(points.subspan(begin, end - begin), centre, &distances[begin]);
  });
  return distances;
}

std::vector<BinaryDescriptor> seed_kmeans_plus_plus(Points points, const ClusterOptions& options) {
  Random random(options.seed);
  const int candidates =
      options.candidates > 0 ? options.candidates : 2 + static_cast<int>(std::log(options.clusters));
  std::vector<BinaryDescriptor> centres = {points[random.index(static_cast<uint32_t>(points.size()))]};
  auto distances =
      with_centre(points, std::vector<uint32_t>(points.size(), kBits), centres[0], options.threads);
  while (centres.size() < static_cast<size_t>(options.clusters)) {
    const uint64_t sum = sum_of(distances);
    if (sum == 0) break;  // every point is a centre already
    std::vector<uint32_t> best;
    for (int i = 0; i < candidates; ++i) {
      const auto& candidate = points[draw(distances, sum, random)];
      auto lowered = with_centre(points, distances, candidate, options.threads);
      if (!best.empty() && sum_of(lowered) >= sum_of(best)) continue;
      best = std::move(lowered);
      if (i > 0) centres.pop_back();
      centres.push_back(candidate);
    }
    distances = std::move(best);
  }
  return centres;
}

}  // namespace

std::vector<BinaryDescriptor> seed_centres(Points points, const ClusterOptions& options) {
  require(!points.empty() && options.clusters > 0, "clustering needs points and at least one cluster");
  if (options.seeding == Seeding::kKmeansPlusPlus) return seed_kmeans_plus_plus(points, options);
  Random random(options.seed);
  const auto count = static_cast<uint32_t>(points.size());
  std::vector<BinaryDescriptor> centres;
  for (const uint32_t i :
       sample_without_replacement(random, count, std::min(count, static_cast<uint32_t>(options.clusters)))) {
    centres.push_back(points[i]);
  }
  return centres;
}

BinaryDescriptor majority_centre(Points points, const BinaryDescriptor& current) {
  Votes votes;
  for (const auto& point : points) votes.add(point);
  return votes.majority(current);
}

Clusters cluster_binary(Points points, const ClusterOptions& options) {
  auto centres = seed_centres(points, options);
  auto assignment = assign(points, centres, options.threads);
  for (int iteration = 0; iteration < options.iterations; ++iteration) {
    fill_empty_clusters(assignment, centres.size());
    const auto votes = count_votes(points, assignment.cluster_of, centres.size(), options.threads);
    const auto before = centres;
    for (size_t j = 0; j < centres.size(); ++j) {
      if (votes[j].points > 0) centres[j] = votes[j].majority(centres[j]);
    }
    if (centres == before) break;
    assignment = assign(points, centres, options.threads);
  }
  Clusters clusters;
  clusters.cluster_of = std::move(assignment.cluster_of);
  clusters.centres = drop_empty(centres, clusters.cluster_of);
  clusters.distance_sum =
      std::accumulate(assignment.distance.begin(), assignment.distance.end(), uint64_t{0});
  return clusters;
}

}  // namespace kinloop
