#pragma once
// In: a vocabulary. Out: its statistics and quality measures.

#include <cstddef>
#include <span>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "kinloop/place/vocabulary/vocabulary.hpp"

namespace kinloop {

/// One level of the tree; the root is level 0.
struct LevelStats {
  size_t nodes = 0;
  size_t words = 0;  ///< leaves on this level
};

struct VocabularyStats {
  std::vector<LevelStats> levels;
  double entropy_bits = 0;     ///< of the words' use counts in training: the information of one word
  double balance = 0;          ///< entropy over log2(words): 1 = all words used equally often
  uint64_t descriptors = 0;    ///< number of training descriptors
  uint32_t max_use_count = 0;  ///< of a single word
  float idf_min = 0, idf_median = 0, idf_max = 0;
};

VocabularyStats vocabulary_stats(const Vocabulary& vocabulary);

/// Returns the mean distance (bits, or squared steps) of descriptors to the centres of their words; 0 without
/// descriptors.
double quantization_error(const Vocabulary& vocabulary, std::span<const cv::Mat> descriptors_of_images);

}  // namespace kinloop
