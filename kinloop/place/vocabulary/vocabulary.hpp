#pragma once
// In: the descriptors of an image. Out: its visual words, found by descending a tree of cluster centres
// (Nister and Stewenius 2006; for binary descriptors Galvez-Lopez and Tardos 2012), and its bag of words.

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "kinloop/core/ids.hpp"
#include "kinloop/place/bow_vector.hpp"
#include "kinloop/place/vocabulary/descriptor_kind.hpp"

namespace kinloop {

/// A node of the vocabulary tree; the root is 0.
using NodeId = Id<struct VocabularyNodeTag>;

/// Parameters of a vocabulary.
struct VocabularyShape {
  DescriptorKind kind = DescriptorKind::kOrb;
  int branching = 0;    ///< maximum number of children per node
  int depth = 0;        ///< maximum levels below the root; 1 = a flat vocabulary
  uint32_t images = 0;  ///< number of training images for `idf`; 0 = unknown (an imported vocabulary)
};

/// The content of a vocabulary: flat arrays with nodes in breadth-first order (children are contiguous) and
/// words (the leaves) in node order. `Array` owns the data or is a view of a file.
template <template <class> class Array>
struct VocabularyArrays : VocabularyShape {
  Array<uint32_t> child_counts;  ///< per node; 0 = a leaf
  Array<uint8_t> centres;        ///< per node, one descriptor each; the root's is unused
  Array<float> idf;              ///< per word: ln(images / images with the word), Sivic and Zisserman 2003
  Array<uint32_t> use_counts;    ///< per word: number of training descriptors
};

template <class T>
using OwnedArray = std::vector<T>;
template <class T>
using ArrayView = std::span<const T>;

using VocabularyTree = VocabularyArrays<OwnedArray>;
using VocabularyView = VocabularyArrays<ArrayView>;

/// Returns a view of the arrays of `tree`.
VocabularyView view_of(const VocabularyTree& tree);

/// Returns what makes `tree` unusable, or nullopt if it is valid.
std::optional<std::string> find_defect(const VocabularyView& tree);

/// Per descriptor its word and, for guided matching (direct index), an inner node above it: similar
/// descriptors of two images share the node even if noise assigns them different words.
struct QuantizedFeatures {
  std::vector<WordId> words;
  std::vector<NodeId> nodes;
};

/// An immutable vocabulary of visual words. Copies share the arrays.
class Vocabulary {
 public:
  /// `find_defect(view_of(tree))` must be nullopt.
  explicit Vocabulary(VocabularyTree tree);

  /// Refers to arrays kept alive by `owner` (a mapped file) or with static lifetime. `find_defect(view)` must
  /// be nullopt.
  Vocabulary(const VocabularyView& view, std::shared_ptr<const void> owner);

  /// Assigns each row a word by greedy descent, ties to the first child; `nodes` are those `levels_up` levels
  /// above the deepest level, or the word's own node if its branch ends higher.
  [[nodiscard]] QuantizedFeatures quantize(const cv::Mat& descriptors,
                                           int levels_up = kDirectIndexLevels) const;

  /// Returns the TF-IDF weights of an image's words, normalised to sum 1; words present in every training
  /// image have no weight.
  [[nodiscard]] BowVector bow_of(std::span<const WordId> words) const;

  [[nodiscard]] size_t word_count() const { return tree_.idf.size(); }
  [[nodiscard]] const DescriptorTraits& descriptors() const { return descriptor_traits(tree_.kind); }
  [[nodiscard]] std::span<const uint8_t> centre_of(WordId word) const;
  [[nodiscard]] const VocabularyView& tree() const { return tree_; }

  /// For the 3 levels of the default vocabulary: 32 nodes share the descriptors of an image.
  static constexpr int kDirectIndexLevels = 2;

 private:
  std::shared_ptr<const void> owner_;
  VocabularyView tree_;
  std::vector<uint32_t> first_child_;  ///< per node
  std::vector<WordId> word_of_node_;   ///< invalid for inner nodes
  std::vector<uint32_t> node_of_word_;
};

}  // namespace kinloop
