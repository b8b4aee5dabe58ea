#include "kinloop/place/match_by_nodes.hpp"

#include <algorithm>
#include <cstdint>

#include "kinloop/core/errors.hpp"
#include "kinloop/features/kernels/hamming_rows.hpp"

namespace kinloop {
namespace {

/// Indices of keypoints in ascending order of their nodes.
std::vector<uint32_t> sorted_by_node(std::span<const NodeId> nodes) {
  std::vector<uint64_t> keys(nodes.size());
  for (size_t i = 0; i < keys.size(); ++i) keys[i] = uint64_t{nodes[i].value} << 32U | i;
  std::sort(keys.begin(), keys.end());
  std::vector<uint32_t> order;
  order.reserve(keys.size());
  for (const uint64_t key : keys) order.push_back(static_cast<uint32_t>(key));
  return order;
}

/// The nearest and second-nearest keypoint of the other image.
struct NearestTwo {
  uint32_t index = 0;
  int distance = kInvalidDistance, second = kInvalidDistance;

  void offer(uint32_t candidate, int candidate_distance) {
    if (candidate_distance < distance) {
      second = distance;
      distance = candidate_distance;
      index = candidate;
    } else {
      second = std::min(second, candidate_distance);
    }
  }
};

using Indices = std::span<const uint32_t>;

/// Calls `work` with the keypoints of both images under each common node.
template <class Work>
void for_each_common_node(const IndexedDescriptors& a, const IndexedDescriptors& b, const Work& work) {
  const auto in_a = sorted_by_node(a.nodes), in_b = sorted_by_node(b.nodes);
  const auto end_of_node = [](const std::vector<uint32_t>& order, std::span<const NodeId> nodes,
                              size_t begin) {
    size_t end = begin;
    while (end < order.size() && nodes[order[end]] == nodes[order[begin]]) ++end;
    return end;
  };
  for (size_t i = 0, j = 0; i < in_a.size() && j < in_b.size();) {
    const NodeId node_a = a.nodes[in_a[i]], node_b = b.nodes[in_b[j]];
    const size_t end_a = end_of_node(in_a, a.nodes, i), end_b = end_of_node(in_b, b.nodes, j);
    if (node_a == node_b) work(Indices(in_a).subspan(i, end_a - i), Indices(in_b).subspan(j, end_b - j));
    if (node_a <= node_b) i = end_a;
    if (node_b <= node_a) j = end_b;
  }
}

}  // namespace

std::vector<Match> match_by_nodes(const IndexedDescriptors& a, const IndexedDescriptors& b,
                                  const NodeMatchOptions& options) {
  require(a.nodes.size() == static_cast<size_t>(a.descriptors.rows) &&
              b.nodes.size() == static_cast<size_t>(b.descriptors.rows),
          "match_by_nodes: expected one node per descriptor");
  std::vector<NearestTwo> of_a(a.nodes.size()), of_b(b.nodes.size());
  std::vector<uint16_t> distances;
  for_each_common_node(a, b, [&](Indices in_a, Indices in_b) {
    distances.resize(in_b.size());
    for (const uint32_t i : in_a) {
      hamming_to_rows(a.descriptors.ptr<uint8_t>(static_cast<int>(i)), b.descriptors.ptr<uint8_t>(), in_b,
                      distances.data());
      for (size_t k = 0; k < in_b.size(); ++k) {
        of_a[i].offer(in_b[k], distances[k]);
        of_b[in_b[k]].offer(i, distances[k]);
      }
    }
  });
  std::vector<Match> matches;
  for (uint32_t i = 0; i < of_a.size(); ++i) {
    const NearestTwo& nearest = of_a[i];
    if (nearest.distance > options.max_distance || of_b[nearest.index].index != i) continue;
    const int second = std::min(nearest.second, of_b[nearest.index].second);
    if (nearest.distance < options.max_ratio * second)
      matches.push_back({i, nearest.index, nearest.distance});
  }
  return matches;
}

}  // namespace kinloop
