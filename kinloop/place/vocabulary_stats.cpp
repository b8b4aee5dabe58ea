#include "kinloop/place/vocabulary_stats.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace kinloop {
namespace {

std::vector<LevelStats> levels_of(const VocabularyTree& tree) {
  std::vector<LevelStats> levels;
  size_t begin = 0, end = 1;
  while (begin < end) {
    LevelStats level{end - begin, 0};
    size_t children = 0;
    for (size_t node = begin; node < end; ++node) {
      children += tree.child_counts[node];
      if (tree.child_counts[node] == 0) ++level.words;
    }
    levels.push_back(level);
    begin = end;
    end += children;
  }
  return levels;
}

double entropy_bits(const std::vector<uint32_t>& uses, uint64_t sum) {
  double entropy = 0;
  for (const uint32_t count : uses) {
    const double p = static_cast<double>(count) / static_cast<double>(sum);
    if (p > 0) entropy -= p * std::log2(p);
  }
  return entropy;
}

}  // namespace

VocabularyStats vocabulary_stats(const Vocabulary& vocabulary) {
  const VocabularyTree& tree = vocabulary.tree();
  VocabularyStats stats;
  stats.levels = levels_of(tree);
  stats.descriptors = std::accumulate(tree.uses.begin(), tree.uses.end(), uint64_t{0});
  stats.entropy_bits = entropy_bits(tree.uses, stats.descriptors);
  stats.balance =
      tree.uses.size() < 2 ? 1 : stats.entropy_bits / std::log2(static_cast<double>(tree.uses.size()));
  stats.most_uses = *std::max_element(tree.uses.begin(), tree.uses.end());
  auto idf = tree.idf;
  std::sort(idf.begin(), idf.end());
  stats.idf_min = idf.front();
  stats.idf_median = idf[idf.size() / 2];
  stats.idf_max = idf.back();
  return stats;
}

double quantization_error(const Vocabulary& vocabulary, std::span<const cv::Mat> descriptors_of_images) {
  uint64_t distance = 0, count = 0;
  for (const cv::Mat& descriptors : descriptors_of_images) {
    const auto words = vocabulary.words_of(descriptors).words;
    for (size_t i = 0; i < words.size(); ++i) {
      const auto centre = vocabulary.centre_of(words[i]);
      distance +=
          static_cast<uint64_t>(hamming_distance(descriptors.ptr(static_cast<int>(i)), centre.data()));
    }
    count += words.size();
  }
  return count == 0 ? 0 : static_cast<double>(distance) / static_cast<double>(count);
}

}  // namespace kinloop
