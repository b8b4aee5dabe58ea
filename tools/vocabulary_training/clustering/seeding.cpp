#include <cmath>
#include <limits>

#include "tools/vocabulary_training/clustering/distributed_points.hpp"

namespace kinloop {
namespace {

template <class Space>
using Points = std::vector<typename Space::Point>;

template <class Space>
typename Space::Point any_point(const DistributedPoints<Space>& points, Random& random) {
  return points.at(random.index(static_cast<uint32_t>(points.total())));
}

template <class Space>
Points<Space> seed_random(const DistributedPoints<Space>& points, const ClusterOptions& options) {
  Random random(options.seed);
  const auto count = static_cast<uint32_t>(points.total());
  Points<Space> centres;
  for (const uint32_t number :
       sample_without_replacement(random, count, std::min(count, static_cast<uint32_t>(options.clusters)))) {
    centres.push_back(points.at(number));
  }
  return centres;
}

template <class Space>
Points<Space> seed_kmeans_plus_plus(const DistributedPoints<Space>& points, const ClusterOptions& options) {
  Random random(options.seed);
  const int candidates =
      options.candidates > 0 ? options.candidates : 2 + static_cast<int>(std::log(options.clusters));
  Points<Space> centres = {any_point(points, random)};
  PointValues distances = points.update_distances(points.make_point_values(Space::kMaxDistance), centres[0]);
  uint64_t sum = points.sum(distances);
  while (centres.size() < static_cast<size_t>(options.clusters) && sum > 0) {
    PointValues best = points.make_point_values(0);
    uint64_t best_sum = sum;
    centres.emplace_back();
    for (int i = 0; i < candidates; ++i) {
      const auto candidate = points.draw(distances, sum, random);
      PointValues lowered = points.update_distances(distances, candidate);
      const uint64_t lowered_sum = points.sum(lowered);
      if (i > 0 && lowered_sum >= best_sum) continue;
      best.swap(lowered);
      best_sum = lowered_sum;
      centres.back() = candidate;
    }
    distances.swap(best);
    sum = best_sum;
  }
  return centres;
}

/// The nearest candidate of every point so far.
struct Nearest {
  PointValues candidate;
  PointValues distance;
};

/// The points selected as candidates in this round, in order, over all processes. The selection depends on a
/// point's number, not on its process.
template <class Space>
Points<Space> sample_candidates(const DistributedPoints<Space>& points, const PointValues& distance,
                                double factor, uint64_t seed) {
  Message chosen;
  const uint64_t first = points.first();
  for (size_t i = 0; i < distance.size(); ++i) {
    if (Random(hash(seed, first + i)).uniform() >= factor * distance[i]) continue;
    chosen.insert(chosen.end(), points.local()[i].begin(), points.local()[i].end());
  }
  Points<Space> all;
  for (const Message& message : points.communicator().gather(chosen)) {
    const auto some = as_points<Space>(message);
    all.insert(all.end(), some.begin(), some.end());
  }
  return all;
}

template <class Space>
void update_nearest(const DistributedPoints<Space>& points, const Points<Space>& new_centres,
                    size_t first_new, Nearest& nearest) {
  PointValues index = points.make_point_values(0), distance = points.make_point_values(0);
  parallel_for(index.size(), points.threads(), [&](size_t begin, size_t end) {
    assign_to_nearest<Space>(points.local().subspan(begin, end - begin), new_centres, &index[begin],
                             &distance[begin]);
    for (size_t i = begin; i < end; ++i) {
      if (distance[i] >= nearest.distance[i]) continue;
      nearest.distance[i] = distance[i];
      nearest.candidate[i] = static_cast<uint32_t>(first_new + index[i]);
    }
  });
}

template <class Space>
Points<Space> seed_kmeans_parallel(const DistributedPoints<Space>& points, const ClusterOptions& options) {
  constexpr int kRounds = 5;           // Bahmani et al. 2012, section 5: more do not help
  constexpr double kOversampling = 2;  // l = 2 k, ibid.
  Random random(options.seed);
  Points<Space> candidates = {any_point(points, random)};
  Nearest nearest{points.make_point_values(0), points.make_point_values(Space::kMaxDistance)};
  update_nearest(points, candidates, 0, nearest);
  const auto enough = static_cast<size_t>(options.clusters);
  for (int round = 0; round < kRounds || candidates.size() < enough; ++round) {
    const uint64_t sum = points.sum(nearest.distance);
    if (sum == 0) break;  // every point is already a candidate
    const double factor = kOversampling * options.clusters / static_cast<double>(sum);
    const auto new_centres = sample_candidates(points, nearest.distance, factor, random.next());
    update_nearest(points, new_centres, candidates.size(), nearest);
    candidates.insert(candidates.end(), new_centres.begin(), new_centres.end());
  }
  std::vector<uint64_t> weights(candidates.size(), 0);
  for (const uint32_t candidate : nearest.candidate) ++weights[candidate];
  points.communicator().sum(weights);
  ClusterOptions among_candidates = options;
  among_candidates.seed = random.next();
  const Communicator alone;  // every process has all candidates
  return seed_kmeans_plus_plus(DistributedPoints<Space>(candidates, among_candidates, alone, weights),
                               among_candidates);
}

}  // namespace

template <class Space>
Points<Space> seed_centres(const DistributedPoints<Space>& points, const ClusterOptions& options) {
  require(points.total() > 0 && options.clusters > 0, "clustering needs points and at least one cluster");
  require(points.total() <= std::numeric_limits<uint32_t>::max(),
          "clustering: more points than can be numbered");
  switch (options.seeding) {
    case Seeding::kRandom:
      return seed_random(points, options);
    case Seeding::kKmeansParallel:
      return seed_kmeans_parallel(points, options);
    default:
      return seed_kmeans_plus_plus(points, options);
  }
}

template Points<HammingSpace> seed_centres(const DistributedPoints<HammingSpace>&, const ClusterOptions&);
template Points<SiftSpace> seed_centres(const DistributedPoints<SiftSpace>&, const ClusterOptions&);
template Points<SurfSpace> seed_centres(const DistributedPoints<SurfSpace>&, const ClusterOptions&);

}  // namespace kinloop
