#pragma once
// The initial centres of k-means, in three ways:
// - random: distinct points, drawn uniformly;
// - k-means++ (Arthur and Vassilvitskii 2007): each next one with probability proportional to D^2, the
//   squared Euclidean distance to the nearest centre so far. On bits the squared Euclidean distance *is* the
//   Hamming distance, so that is the weight. Of several drawn, the best is kept (greedy);
// - k-means|| (Bahmani et al. 2012, "Scalable k-means++"): a few rounds, in each of which every point
//   independently becomes a candidate with probability l D^2 / sum D^2; then k-means++ among the candidates,
//   each weighted by the number of points nearest to it.

#include "tools/vocabulary_training/distributed_points.hpp"

namespace kinloop {

/// Returns at most `options.clusters` distinct points.
template <class Space>
std::vector<typename Space::Point> seed_centres(const DistributedPoints<Space>& points,
                                                const ClusterOptions& options);

}  // namespace kinloop
