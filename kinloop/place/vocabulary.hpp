#pragma once
// In: the descriptors of an image. Out: its visual words, found by going down a tree of cluster centres
// (Nister and Stewenius 2006; on binary descriptors Galvez-Lopez and Tardos 2012), and its bag of words.

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "kinloop/base/ids.hpp"
#include "kinloop/place/binary_descriptor.hpp"
#include "kinloop/place/bow_vector.hpp"

namespace kinloop {

/// A node of the dictionary's tree; the root is 0.
using NodeId = Id<struct VocabularyNodeTag>;

/// The content of a dictionary: flat arrays, nodes breadth first (so that the children of a node stand side
/// by side), words (the leaves) in the order of their nodes.
struct VocabularyTree {
  int branching = 0;                      ///< most children of a node
  int depth = 0;                          ///< most levels below the root
  uint32_t images = 0;                    ///< training images behind `idf`
  std::vector<uint8_t> child_counts;      ///< per node; 0 = a leaf
  std::vector<BinaryDescriptor> centres;  ///< per node; the root's is not used
  std::vector<float> idf;      ///< per word: ln(images / images with the word), Sivic and Zisserman 2003
  std::vector<uint32_t> uses;  ///< per word: training descriptors that fell on it
};

/// What makes `tree` unusable; nothing when it is sound.
std::optional<std::string> defect_of(const VocabularyTree& tree);

/// Per descriptor its word and, for guided matching (direct index), an inner node above it: descriptors of
/// two images that look alike share the node even where noise puts them on different words.
struct QuantizedFeatures {
  std::vector<WordId> words;
  std::vector<NodeId> nodes;
};

/// A dictionary of visual words; immutable.
class Vocabulary {
 public:
  /// `defect_of(tree)` must be nothing.
  explicit Vocabulary(VocabularyTree tree);

  /// The word of each row (N x 32 bytes) by greedy descent, ties to the first child; `nodes` are those
  /// `levels_up` levels above the deepest level, or the word's own node where its branch ends higher.
  [[nodiscard]] QuantizedFeatures words_of(const cv::Mat& descriptors,
                                           int levels_up = kDirectIndexLevels) const;

  /// TF-IDF weights of an image's words, scaled to sum 1; words that every training image had weigh nothing.
  [[nodiscard]] BowVector bow_of(std::span<const WordId> words) const;

  [[nodiscard]] size_t word_count() const { return tree_.idf.size(); }
  [[nodiscard]] const BinaryDescriptor& centre_of(WordId word) const;
  [[nodiscard]] const VocabularyTree& tree() const { return tree_; }

  /// Of the default dictionary's 3 levels: 32 nodes share the descriptors of an image.
  static constexpr int kDirectIndexLevels = 2;

 private:
  VocabularyTree tree_;
  std::vector<uint32_t> first_child_;  ///< per node
  std::vector<WordId> word_of_node_;   ///< none for inner nodes
  std::vector<uint32_t> node_of_word_;
};

}  // namespace kinloop
