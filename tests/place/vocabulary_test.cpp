#include "kinloop/place/vocabulary/vocabulary.hpp"

#include <numeric>

#include <gmock/gmock.h>

#include "kinloop/place/vocabulary/descriptor_space.hpp"
#include "tests/place/synthetic.hpp"
#include "tools/vocabulary_training/trainer.hpp"
#include "tools/vocabulary_training/vocabulary_stats.hpp"

namespace kinloop {
namespace {

using test::clustered_descriptors;
using test::clustered_images;
using test::to_mat;

TrainOptions small_tree() {
  TrainOptions options;
  options.branching = 5;
  options.depth = 3;
  return options;
}

const Vocabulary& small_vocabulary() {
  static const Vocabulary kVocabulary = train_vocabulary(clustered_images(20, 100, 200, 1), small_tree());
  return kVocabulary;
}

BinaryDescriptor centre(const VocabularyView& tree, uint32_t node) {
  return as_points<HammingSpace>(tree.centres)[node];
}

/// The nodes from the root to the leaf by definition: at each node the nearest child, by exhaustive
/// comparison.
std::vector<uint32_t> exhaustive_path(const VocabularyView& tree, const BinaryDescriptor& descriptor) {
  std::vector<uint32_t> path = {0};
  while (tree.child_counts[path.back()] > 0) {
    uint32_t first = 1;
    for (uint32_t node = 0; node < path.back(); ++node) first += tree.child_counts[node];
    uint32_t best = first;
    for (uint32_t child = first; child < first + tree.child_counts[path.back()]; ++child) {
      const auto to = [&](uint32_t node) { return test::distance(descriptor, centre(tree, node)); };
      if (to(child) < to(best)) best = child;
    }
    path.push_back(best);
  }
  return path;
}

uint32_t word_of_leaf(const VocabularyView& tree, uint32_t leaf) {
  return static_cast<uint32_t>(std::count(tree.child_counts.begin(), tree.child_counts.begin() + leaf, 0));
}

TEST(Vocabulary, DescentIsTheGreedySearch) {
  const VocabularyView& tree = small_vocabulary().tree();
  const auto points = clustered_descriptors(300, 300, 0.2, 2);
  for (const int levels_up : {0, 1, 2, 3, 9}) {
    const auto quantized = small_vocabulary().quantize(to_mat(points), levels_up);
    ASSERT_EQ(quantized.words.size(), points.size());
    ASSERT_EQ(quantized.nodes.size(), points.size());
    for (size_t i = 0; i < points.size(); ++i) {
      const auto path = exhaustive_path(tree, points[i]);
      EXPECT_EQ(quantized.words[i].value, word_of_leaf(tree, path.back()));
      EXPECT_THAT(small_vocabulary().centre_of(quantized.words[i]),
                  testing::ElementsAreArray(centre(tree, path.back())));
      const auto level = static_cast<size_t>(std::max(0, tree.depth - levels_up));
      EXPECT_EQ(quantized.nodes[i].value, path[std::min(level, path.size() - 1)]);
    }
  }
}

TEST(Vocabulary, TakesRowsOfALargerMatrix) {
  const cv::Mat all = to_mat(clustered_descriptors(40, 40, 0.2, 3));
  cv::Mat wide(all.rows, 2 * kOrbBytes, CV_8UC1, cv::Scalar(0));
  all.copyTo(wide.colRange(kOrbBytes, 2 * kOrbBytes));
  EXPECT_EQ(small_vocabulary().quantize(wide.colRange(kOrbBytes, 2 * kOrbBytes)).words,
            small_vocabulary().quantize(all).words);
}

TEST(Vocabulary, NoDescriptorsHaveNoWords) {
  EXPECT_TRUE(small_vocabulary().quantize(cv::Mat()).words.empty());
  EXPECT_TRUE(small_vocabulary().bow_of({}).empty());
}

TEST(Vocabulary, RejectsOtherDescriptorsAndWords) {
  EXPECT_THROW((void)small_vocabulary().quantize(cv::Mat(3, 128, CV_32FC1, cv::Scalar(0))), std::logic_error);
  EXPECT_THROW((void)small_vocabulary().quantize(cv::Mat(3, 61, CV_8UC1, cv::Scalar(0))), std::logic_error);
  const WordId foreign{static_cast<uint32_t>(small_vocabulary().word_count())};
  EXPECT_THROW((void)small_vocabulary().bow_of(std::vector{foreign}), std::logic_error);
  EXPECT_THROW((void)small_vocabulary().centre_of(foreign), std::logic_error);
}

BowVector bow_of_image(uint64_t seed) {
  return small_vocabulary().bow_of(
      small_vocabulary().quantize(to_mat(clustered_descriptors(100, 30, 0.1, seed))).words);
}

TEST(BowVector, WeighsByFrequencyAndRarity) {
  VocabularyTree tree;
  tree.branching = 4;
  tree.depth = 1;
  tree.images = 10;
  tree.child_counts = {4, 0, 0, 0, 0};
  tree.centres.resize(5 * kOrbBytes);
  tree.idf = {1.0F, 3.0F, 0.0F, 2.0F};
  tree.use_counts = {1, 1, 1, 1};
  const std::vector<WordId> words = {{1}, {0}, {2}, {0}, {2}, {1}, {0}};
  // Word 0 three times at 1, word 1 twice at 3, word 2 has no weight: 3 : 6.
  const BowVector bow = Vocabulary(tree).bow_of(words);
  ASSERT_EQ(bow.size(), 2U);
  EXPECT_EQ(bow[0].first, WordId{0});
  EXPECT_FLOAT_EQ(bow[0].second, 1.0F / 3);
  EXPECT_EQ(bow[1].first, WordId{1});
  EXPECT_FLOAT_EQ(bow[1].second, 2.0F / 3);
}

TEST(BowVector, IsSortedAndSumsToOne) {
  for (uint64_t seed = 1; seed < 10; ++seed) {
    const BowVector bow = bow_of_image(seed);
    ASSERT_FALSE(bow.empty());
    double sum = 0;
    for (size_t i = 0; i < bow.size(); ++i) {
      if (i > 0) {
        EXPECT_LT(bow[i - 1].first, bow[i].first);
      }
      EXPECT_GT(bow[i].second, 0);
      sum += bow[i].second;
    }
    EXPECT_NEAR(sum, 1, 1e-6);
  }
}

double similarity_by_definition(const BowVector& a, const BowVector& b) {
  std::vector<double> difference(small_vocabulary().word_count(), 0);
  for (const auto& [word, weight] : a) difference[word.value] += weight;
  for (const auto& [word, weight] : b) difference[word.value] -= weight;
  double sum = 0;
  for (const double value : difference) sum += std::abs(value);
  return 1 - 0.5 * sum;
}

TEST(Similarity, SimilarityIsSymmetricAndBounded) {
  for (uint64_t i = 1; i < 8; ++i) {
    const BowVector a = bow_of_image(i);
    EXPECT_NEAR(similarity(a, a), 1, 1e-6);
    EXPECT_EQ(similarity(a, {}), 0);
    for (uint64_t j = 1; j < i; ++j) {
      const BowVector b = bow_of_image(j);
      const double score = similarity(a, b);
      EXPECT_EQ(score, similarity(b, a));
      EXPECT_GE(score, 0);
      EXPECT_LT(score, 1);
      EXPECT_NEAR(score, similarity_by_definition(a, b), 1e-6);
    }
  }
  EXPECT_EQ(similarity({{WordId{1}, 1.0F}}, {{WordId{2}, 1.0F}}), 0);
}

TEST(VocabularyTree, EveryDefectIsFound) {
  const VocabularyView& view = small_vocabulary().tree();
  const auto copy = [](auto values) { return std::vector(values.begin(), values.end()); };
  const VocabularyTree sound{static_cast<const VocabularyShape&>(view), copy(view.child_counts),
                             copy(view.centres), copy(view.idf), copy(view.use_counts)};
  ASSERT_EQ(find_defect(view_of(sound)), std::nullopt);
  const auto defect_after = [&](auto&& damage) {
    VocabularyTree tree = sound;
    damage(tree);
    EXPECT_THROW(Vocabulary{tree}, std::logic_error);
    return find_defect(view_of(tree));
  };
  EXPECT_TRUE(defect_after([](auto& tree) { tree = {}; }));
  EXPECT_TRUE(defect_after([](auto& tree) { tree.centres.pop_back(); }));
  EXPECT_TRUE(defect_after([](auto& tree) { tree.idf.pop_back(); }));
  EXPECT_TRUE(defect_after([](auto& tree) { tree.use_counts.pop_back(); }));
  EXPECT_TRUE(defect_after([](auto& tree) { tree.idf[0] = -1; }));
  EXPECT_TRUE(defect_after([](auto& tree) { tree.idf[0] = std::numeric_limits<float>::quiet_NaN(); }));
  EXPECT_TRUE(defect_after([](auto& tree) { tree.branching = 4; }));
  EXPECT_TRUE(defect_after([](auto& tree) { tree.depth = 2; }));
  EXPECT_TRUE(defect_after([](auto& tree) { tree.child_counts[0] = 4; }));      // nodes without a parent
  EXPECT_TRUE(defect_after([](auto& tree) { tree.child_counts.back() = 5; }));  // nonexistent children
  EXPECT_TRUE(defect_after([](auto& tree) { tree.child_counts[0] = 0; }));
}

TEST(VocabularyStats, OfAKnownTree) {
  VocabularyTree tree;
  tree.branching = 2;
  tree.depth = 2;
  tree.images = 8;
  tree.child_counts = {2, 0, 2, 0, 0};
  tree.centres.resize(5 * kOrbBytes);
  tree.idf = {0.5F, 1.0F, 2.0F};
  tree.use_counts = {2, 1, 1};
  const VocabularyStats stats = vocabulary_stats(Vocabulary(tree));
  ASSERT_EQ(stats.levels.size(), 3U);
  EXPECT_EQ(stats.levels[1].nodes, 2U);
  EXPECT_EQ(stats.levels[1].words, 1U);
  EXPECT_EQ(stats.levels[2].nodes, 2U);
  EXPECT_EQ(stats.levels[2].words, 2U);
  EXPECT_EQ(stats.descriptors, 4U);
  EXPECT_DOUBLE_EQ(stats.entropy_bits, 1.5);  // 1/2 * 1 bit + 2 * 1/4 * 2 bits
  EXPECT_DOUBLE_EQ(stats.balance, 1.5 / std::log2(3.0));
  EXPECT_EQ(stats.max_use_count, 2U);
  EXPECT_EQ(stats.idf_min, 0.5F);
  EXPECT_EQ(stats.idf_median, 1.0F);
  EXPECT_EQ(stats.idf_max, 2.0F);
}

}  // namespace
}  // namespace kinloop
