#pragma once
// In: the descriptors of an image. Out: its visual words, found by going down a tree of cluster centres
// (Nister and Stewenius 2006; on binary descriptors Galvez-Lopez and Tardos 2012), and its bag of words.

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "kinloop/base/ids.hpp"
#include "kinloop/place/bow_vector.hpp"
#include "kinloop/place/descriptor_kind.hpp"

namespace kinloop {

/// A node of the vocabulary's tree; the root is 0.
using NodeId = Id<struct VocabularyNodeTag>;

/// What a vocabulary is, but for its arrays.
struct VocabularyShape {
  DescriptorKind kind = DescriptorKind::kOrb;
  int branching = 0;    ///< most children of a node
  int depth = 0;        ///< most levels below the root; 1 = a flat vocabulary
  uint32_t images = 0;  ///< training images behind `idf`; 0 = not known (an imported vocabulary)
};

/// The content of a vocabulary: flat arrays, nodes breadth first (so that the children of a node stand side
/// by side), words (the leaves) in the order of their nodes. `Array` owns them or looks at those of a file.
template <template <class> class Array>
struct VocabularyArrays : VocabularyShape {
  Array<uint32_t> child_counts;  ///< per node; 0 = a leaf
  Array<uint8_t> centres;        ///< per node, as many bytes as a descriptor has; the root's are not used
  Array<float> idf;              ///< per word: ln(images / images with the word), Sivic and Zisserman 2003
  Array<uint32_t> use_counts;    ///< per word: training descriptors that fell on it
};

template <class T>
using OwnedArray = std::vector<T>;
template <class T>
using ArrayView = std::span<const T>;

using VocabularyTree = VocabularyArrays<OwnedArray>;
using VocabularyView = VocabularyArrays<ArrayView>;

/// Looks at the arrays of `tree`.
VocabularyView view_of(const VocabularyTree& tree);

/// What makes `tree` unusable; nothing when it is sound.
std::optional<std::string> find_defect(const VocabularyView& tree);

/// Per descriptor its word and, for guided matching (direct index), an inner node above it: descriptors of
/// two images that look alike share the node even where noise puts them on different words.
struct QuantizedFeatures {
  std::vector<WordId> words;
  std::vector<NodeId> nodes;
};

/// A vocabulary of visual words; immutable. Copies share the arrays.
class Vocabulary {
 public:
  /// `find_defect(view_of(tree))` must be nothing.
  explicit Vocabulary(VocabularyTree tree);

  /// Looks at arrays that `owner` keeps (a mapped file), or that never go. `find_defect(view)` must be
  /// nothing.
  Vocabulary(const VocabularyView& view, std::shared_ptr<const void> owner);

  /// The word of each row by greedy descent, ties to the first child; `nodes` are those `levels_up` levels
  /// above the deepest level, or the word's own node where its branch ends higher.
  [[nodiscard]] QuantizedFeatures quantize(const cv::Mat& descriptors,
                                           int levels_up = kDirectIndexLevels) const;

  /// TF-IDF weights of an image's words, scaled to sum 1; words that every training image had weigh nothing.
  [[nodiscard]] BowVector bow_of(std::span<const WordId> words) const;

  [[nodiscard]] size_t word_count() const { return tree_.idf.size(); }
  [[nodiscard]] const DescriptorTraits& descriptors() const { return descriptor_traits(tree_.kind); }
  [[nodiscard]] std::span<const uint8_t> centre_of(WordId word) const;
  [[nodiscard]] const VocabularyView& tree() const { return tree_; }

  /// Of the default vocabulary's 3 levels: 32 nodes share the descriptors of an image.
  static constexpr int kDirectIndexLevels = 2;

 private:
  std::shared_ptr<const void> owner_;
  VocabularyView tree_;
  std::vector<uint32_t> first_child_;  ///< per node
  std::vector<WordId> word_of_node_;   ///< none for inner nodes
  std::vector<uint32_t> node_of_word_;
};

}  // namespace kinloop
