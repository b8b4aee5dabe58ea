#include "kinloop/place/trainer.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>

#include <fmt/format.h>

#include "kinloop/base/errors.hpp"
#include "kinloop/base/parallel_for.hpp"
#include "kinloop/base/random.hpp"
#include "kinloop/place/kmajority.hpp"

namespace kinloop {
namespace {

/// Descriptors sorted by node, and within a node by image.
struct TrainingPoints {
  std::vector<BinaryDescriptor> descriptors;
  std::vector<uint32_t> images;
};

/// The points of one node, of those of a level that are next to be split.
struct NodePoints {
  size_t begin = 0;
  size_t end = 0;
  [[nodiscard]] size_t size() const { return end - begin; }
};

/// A node with more points is clustered by all threads together, smaller ones side by side.
constexpr size_t kLargeNode = 20'000;

TrainingPoints gather(std::span<const cv::Mat> descriptors_of_images) {
  TrainingPoints points;
  for (uint32_t image = 0; image < descriptors_of_images.size(); ++image) {
    const auto rows = to_binary_descriptors(descriptors_of_images[image]);
    points.descriptors.insert(points.descriptors.end(), rows.begin(), rows.end());
    points.images.insert(points.images.end(), rows.size(), image);
  }
  return points;
}

uint32_t images_with_descriptors(std::span<const cv::Mat> descriptors_of_images) {
  return static_cast<uint32_t>(
      std::count_if(descriptors_of_images.begin(), descriptors_of_images.end(),
                    [](const cv::Mat& descriptors) { return descriptors.rows > 0; }));
}

void require_enough(size_t descriptors, uint32_t images, const TrainOptions& options) {
  const double words = std::pow(options.branching, options.depth);
  if (static_cast<double>(descriptors) < words) {
    throw InputError(fmt::format(
        "{} descriptors are too few for {}^{} = {:.0f} words; give more images, or a smaller -k or -L",
        descriptors, options.branching, options.depth, words));
  }
  if (images < 2) {
    throw InputError("one image cannot tell rare words from common ones; give more images");
  }
}

/// Grows the tree level by level.
class Grower {
 public:
  Grower(TrainingPoints points, uint32_t images, const TrainOptions& options, const Progress& progress)
      : points_(std::move(points)), options_(options), progress_(progress) {
    tree_.branching = options.branching;
    tree_.depth = options.depth;
    tree_.images = images;
    tree_.centres.emplace_back();  // the root
  }

  VocabularyTree grow() {
    std::vector<NodePoints> level = {{0, points_.descriptors.size()}};
    for (int depth = 0; !level.empty(); ++depth) {
      const auto clusters =
          depth < options_.depth ? cluster_level(level) : std::vector<Clusters>(level.size());
      std::vector<NodePoints> next;
      for (size_t i = 0; i < level.size(); ++i) {
        if (clusters[i].centres.size() > 1) {
          append_children(level[i], clusters[i], next);
        } else {
          append_word(level[i]);
        }
      }
      level = std::move(next);
    }
    return std::move(tree_);
  }

 private:
  /// Clusters the points of each node that is to be split; no centres for the others.
  std::vector<Clusters> cluster_level(const std::vector<NodePoints>& level) {
    std::vector<Clusters> clusters(level.size());
    for (size_t i = 0; i < level.size();) {
      size_t end = i + 1, points = level[i].size();
      while (end < level.size() && points + level[end].size() <= kLargeNode) points += level[end++].size();
      const bool alone = end == i + 1;
      parallel_for(end - i, options_.threads, [&](size_t first, size_t last) {
        for (size_t j = i + first; j < i + last; ++j) {
          clusters[j] = cluster_node(level[j], j, alone ? options_.threads : 1);
        }
      });
      done_ += points;
      stopped_ = stopped_ || !report(progress_, "training", done_, total());
      i = end;
    }
    return clusters;
  }

  [[nodiscard]] Clusters cluster_node(const NodePoints& node, size_t index_in_level, int threads) const {
    if (stopped_ || node.size() < static_cast<size_t>(options_.min_split)) return {};
    ClusterOptions options;
    options.clusters = options_.branching;
    options.seeding = options_.seeding == "random" ? Seeding::kRandom : Seeding::kKmeansPlusPlus;
    options.iterations = options_.iterations;
    options.candidates = options_.candidates;
    // Nodes before this level, and those before this one in it: the node's own number, whatever the threads.
    const uint64_t number = tree_.child_counts.size() + index_in_level;
    options.seed = hash(static_cast<uint64_t>(options_.seed), number);
    options.threads = threads;
    return cluster_binary(std::span(points_.descriptors).subspan(node.begin, node.size()), options);
  }

  /// Sorts the node's points by cluster, keeping the order of images.
  void append_children(const NodePoints& node, const Clusters& clusters, std::vector<NodePoints>& next) {
    std::vector<size_t> slot(clusters.centres.size() + 1, 0);
    for (const uint32_t cluster : clusters.cluster_of) ++slot[cluster + 1];
    for (size_t j = 1; j < slot.size(); ++j) slot[j] += slot[j - 1];
    for (size_t j = 0; j + 1 < slot.size(); ++j)
      next.push_back({node.begin + slot[j], node.begin + slot[j + 1]});

    TrainingPoints sorted{std::vector<BinaryDescriptor>(node.size()), std::vector<uint32_t>(node.size())};
    for (size_t i = 0; i < node.size(); ++i) {
      const size_t to = slot[clusters.cluster_of[i]]++;
      sorted.descriptors[to] = points_.descriptors[node.begin + i];
      sorted.images[to] = points_.images[node.begin + i];
    }
    const auto begin = static_cast<std::ptrdiff_t>(node.begin);
    std::copy(sorted.descriptors.begin(), sorted.descriptors.end(), points_.descriptors.begin() + begin);
    std::copy(sorted.images.begin(), sorted.images.end(), points_.images.begin() + begin);

    tree_.child_counts.push_back(static_cast<uint8_t>(clusters.centres.size()));
    tree_.centres.insert(tree_.centres.end(), clusters.centres.begin(), clusters.centres.end());
  }

  void append_word(const NodePoints& node) {
    uint32_t images = 0;
    for (size_t i = node.begin; i < node.end; ++i) {
      if (i == node.begin || points_.images[i] != points_.images[i - 1]) ++images;
    }
    tree_.child_counts.push_back(0);
    tree_.idf.push_back(static_cast<float>(std::log(static_cast<double>(tree_.images) / images)));
    tree_.uses.push_back(static_cast<uint32_t>(node.size()));
  }

  [[nodiscard]] size_t total() const {
    return points_.descriptors.size() * static_cast<size_t>(options_.depth);
  }

  TrainingPoints points_;
  const TrainOptions& options_;
  const Progress& progress_;
  VocabularyTree tree_;
  size_t done_ = 0;
  bool stopped_ = false;
};

}  // namespace

Vocabulary train_vocabulary(std::span<const cv::Mat> descriptors_of_images, const TrainOptions& options,
                            const Progress& progress) {
  auto points = gather(descriptors_of_images);
  const uint32_t images = images_with_descriptors(descriptors_of_images);
  require_enough(points.descriptors.size(), images, options);
  return Vocabulary(Grower(std::move(points), images, options, progress).grow());
}

}  // namespace kinloop
