#include "tools/vocabulary_training/vocabulary_stats.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "kinloop/place/vocabulary/descriptor_space.hpp"

namespace kinloop {
namespace {

std::vector<LevelStats> levels_of(const VocabularyView& tree) {
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

double entropy_bits(std::span<const uint32_t> uses, uint64_t sum) {
  double entropy = 0;
  for (const uint32_t count : uses) {
    const double p = static_cast<double>(count) / static_cast<double>(sum);
    if (p > 0) entropy -= p * std::log2(p);
  }
  return entropy;
}

}  // namespace

VocabularyStats vocabulary_stats(const Vocabulary& vocabulary) {
  const VocabularyView& tree = vocabulary.tree();
  VocabularyStats stats;
  stats.levels = levels_of(tree);
  stats.descriptors = std::accumulate(tree.use_counts.begin(), tree.use_counts.end(), uint64_t{0});
  stats.entropy_bits = entropy_bits(tree.use_counts, stats.descriptors);
  stats.balance = tree.use_counts.size() < 2
                      ? 1
                      : stats.entropy_bits / std::log2(static_cast<double>(tree.use_counts.size()));
  stats.max_use_count = *std::max_element(tree.use_counts.begin(), tree.use_counts.end());
  std::vector<float> idf(tree.idf.begin(), tree.idf.end());
  std::sort(idf.begin(), idf.end());
  stats.idf_min = idf.front();
  stats.idf_median = idf[idf.size() / 2];
  stats.idf_max = idf.back();
  return stats;
}

double quantization_error(const Vocabulary& vocabulary, std::span<const cv::Mat> descriptors_of_images) {
  uint64_t sum = 0, count = 0;
  for (const cv::Mat& descriptors : descriptors_of_images) {
    const auto words = vocabulary.quantize(descriptors).words;
    dispatch_space(vocabulary.tree().kind, [&]<class Space>(Space) {
      for (size_t i = 0; i < words.size(); ++i) {
        const std::span row(descriptors.ptr(static_cast<int>(i)), vocabulary.descriptors().bytes);
        sum += Space::distance(as_points<Space>(row)[0], as_points<Space>(vocabulary.centre_of(words[i]))[0]);
      }
    });
    count += words.size();
  }
  return count == 0 ? 0 : static_cast<double>(sum) / static_cast<double>(count);
}

}  // namespace kinloop
