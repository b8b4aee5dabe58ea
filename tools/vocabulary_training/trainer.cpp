#include "tools/vocabulary_training/trainer.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include <fmt/format.h>

#include "kinloop/core/errors.hpp"
#include "kinloop/core/random.hpp"
#include "kinloop/core/threads/parallel_for.hpp"
#include "tools/vocabulary_training/clustering/clustering.hpp"
#include "tools/vocabulary_training/communicator.hpp"
#include "tools/vocabulary_training/tree_level.hpp"

namespace kinloop {
namespace {

/// Nodes with more points are clustered by all threads and processes together, smaller ones in parallel.
constexpr size_t kLargeNode = 20'000;

void require_enough(uint64_t descriptors, uint64_t images, const TrainOptions& options) {
  // Enough to split every node above the last level; with fewer the tree would not reach its depth.
  const double nodes = std::pow(options.branching, options.depth - 1);
  const double least = std::max<double>(options.branching, options.min_split * nodes);
  if (static_cast<double>(descriptors) < least) {
    throw InputError(
        fmt::format("{} descriptors are too few for a vocabulary of up to {}^{} words, which needs {:.0f}; "
                    "give more images, or a smaller -k or -L",
                    descriptors, options.branching, options.depth, least));
  }
  if (images < 2) {
    throw InputError("IDF weights require at least two images; give more images");
  }
}

/// The result of splitting a node: its children, or a word.
template <class Space>
struct Split {
  std::vector<typename Space::Point> centres;  ///< of its children; empty for a word
  std::vector<size_t> sizes;                   ///< number of local points of each child
  uint64_t uses = 0;                           ///< of a word: its descriptors ...
  uint64_t images = 0;                         ///< ... and their images

  [[nodiscard]] bool is_word() const { return centres.empty(); }
};

/// Grows the tree level by level.
template <class Space>
class TreeBuilder {
 public:
  TreeBuilder(TrainingSet set, uint32_t images, const TrainOptions& options, const Progress& progress,
              const Communicator& communicator)
      : set_(std::move(set)), options_(options), progress_(progress), communicator_(communicator) {
    tree_.kind = set_.kind;
    tree_.branching = options.branching;
    tree_.depth = options.depth;
    tree_.images = images;
    tree_.centres.resize(sizeof(Point));  // the root
  }

  VocabularyTree build_tree() {
    std::vector<TreeLevelNode> level = {{0, set_.size(), communicator_.all_reduce_sum(set_.size())}};
    total_ = level[0].size() * static_cast<size_t>(options_.depth);
    for (int depth = 0; !level.empty(); ++depth) {
      distribute_nodes(set_, level, kLargeNode, communicator_);
      const auto splits = share_splits(level, split_level(level, depth < options_.depth));
      level = append(level, splits);
    }
    return std::move(tree_);
  }

 private:
  using Point = typename Space::Point;
  using Splits = std::vector<Split<Space>>;

  /// Splits the shared nodes together with the other processes, then the nodes owned by this one.
  Splits split_level(const std::vector<TreeLevelNode>& level, bool deep_enough) {
    Splits splits(level.size());
    std::vector<size_t> own;
    for (size_t i = 0; i < level.size(); ++i) {
      if (level[i].owner == communicator_.rank()) own.push_back(i);
      if (!level[i].shared()) continue;
      stopped_ = communicator_.all_reduce_sum(stopped_ ? 1 : 0) > 0;
      splits[i] = split_node(level[i], i, deep_enough, options_.threads, communicator_);
      if (deep_enough) report_progress(level[i].size());
    }
    for (size_t begin = 0; begin < own.size();) {
      size_t end = begin, points = 0;
      while (end < own.size() && (end == begin || points + level[own[end]].size() <= kLargeNode)) {
        points += level[own[end++]].size();
      }
      parallel_for(end - begin, options_.threads, [&](size_t first, size_t last) {
        for (size_t j = begin + first; j < begin + last; ++j) {
          splits[own[j]] = split_node(level[own[j]], own[j], deep_enough, 1, Communicator());
        }
      });
      if (deep_enough) report_progress(points);
      begin = end;
    }
    return splits;
  }

  void report_progress(size_t points) {
    done_ += points;
    stopped_ = !report(progress_, "training", done_, total_) || stopped_;
  }

  Split<Space> split_node(const TreeLevelNode& node, size_t index_in_level, bool deep_enough, int threads,
                          const Communicator& communicator) {
    if (deep_enough && !stopped_ && node.total >= static_cast<uint64_t>(options_.min_split)) {
      ClusterOptions options;
      options.clusters = options_.branching;
      options.seeding = options_.seeding;
      options.iterations = options_.iterations;
      options.candidates = options_.candidates;
      // Nodes in previous levels and earlier in this one: the node's number, whichever process splits it.
      options.seed = hash(static_cast<uint64_t>(options_.seed), tree_.child_counts.size() + index_in_level);
      options.threads = threads;
      if (node.size() > kLargeNode) options.memory = set_.memory();
      auto clusters = cluster<Space>(points_of(node), options, communicator);
      if (clusters.centres.size() > 1) {
        auto sizes = sort_points(node, clusters);
        return {std::move(clusters.centres), std::move(sizes)};
      }
    }
    Split<Space> word;
    word.uses = node.total;
    word.images = communicator.all_reduce_sum(images_of(node));
    return word;
  }

  [[nodiscard]] std::span<const Point> points_of(const TreeLevelNode& node) const {
    return as_points<Space>(set_.rows).subspan(node.begin, node.size());
  }

  [[nodiscard]] uint64_t images_of(const TreeLevelNode& node) const {
    uint64_t images = 0;
    for (size_t i = node.begin; i < node.end; ++i) {
      if (i == node.begin || set_.image_of[i] != set_.image_of[i - 1]) ++images;
    }
    return images;
  }

  /// Sorts the node's points by cluster, keeping the order of images; returns the size of each cluster.
  std::vector<size_t> sort_points(const TreeLevelNode& node, const Clusters<Space>& clusters) {
    std::vector<size_t> sizes(clusters.centres.size(), 0);
    for (const uint32_t cluster : clusters.cluster_of) ++sizes[cluster];
    std::vector<size_t> slot(sizes.size());
    std::exclusive_scan(sizes.begin(), sizes.end(), slot.begin(), size_t{0});

    auto* memory = clusters.cluster_of.get_allocator().resource();
    std::pmr::vector<Point> points(node.size(), memory);
    std::pmr::vector<uint32_t> image_of(node.size(), memory);
    const auto unsorted = points_of(node);
    for (size_t i = 0; i < node.size(); ++i) {
      const size_t to = slot[clusters.cluster_of[i]]++;
      points[to] = unsorted[i];
      image_of[to] = set_.image_of[node.begin + i];
    }
    std::memcpy(set_.rows.data() + node.begin * sizeof(Point), points.data(), points.size() * sizeof(Point));
    std::copy(image_of.begin(), image_of.end(), set_.image_of.begin() + static_cast<ptrdiff_t>(node.begin));
    return sizes;
  }

  /// Shares the results of all nodes with all processes; a process has no points of nodes that it does not
  /// own.
  [[nodiscard]] Splits share_splits(const std::vector<TreeLevelNode>& level, Splits splits) const {
    if (communicator_.size() == 1) return splits;
    Message own;
    for (size_t i = 0; i < level.size(); ++i) {
      if (level[i].owner != communicator_.rank()) continue;
      put(own, uint64_t{splits[i].centres.size()});
      put(own, std::span<const Point>(splits[i].centres));
      put(own, splits[i].uses);
      put(own, splits[i].images);
    }
    const auto messages = communicator_.gather(own);
    std::vector<MessageReader> readers(messages.begin(), messages.end());
    for (size_t i = 0; i < level.size(); ++i) {
      if (level[i].shared()) continue;
      MessageReader& reader = readers[static_cast<size_t>(level[i].owner)];
      splits[i].centres = reader.read<Point>(reader.read<uint64_t>());
      splits[i].sizes.resize(splits[i].centres.size(), 0);
      splits[i].uses = reader.read<uint64_t>();
      splits[i].images = reader.read<uint64_t>();
    }
    return splits;
  }

  /// Adds the nodes of the level to the tree; returns the next level.
  std::vector<TreeLevelNode> append(const std::vector<TreeLevelNode>& level, const Splits& splits) {
    std::vector<TreeLevelNode> next;
    for (size_t i = 0; i < level.size(); ++i) {
      const Split<Space>& split = splits[i];
      tree_.child_counts.push_back(static_cast<uint32_t>(split.centres.size()));
      if (split.is_word()) {
        const double rarity = static_cast<double>(tree_.images) / static_cast<double>(split.images);
        tree_.idf.push_back(static_cast<float>(std::log(rarity)));
        tree_.use_counts.push_back(static_cast<uint32_t>(split.uses));
      }
      for (const Point& centre : split.centres) {
        tree_.centres.insert(tree_.centres.end(), centre.begin(), centre.end());
      }
      std::vector<uint64_t> totals(split.sizes.begin(), split.sizes.end());
      if (level[i].shared()) communicator_.sum(totals);
      size_t begin = level[i].begin;
      for (size_t j = 0; j < split.sizes.size(); ++j) {
        next.push_back({begin, begin + split.sizes[j], totals[j], level[i].owner});
        begin = next.back().end;
      }
    }
    return next;
  }

  TrainingSet set_;
  const TrainOptions& options_;
  const Progress& progress_;
  const Communicator& communicator_;
  VocabularyTree tree_;
  size_t done_ = 0;
  size_t total_ = 0;
  bool stopped_ = false;
};

}  // namespace

Vocabulary train_vocabulary(TrainingSet set, const TrainOptions& options, const Progress& progress,
                            const Communicator& communicator) {
  validate(options);
  const auto images_of_ranks = communicator.all_gather(set.images);
  const auto mine = images_of_ranks.begin() + communicator.rank();
  const auto first_image = std::accumulate(images_of_ranks.begin(), mine, uint64_t{0});
  for (uint32_t& image : set.image_of) image += static_cast<uint32_t>(first_image);
  const auto images = std::accumulate(mine, images_of_ranks.end(), first_image);
  require_enough(communicator.all_reduce_sum(set.size()), images, options);
  return dispatch_space(set.kind, [&]<class Space>(Space) {
    return Vocabulary(
        TreeBuilder<Space>(std::move(set), static_cast<uint32_t>(images), options, progress, communicator)
            .build_tree());
  });
}

Vocabulary train_vocabulary(std::span<const cv::Mat> descriptors_of_images, const TrainOptions& options,
                            const Progress& progress) {
  return train_vocabulary(to_training_set(descriptors_of_images), options, progress);
}

}  // namespace kinloop
