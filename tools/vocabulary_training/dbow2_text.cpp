#include "tools/vocabulary_training/dbow2_text.hpp"

#include <algorithm>
#include <charconv>
#include <fstream>
#include <numeric>

#include <fmt/format.h>

#include "kinloop/core/errors.hpp"
#include "kinloop/core/files/text_file.hpp"
#include "kinloop/features/hamming.hpp"

namespace kinloop {
namespace {

constexpr int kL1Norm = 0, kTfIdf = 0;  ///< the scoring and weighting that kinloop supports

/// Parses the numbers of one line.
class LineReader {
 public:
  LineReader(const std::string& line, const std::filesystem::path& path, size_t number)
      : at_(line.data()), end_(line.data() + line.size()), path_(path), number_(number) {}

  template <class T>
  T next(T low, T high, const char* what) {
    while (at_ != end_ && (*at_ == ' ' || *at_ == '\t')) ++at_;
    T value{};
    const auto [after, error] = std::from_chars(at_, end_, value);
    if (error != std::errc() || !(value >= low && value <= high)) {
      throw_parse_error(path_, number_, fmt::format("expected {} from {} to {}", what, low, high));
    }
    at_ = after;
    return value;
  }

 private:
  const char* at_;
  const char* end_;
  const std::filesystem::path& path_;
  size_t number_;
};

/// Nodes in the order of lines; node 0 is the root.
struct TextNodes {
  std::vector<uint32_t> parents;
  std::vector<bool> is_word;
  std::vector<uint8_t> centres;
  std::vector<float> weights;
};

void read_node(LineReader& line, TextNodes& nodes) {
  const auto newest = static_cast<uint32_t>(nodes.parents.size() - 1);
  nodes.parents.push_back(line.next<uint32_t>(0, newest, "the number of a parent that came before,"));
  nodes.is_word.push_back(line.next(0, 1, "whether the node is a word,") == 1);
  for (int i = 0; i < kOrbBytes; ++i) {
    nodes.centres.push_back(static_cast<uint8_t>(line.next(0, 255, "a byte of the descriptor,")));
  }
  nodes.weights.push_back(line.next(0.0F, 1e6F, "a weight"));
}

/// The nodes of the file in breadth-first order, children in the order of lines.
std::vector<uint32_t> breadth_first(const std::vector<uint32_t>& parents,
                                    const std::vector<uint32_t>& child_counts) {
  std::vector<uint32_t> slot(parents.size());
  std::exclusive_scan(child_counts.begin(), child_counts.end(), slot.begin(), 0U);
  std::vector<uint32_t> children(parents.size() - 1);
  for (uint32_t node = 1; node < parents.size(); ++node) children[slot[parents[node]]++] = node;
  std::vector<uint32_t> order = {0};
  for (size_t i = 0; i < order.size(); ++i) {
    const uint32_t end = slot[order[i]], begin = end - child_counts[order[i]];
    order.insert(order.end(), children.begin() + begin, children.begin() + end);
  }
  return order;
}

VocabularyTree to_tree(const TextNodes& nodes, VocabularyTree tree) {
  std::vector<uint32_t> child_counts(nodes.parents.size(), 0);
  for (uint32_t node = 1; node < nodes.parents.size(); ++node) ++child_counts[nodes.parents[node]];
  for (const uint32_t node : breadth_first(nodes.parents, child_counts)) {
    tree.child_counts.push_back(child_counts[node]);
    const auto centre = nodes.centres.begin() + static_cast<ptrdiff_t>(node) * kOrbBytes;
    tree.centres.insert(tree.centres.end(), centre, centre + kOrbBytes);
    if (child_counts[node] == 0) tree.idf.push_back(nodes.weights[node]);
  }
  tree.use_counts.resize(tree.idf.size(), 0);
  return tree;
}

}  // namespace

Vocabulary read_dbow2(const std::filesystem::path& path) {
  std::ifstream file(path);
  std::string text;
  if (!std::getline(file, text)) {
    throw InputError(fmt::format("{}: cannot be read, or is empty", path.string()));
  }
  LineReader first(text, path, 1);
  constexpr int kMaxChildren = 1'000'000, kMaxLevels = 20;
  VocabularyTree tree;
  tree.branching = first.next(2, kMaxChildren, "'branching depth scoring weighting', branching");
  tree.depth = first.next(1, kMaxLevels, "the depth");
  first.next(kL1Norm, kL1Norm, "L1 scoring,");
  first.next(kTfIdf, kTfIdf, "TF-IDF weighting,");

  TextNodes nodes{{0}, {false}, std::vector<uint8_t>(kOrbBytes, 0), {0}};
  std::vector<bool> has_children = {false};
  for (size_t number = 2; std::getline(file, text); ++number) {
    if (text.find_first_not_of(" \t\r") == std::string::npos) continue;
    LineReader line(text, path, number);
    read_node(line, nodes);
    has_children.push_back(false);
    has_children[nodes.parents.back()] = true;
  }
  for (size_t node = 0; node < has_children.size(); ++node) {
    if (nodes.is_word[node] != has_children[node]) continue;
    throw InputError(
        fmt::format("{}: node {} is {}; is the file complete?", path.string(), node,
                    has_children[node] ? "a word with children" : "no word and has no children"));
  }
  tree = to_tree(nodes, std::move(tree));
  if (const auto defect = find_defect(view_of(tree))) {
    throw InputError(fmt::format("{}: {} is invalid", path.string(), *defect));
  }
  return Vocabulary(std::move(tree));
}

void write_dbow2(const std::filesystem::path& path, const Vocabulary& vocabulary) {
  const VocabularyView& tree = vocabulary.tree();
  if (vocabulary.descriptors().metric != Metric::kHamming) {
    throw InputError(fmt::format("{}: the text format requires words of 256 bits, not of {}", path.string(),
                                 vocabulary.descriptors().name));
  }
  AtomicFile file(path);
  file.stream() << fmt::format("{} {} {} {}\n", tree.branching, tree.depth, kL1Norm, kTfIdf);
  size_t node = 1, word = 0;
  // Breadth first: the children of each node follow those of the preceding nodes.
  for (size_t parent = 0; parent < tree.child_counts.size(); ++parent) {
    for (uint32_t child = 0; child < tree.child_counts[parent]; ++child, ++node) {
      const bool is_word = tree.child_counts[node] == 0;
      const auto centre = tree.centres.subspan(node * kOrbBytes, kOrbBytes);
      file.stream() << fmt::format("{} {:d} {} {}\n", parent, is_word, fmt::join(centre, " "),
                                   is_word ? tree.idf[word++] : 0.0F);
    }
  }
  file.commit();
}

}  // namespace kinloop
