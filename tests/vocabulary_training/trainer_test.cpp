#include "tools/vocabulary_training/trainer.hpp"

#include <cmath>
#include <set>

#include <gmock/gmock.h>

#include "kinloop/place/vocabulary/vocabulary_file.hpp"
#include "tests/place/synthetic.hpp"
#include "tests/support/expect_error.hpp"
#include "tools/vocabulary_training/vocabulary_stats.hpp"

namespace kinloop {
namespace {

using test::clustered_images;
using testing::HasSubstr;

TrainOptions tree_of(int branching, int depth) {
  TrainOptions options;
  options.branching = branching;
  options.depth = depth;
  return options;
}

TEST(Trainer, SameBytesWhateverTheNumberOfThreads) {
  // More than one large node (clustered by all threads together) and many small ones.
  const auto images = clustered_images(45, 1000, 400, 1);
  auto options = tree_of(4, 4);
  options.iterations = 4;
  const std::string one = serialize_vocabulary(train_vocabulary(images, options));
  for (const int threads : {2, 5}) {
    options.threads = threads;
    EXPECT_EQ(serialize_vocabulary(train_vocabulary(images, options)), one) << threads << " threads";
  }
}

TEST(Trainer, SeedAndSeedingChangeTheTree) {
  const auto images = clustered_images(10, 100, 50, 2);
  auto options = tree_of(4, 2);
  const std::string first = serialize_vocabulary(train_vocabulary(images, options));
  EXPECT_EQ(serialize_vocabulary(train_vocabulary(images, options)), first);
  options.seed = 2;
  EXPECT_NE(serialize_vocabulary(train_vocabulary(images, options)), first);
  options.seed = 1;
  options.seeding = Seeding::kRandom;
  EXPECT_NE(serialize_vocabulary(train_vocabulary(images, options)), first);
}

TEST(Trainer, UsesAndIdfAreThoseOfTheTrainingImages) {
  const auto images = clustered_images(12, 150, 80, 3);
  const Vocabulary vocabulary = train_vocabulary(images, tree_of(5, 3));
  ASSERT_GT(vocabulary.word_count(), 25U);
  std::vector<uint32_t> uses(vocabulary.word_count(), 0);
  std::vector<std::set<size_t>> images_with(vocabulary.word_count());
  for (size_t image = 0; image < images.size(); ++image) {
    for (const WordId word : vocabulary.quantize(images[image]).words) {
      ++uses[word.value];
      images_with[word.value].insert(image);
    }
  }
  EXPECT_EQ(vocabulary.tree().images, images.size());
  EXPECT_THAT(vocabulary.tree().use_counts, testing::ElementsAreArray(uses));
  for (size_t word = 0; word < uses.size(); ++word) {
    ASSERT_FALSE(images_with[word].empty());
    EXPECT_FLOAT_EQ(vocabulary.tree().idf[word],
                    static_cast<float>(std::log(12.0 / static_cast<double>(images_with[word].size()))));
  }
}

TEST(Trainer, FindsTheClustersOfTheData) {
  // 25 well separated clusters, 25 words: every word is one of them, with its noise of 8 % averaged out.
  const auto images = clustered_images(20, 200, 25, 4);
  const Vocabulary flat = train_vocabulary(images, tree_of(25, 1));
  EXPECT_EQ(flat.word_count(), 25U);
  EXPECT_NEAR(quantization_error(flat, images), 0.08 * 256, 1.0);
}

TEST(Trainer, ImagesWithoutDescriptorsDoNotCount) {
  auto images = clustered_images(6, 50, 20, 5);
  const Vocabulary without = train_vocabulary(images, tree_of(3, 2));
  images.insert(images.begin(), cv::Mat());
  images.emplace_back();
  EXPECT_EQ(serialize_vocabulary(train_vocabulary(images, tree_of(3, 2))), serialize_vocabulary(without));
}

TEST(Trainer, IdenticalDescriptorsGiveOneWord) {
  const cv::Mat same(20, kOrbBytes, CV_8UC1, cv::Scalar(0x5a));
  const Vocabulary vocabulary = train_vocabulary(std::vector{same, same}, tree_of(3, 3));
  EXPECT_EQ(vocabulary.word_count(), 1U);
  EXPECT_EQ(vocabulary.quantize(same).words.front(), WordId{0});
  EXPECT_EQ(vocabulary_stats(vocabulary).balance, 1);
}

TEST(Trainer, SmallNodesStayWhole) {
  const auto images = clustered_images(10, 100, 100, 6);
  auto options = tree_of(4, 3);
  const size_t all = train_vocabulary(images, options).word_count();
  options.min_split = 60;
  const Vocabulary pruned = train_vocabulary(images, options);
  EXPECT_LT(pruned.word_count(), all);
  EXPECT_EQ(vocabulary_stats(pruned).descriptors, 1000U);
}

TEST(Trainer, StopsWithAPartialTree) {
  const auto images = clustered_images(10, 100, 100, 7);
  size_t reports = 0, last = 0;
  const auto whole = train_vocabulary(images, tree_of(4, 3), [&](const ProgressReport& now) {
    EXPECT_GE(now.done, last);
    EXPECT_LE(now.done, now.total);
    last = now.done;
    ++reports;
    return true;
  });
  EXPECT_EQ(last, 3000U);
  EXPECT_GT(reports, 1U);
  const auto stopped = train_vocabulary(images, tree_of(4, 3), [](const ProgressReport&) { return false; });
  EXPECT_EQ(stopped.word_count(), 4U);
  EXPECT_LT(stopped.word_count(), whole.word_count());
}

TEST(Trainer, TooLittleInputIsAnErrorThatSaysWhatToDo) {
  const auto images = clustered_images(2, 100, 50, 8);
  EXPECT_THAT(
      test::input_error([&] { train_vocabulary(images, tree_of(10, 5)); }),
      HasSubstr("200 descriptors are too few for a vocabulary of up to 10^5 words, which needs 20000"));
  EXPECT_THAT(test::input_error([&] { train_vocabulary(images, tree_of(201, 1)); }),
              HasSubstr("up to 201^1 words, which needs 201"));
  EXPECT_THAT(test::input_error([&] { train_vocabulary({}, tree_of(10, 5)); }), HasSubstr("0 descriptors"));
  EXPECT_THAT(test::input_error([&] { train_vocabulary(std::vector{images[0]}, tree_of(2, 2)); }),
              HasSubstr("give more images"));
}

TEST(Trainer, OptionsAreChecked) {
  const auto set = [](const std::string& assignment) {
    return with_assignments(TrainOptions{}, std::vector{assignment});
  };
  EXPECT_EQ(set("branching=8").branching, 8);
  EXPECT_THAT(test::usage_error([&] { set("branching=1"); }), HasSubstr("branching"));
  EXPECT_THAT(test::usage_error([&] { set("seeding=kd-tree"); }), HasSubstr("kmeans++"));
}

}  // namespace
}  // namespace kinloop
