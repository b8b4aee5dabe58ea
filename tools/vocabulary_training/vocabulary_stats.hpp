#pragma once
// In: a vocabulary. Out: the figures that tell what it is and how good it is.

#include <cstddef>
#include <span>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "kinloop/place/vocabulary.hpp"

namespace kinloop {

/// One level of the tree; the root is level 0.
struct LevelStats {
  size_t nodes = 0;
  size_t words = 0;  ///< nodes that end here
};

struct VocabularyStats {
  std::vector<LevelStats> levels;
  double entropy_bits = 0;     ///< of the words' uses in training: how much one word tells
  double balance = 0;          ///< entropy over log2(words): 1 = all words used equally often
  uint64_t descriptors = 0;    ///< trained on
  uint32_t max_use_count = 0;  ///< of one word
  float idf_min = 0, idf_median = 0, idf_max = 0;
};

VocabularyStats vocabulary_stats(const Vocabulary& vocabulary);

/// Mean distance (bits, or squared steps) of descriptors to the centres of their words; 0 without
/// descriptors.
double quantization_error(const Vocabulary& vocabulary, std::span<const cv::Mat> descriptors_of_images);

}  // namespace kinloop
