#include "tools/vocabulary_training/clustering/clustering.hpp"

#include "tools/vocabulary_training/clustering/distributed_points.hpp"

namespace kinloop {
namespace {

/// The nearest centre of each point and its distance.
struct Assignment {
  PointValues cluster_of;
  PointValues distance;
};

template <class Space>
using Centres = std::vector<typename Space::Point>;

template <class Space>
Assignment assign(const DistributedPoints<Space>& points, const Centres<Space>& centres) {
  Assignment result{points.make_point_values(0), points.make_point_values(0)};
  parallel_for(points.local().size(), points.threads(), [&](size_t begin, size_t end) {
    assign_to_nearest<Space>(points.local().subspan(begin, end - begin), centres, &result.cluster_of[begin],
                             &result.distance[begin]);
  });
  return result;
}

/// Per cluster its number of points and their counts, over all threads and processes.
struct ClusterSums {
  size_t stride;  ///< numbers per cluster
  std::vector<uint64_t> numbers;

  [[nodiscard]] uint64_t points(size_t cluster) const { return numbers[cluster * stride]; }
  [[nodiscard]] const uint64_t* counts(size_t cluster) const { return &numbers[cluster * stride + 1]; }
};

template <class Space>
ClusterSums count_votes(const DistributedPoints<Space>& points, const PointValues& cluster_of,
                        size_t clusters) {
  constexpr size_t kStride = Space::kCounts + 1;
  const auto pieces = static_cast<size_t>(std::max(points.threads(), 1));
  std::vector<std::vector<uint64_t>> of_piece(pieces, std::vector<uint64_t>(clusters * kStride, 0));
  const auto local = points.local();
  parallel_for(pieces, points.threads(), [&](size_t first, size_t last) {
    for (size_t piece = first; piece < last; ++piece) {
      const size_t end = local.size() * (piece + 1) / pieces;
      for (size_t i = local.size() * piece / pieces; i < end; ++i) {
        uint64_t* votes = &of_piece[piece][cluster_of[i] * kStride];
        ++votes[0];
        Space::add(local[i], votes + 1);
      }
    }
  });
  for (size_t piece = 1; piece < pieces; ++piece) {
    std::transform(of_piece[0].begin(), of_piece[0].end(), of_piece[piece].begin(), of_piece[0].begin(),
                   std::plus<>());
  }
  points.communicator().sum(of_piece[0]);
  return {kStride, std::move(of_piece[0])};
}

template <class Space>
std::vector<uint64_t> cluster_sizes(const DistributedPoints<Space>& points, const PointValues& cluster_of,
                                    size_t clusters) {
  std::vector<uint64_t> sizes(clusters, 0);
  for (const uint32_t cluster : cluster_of) ++sizes[cluster];
  points.communicator().sum(sizes);
  return sizes;
}

/// The point farthest from its own centre, the first on ties: its owner, its index there, its cluster.
struct Farthest {
  int owner = 0;
  uint64_t distance = 0;
  size_t index = 0;  ///< meaningful only to the owner
  uint64_t cluster = 0;
};

Farthest farthest_point(const Assignment& assignment, const Communicator& communicator) {
  const auto mine = std::max_element(assignment.distance.begin(), assignment.distance.end());
  const bool any = mine != assignment.distance.end();
  Farthest result;
  result.index = static_cast<size_t>(mine - assignment.distance.begin());
  const auto distances = communicator.all_gather(any ? *mine : 0);
  const auto farthest = std::max_element(distances.begin(), distances.end());
  result.owner = static_cast<int>(farthest - distances.begin());
  result.distance = *farthest;
  result.cluster = communicator.all_reduce_sum(
      any && communicator.rank() == result.owner ? assignment.cluster_of[result.index] : 0);
  return result;
}

/// Moves the point farthest from its own centre into each empty cluster, as long as one has nonzero distance.
template <class Space>
void fill_empty_clusters(const DistributedPoints<Space>& points, Assignment& assignment, size_t clusters) {
  auto sizes = cluster_sizes(points, assignment.cluster_of, clusters);
  for (uint32_t cluster = 0; cluster < clusters; ++cluster) {
    if (sizes[cluster] > 0) continue;
    const Farthest farthest = farthest_point(assignment, points.communicator());
    if (farthest.distance == 0) return;
    if (sizes[farthest.cluster] == 1) return;  // alone in its cluster: the next update makes it the centre
    --sizes[farthest.cluster];
    sizes[cluster] = 1;
    if (farthest.owner != points.communicator().rank()) continue;
    assignment.cluster_of[farthest.index] = cluster;
    assignment.distance[farthest.index] = 0;
  }
}

template <class Space>
Centres<Space> drop_empty(const DistributedPoints<Space>& points, const Centres<Space>& centres,
                          PointValues& cluster_of) {
  const auto sizes = cluster_sizes(points, cluster_of, centres.size());
  std::vector<uint32_t> renumbered(centres.size(), 0);
  Centres<Space> kept;
  for (size_t j = 0; j < centres.size(); ++j) {
    if (sizes[j] == 0) continue;
    renumbered[j] = static_cast<uint32_t>(kept.size());
    kept.push_back(centres[j]);
  }
  for (uint32_t& cluster : cluster_of) cluster = renumbered[cluster];
  return kept;
}

}  // namespace

template <class Space>
Clusters<Space> cluster(std::span<const typename Space::Point> local, const ClusterOptions& options,
                        const Communicator& communicator) {
  const DistributedPoints<Space> points(local, options, communicator);
  auto centres = seed_centres(points, options);
  auto assignment = assign(points, centres);
  for (int iteration = 0; iteration < options.iterations; ++iteration) {
    fill_empty_clusters(points, assignment, centres.size());
    const ClusterSums votes = count_votes(points, assignment.cluster_of, centres.size());
    const auto before = centres;
    for (size_t j = 0; j < centres.size(); ++j) {
      if (votes.points(j) > 0) centres[j] = Space::mean(votes.counts(j), votes.points(j), centres[j]);
    }
    if (centres == before) break;
    assignment = assign(points, centres);
  }
  centres = drop_empty(points, centres, assignment.cluster_of);
  const uint64_t distance_sum = points.sum(assignment.distance);
  return {std::move(centres), std::move(assignment.cluster_of), distance_sum};
}

template Clusters<HammingSpace> cluster(std::span<const HammingSpace::Point>, const ClusterOptions&,
                                        const Communicator&);
template Clusters<SiftSpace> cluster(std::span<const SiftSpace::Point>, const ClusterOptions&,
                                     const Communicator&);
template Clusters<SurfSpace> cluster(std::span<const SurfSpace::Point>, const ClusterOptions&,
                                     const Communicator&);

}  // namespace kinloop
