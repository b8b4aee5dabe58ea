#include "bench/place/image_words.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <numeric>

#include "kinloop/core/errors.hpp"
#include "kinloop/features/hamming.hpp"

namespace kinloop {
namespace {

constexpr size_t kSignatureBits = 64;

uint64_t signature_of(const uint8_t* descriptor, std::span<const uint8_t> centre, Metric metric) {
  uint64_t signature = 0;
  if (metric == Metric::kHamming) {
    std::memcpy(&signature, descriptor, sizeof signature);
    return signature;
  }
  for (size_t bit = 0; bit < kSignatureBits; ++bit) {
    const size_t component = bit * centre.size() / kSignatureBits;
    if (descriptor[component] > centre[component]) signature |= uint64_t{1} << bit;
  }
  return signature;
}

/// Predicts the position of `point` of image a in image b if `from` and `to` are the same point.
struct Similarity {
  Similarity(const QuantizedKeypoint& from, const QuantizedKeypoint& to) : from_(from.pixel), to_(to.pixel) {
    const float turn = to.angle_rad - from.angle_rad, scale = to.scale / from.scale;
    linear_ << std::cos(turn), -std::sin(turn), std::sin(turn), std::cos(turn);
    linear_ *= scale;
  }
  [[nodiscard]] Eigen::Vector2f operator()(const Eigen::Vector2f& point) const {
    return linear_ * (point - from_) + to_;
  }

 private:
  Eigen::Matrix2f linear_;
  Eigen::Vector2f from_, to_;
};

/// Indices sorted by node.
std::vector<uint32_t> by_node(std::span<const NodeId> nodes) {
  std::vector<uint32_t> order(nodes.size());
  std::iota(order.begin(), order.end(), 0U);
  std::stable_sort(order.begin(), order.end(), [&](uint32_t i, uint32_t j) { return nodes[i] < nodes[j]; });
  return order;
}

using Indices = std::span<const uint32_t>;

/// The first indices of `order` that share a node.
Indices first_node(Indices order, std::span<const NodeId> nodes) {
  size_t count = 0;
  while (count < order.size() && nodes[order[count]] == nodes[order[0]]) ++count;
  return order.first(count);
}

/// Adds pairs of rows that are mutual nearest neighbours.
KINLOOP_POPCOUNT_CLONES void match_mutually(const cv::Mat& a, Indices in_a, const cv::Mat& b, Indices in_b,
                                            std::vector<Match>& matches) {
  constexpr int kNone = 8 * kOrbBytes + 1;
  std::vector<Match> best_of_a(in_a.size(), {0, 0, kNone}), best_of_b(in_b.size(), {0, 0, kNone});
  for (size_t i = 0; i < in_a.size(); ++i) {
    for (size_t j = 0; j < in_b.size(); ++j) {
      const Match match{in_a[i], in_b[j],
                        hamming_distance(a.ptr(static_cast<int>(in_a[i])), b.ptr(static_cast<int>(in_b[j])))};
      if (match.distance < best_of_a[i].distance) best_of_a[i] = match;
      if (match.distance < best_of_b[j].distance) best_of_b[j] = match;
    }
  }
  for (const Match& match : best_of_a) {
    if (std::find(best_of_b.begin(), best_of_b.end(), match) != best_of_b.end()) matches.push_back(match);
  }
}

}  // namespace

ImageWords image_words(const Features& features, std::span<const WordId> words,
                       const Vocabulary& vocabulary) {
  require(words.size() == features.size(), "image_words: expected one word per keypoint");
  ImageWords points;
  points.reserve(words.size());
  for (size_t i = 0; i < words.size(); ++i) {
    const uint8_t* descriptor = features.descriptors.ptr(static_cast<int>(i));
    const auto signature =
        signature_of(descriptor, vocabulary.centre_of(words[i]), vocabulary.descriptors().metric);
    const auto scale = static_cast<float>(std::pow(features.scale_factor, features.levels[i]));
    points.push_back({words[i], signature, features.pixels[i], features.angles_rad[i], scale});
  }
  std::stable_sort(points.begin(), points.end(),
                   [](const QuantizedKeypoint& a, const QuantizedKeypoint& b) { return a.word < b.word; });
  return points;
}

std::vector<Match> match_words(const ImageWords& a, const ImageWords& b, int max_signature_distance) {
  std::vector<Match> matches;
  size_t begin = 0;  // the points of b with the word of a[i]
  for (size_t i = 0; i < a.size(); ++i) {
    while (begin < b.size() && b[begin].word < a[i].word) ++begin;
    Match best{static_cast<uint32_t>(i), 0, max_signature_distance + 1};
    for (size_t j = begin; j < b.size() && b[j].word == a[i].word; ++j) {
      const int distance = std::popcount(a[i].signature ^ b[j].signature);
      if (distance < best.distance) best = {best.a, static_cast<uint32_t>(j), distance};
    }
    if (best.distance <= max_signature_distance) matches.push_back(best);
  }
  return matches;
}

size_t geometric_support(const ImageWords& a, const ImageWords& b, std::span<const Match> matches,
                         double tolerance_px) {
  const auto limit = static_cast<float>(tolerance_px * tolerance_px);
  size_t most = 0;
  for (const Match& hypothesis : matches) {
    const Similarity b_of_a(a[hypothesis.a], b[hypothesis.b]);
    const auto agrees = [&](const Match& match) {
      return (b_of_a(a[match.a].pixel) - b[match.b].pixel).squaredNorm() <= limit;
    };
    most = std::max(most, static_cast<size_t>(std::count_if(matches.begin(), matches.end(), agrees)));
  }
  return most;
}

std::vector<Match> match_within_nodes(const cv::Mat& a, std::span<const NodeId> nodes_a, const cv::Mat& b,
                                      std::span<const NodeId> nodes_b) {
  const auto order_a = by_node(nodes_a), order_b = by_node(nodes_b);
  std::vector<Match> matches;
  for (Indices left_a = order_a, left_b = order_b; !left_a.empty() && !left_b.empty();) {
    const Indices in_a = first_node(left_a, nodes_a), in_b = first_node(left_b, nodes_b);
    const NodeId node_a = nodes_a[in_a[0]], node_b = nodes_b[in_b[0]];
    if (node_a == node_b) match_mutually(a, in_a, b, in_b, matches);
    if (node_a <= node_b) left_a = left_a.subspan(in_a.size());
    if (node_b <= node_a) left_b = left_b.subspan(in_b.size());
  }
  std::sort(matches.begin(), matches.end());
  return matches;
}

}  // namespace kinloop
