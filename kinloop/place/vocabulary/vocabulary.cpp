#include "kinloop/place/vocabulary/vocabulary.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "kinloop/core/errors.hpp"
#include "kinloop/place/vocabulary/descriptor_space.hpp"

namespace kinloop {
namespace {

/// Nodes are in breadth-first order: a node's children follow those of the preceding nodes.
std::vector<uint32_t> first_children(std::span<const uint32_t> child_counts) {
  std::vector<uint32_t> first(child_counts.size());
  std::exclusive_scan(child_counts.begin(), child_counts.end(), first.begin(), uint32_t{1});
  return first;
}

/// Returns whether the child counts describe one tree that contains all nodes and has at most `depth` levels
/// below the root.
bool is_tree(std::span<const uint32_t> child_counts, int depth) {
  size_t level_begin = 0, level_end = 1;
  for (int level = 0; level <= depth; ++level) {
    if (level_end > child_counts.size()) return false;
    size_t children = 0;
    for (size_t node = level_begin; node < level_end; ++node) children += child_counts[node];
    if (children == 0) return level_end == child_counts.size();
    level_begin = level_end;
    level_end += children;
  }
  return false;
}

/// Where a descent ended.
struct LeafAndAncestor {
  uint32_t node;   ///< the leaf
  uint32_t above;  ///< ancestor at the requested level
};

/// The data used by greedy descent.
struct DescentTree {
  const uint32_t* child_counts;
  const uint32_t* first_child;
  int above_level;
};

template <class Space>
[[gnu::always_inline]] inline void descend(const DescentTree& tree,
                                           std::span<const typename Space::Point> centres,
                                           const cv::Mat& descriptors, LeafAndAncestor* found) {
  for (int row = 0; row < descriptors.rows; ++row) {
    const auto& descriptor = *reinterpret_cast<const typename Space::Point*>(descriptors.ptr(row));
    uint32_t node = 0, above = 0;
    for (int level = 1; tree.child_counts[node] > 0; ++level) {
      const uint32_t first = tree.first_child[node], end = first + tree.child_counts[node];
      uint32_t best = std::numeric_limits<uint32_t>::max();
      for (uint32_t child = first; child < end; ++child) {
        const uint32_t distance = Space::distance(descriptor, centres[child]);
        if (distance < best) {
          best = distance;
          node = child;
        }
      }
      if (level <= tree.above_level) above = node;
    }
    found[row] = {node, above};
  }
}

KINLOOP_POPCOUNT_CLONES void descend_bits(const DescentTree& tree, std::span<const BinaryDescriptor> centres,
                                          const cv::Mat& descriptors, LeafAndAncestor* found) {
  descend<HammingSpace>(tree, centres, descriptors, found);
}

}  // namespace

VocabularyView view_of(const VocabularyTree& tree) {
  return {static_cast<const VocabularyShape&>(tree), tree.child_counts, tree.centres, tree.idf,
          tree.use_counts};
}

std::optional<std::string> find_defect(const VocabularyView& tree) {
  const auto& counts = tree.child_counts;
  if (counts.empty() || counts.size() > std::numeric_limits<uint32_t>::max()) return "the number of nodes";
  if (tree.centres.size() != counts.size() * descriptor_traits(tree.kind).bytes)
    return "the number of centres";
  const bool too_wide = std::any_of(counts.begin(), counts.end(), [&](uint32_t count) {
    return count > static_cast<uint32_t>(tree.branching);
  });
  if (too_wide || !is_tree(counts, tree.depth)) return "the shape of the tree";
  const auto words = static_cast<size_t>(std::count(counts.begin(), counts.end(), 0));
  if (tree.idf.size() != words || tree.use_counts.size() != words) return "the number of words";
  const bool bad_weight =
      std::any_of(tree.idf.begin(), tree.idf.end(), [](float idf) { return !std::isfinite(idf) || idf < 0; });
  if (bad_weight) return "the weight of a word";
  return std::nullopt;
}

Vocabulary::Vocabulary(VocabularyTree tree)
    : Vocabulary([&] {
        auto owned = std::make_shared<const VocabularyTree>(std::move(tree));
        const VocabularyView view = view_of(*owned);
        return Vocabulary(view, std::move(owned));
      }()) {}

Vocabulary::Vocabulary(const VocabularyView& view, std::shared_ptr<const void> owner)
    : owner_(std::move(owner)), tree_(view) {
  require(!find_defect(tree_), "a vocabulary must be a valid tree");
  first_child_ = first_children(tree_.child_counts);
  word_of_node_.resize(tree_.child_counts.size());
  for (uint32_t node = 0; node < tree_.child_counts.size(); ++node) {
    if (tree_.child_counts[node] > 0) continue;
    word_of_node_[node] = {static_cast<uint32_t>(node_of_word_.size())};
    node_of_word_.push_back(node);
  }
}

QuantizedFeatures Vocabulary::quantize(const cv::Mat& descriptors, int levels_up) const {
  if (descriptors.empty()) return {};
  require(descriptors.type() == CV_8UC1 &&
              static_cast<size_t>(descriptors.cols) == descriptor_traits(tree_.kind).bytes,
          "the descriptors are not of the vocabulary's kind");
  std::vector<LeafAndAncestor> found(static_cast<size_t>(descriptors.rows));
  const DescentTree tree{tree_.child_counts.data(), first_child_.data(), tree_.depth - levels_up};
  dispatch_space(tree_.kind, [&]<class Space>(Space) {
    const auto centres = as_points<Space>(tree_.centres);
    if constexpr (std::is_same_v<Space, HammingSpace>) {
      descend_bits(tree, centres, descriptors, found.data());
    } else {
      descend<Space>(tree, centres, descriptors, found.data());
    }
  });
  QuantizedFeatures quantized;
  quantized.words.reserve(found.size());
  quantized.nodes.reserve(found.size());
  for (const auto& [leaf, above] : found) {
    quantized.words.push_back(word_of_node_[leaf]);
    quantized.nodes.push_back({above});
  }
  return quantized;
}

BowVector Vocabulary::bow_of(std::span<const WordId> words) const {
  std::vector<WordId> sorted(words.begin(), words.end());
  std::sort(sorted.begin(), sorted.end());
  require(sorted.empty() || sorted.back().value < word_count(), "bow_of: a word of another vocabulary");
  std::vector<std::pair<WordId, double>> weights;  // term frequency times idf
  double sum = 0;
  for (auto word = sorted.begin(); word != sorted.end();) {
    const auto next = std::upper_bound(word, sorted.end(), *word);
    const double weight = static_cast<double>(next - word) * tree_.idf[word->value];
    if (weight > 0) weights.emplace_back(*word, weight);
    sum += weight;
    word = next;
  }
  BowVector bow;
  bow.reserve(weights.size());
  for (const auto& [word, weight] : weights) bow.emplace_back(word, static_cast<float>(weight / sum));
  return bow;
}

std::span<const uint8_t> Vocabulary::centre_of(WordId word) const {
  require(word.value < word_count(), "centre_of: a word of another vocabulary");
  const size_t bytes = descriptors().bytes;
  return tree_.centres.subspan(node_of_word_[word.value] * bytes, bytes);
}

}  // namespace kinloop
