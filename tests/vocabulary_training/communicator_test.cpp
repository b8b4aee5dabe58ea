// One vocabulary trained by several processes: identical bytes, however images and memory are distributed.

#include "tools/vocabulary_training/communicator.hpp"

#include <gmock/gmock.h>

#include "kinloop/place/vocabulary/vocabulary_file.hpp"
#include "tests/place/synthetic.hpp"
#include "tests/support/expect_error.hpp"
#include "tests/support/temp_folder.hpp"
#include "tests/vocabulary_training/thread_communicator.hpp"
#include "tools/vocabulary_training/clustering/distributed_points.hpp"
#include "tools/vocabulary_training/descriptors/training_set.hpp"
#include "tools/vocabulary_training/trainer.hpp"

namespace kinloop {
namespace {

using test::clustered_images;

TrainOptions options_of(Seeding seeding) {
  TrainOptions options;
  options.branching = 4;
  options.depth = 3;
  options.iterations = 3;
  options.seeding = seeding;
  return options;
}

/// The images of `rank` of `size`: the first rank has very few.
std::span<const cv::Mat> share(const std::vector<cv::Mat>& images, const Communicator& ranks) {
  const auto begin_of = [&](int rank) {
    const auto r = static_cast<size_t>(rank), size = static_cast<size_t>(ranks.size());
    return images.size() * r * r / (size * size);
  };
  const size_t begin = begin_of(ranks.rank());
  return std::span(images).subspan(begin, begin_of(ranks.rank() + 1) - begin);
}

class ManyProcesses : public testing::TestWithParam<Seeding> {};

TEST_P(ManyProcesses, TrainTheSameVocabularyAsOne) {
  // 22,000 descriptors: a root that all processes cluster together, then nodes with an owner.
  const auto images = clustered_images(22, 1000, 50, 1);
  const auto options = options_of(GetParam());
  const std::string one = serialize_vocabulary(train_vocabulary(images, options));
  for (const int size : {2, 3}) {
    test::as_ranks(size, [&](const Communicator& ranks) {
      const auto together = train_vocabulary(to_training_set(share(images, ranks)), options, {}, ranks);
      EXPECT_EQ(serialize_vocabulary(together), one) << ranks.rank() << " of " << ranks.size();
    });
  }
}

INSTANTIATE_TEST_SUITE_P(Seedings, ManyProcesses,
                         testing::Values(Seeding::kRandom, Seeding::kKmeansPlusPlus,
                                         Seeding::kKmeansParallel),
                         [](const auto& seeding) { return "s" + std::to_string(seeding.index); });

TEST(ManyProcesses, RefillEmptyClustersLikeOne) {
  // Copies of one point and a few others: random seeds leave clusters empty.
  Random random(4);
  std::vector<BinaryDescriptor> points(90, test::random_descriptor(random));
  for (int i = 0; i < 10; ++i) points.push_back(test::random_descriptor(random));
  const ClusterOptions options{.clusters = 8, .seeding = Seeding::kRandom, .iterations = 20};
  const auto one = cluster<HammingSpace>(points, options);
  test::as_ranks(3, [&](const Communicator& ranks) {
    const auto r = static_cast<size_t>(ranks.rank());
    const auto here = std::span(points).subspan(r * 33, r == 2 ? 34 : 33);
    const auto some = cluster<HammingSpace>(here, options, ranks);
    EXPECT_EQ(some.centres, one.centres);
    EXPECT_EQ(some.distance_sum, one.distance_sum);
    EXPECT_TRUE(std::equal(some.cluster_of.begin(), some.cluster_of.end(),
                           one.cluster_of.begin() + static_cast<ptrdiff_t>(r) * 33));
  });
}

TEST(ManyProcesses, AllFailOnTooLittleData) {
  const auto images = clustered_images(3, 10, 10, 2);
  test::as_ranks(2, [&](const Communicator& ranks) {
    EXPECT_THROW(
        train_vocabulary(to_training_set(share(images, ranks)), options_of(Seeding::kRandom), {}, ranks),
        InputError);
  });
}

TEST(JoinMpi, AloneIsOne) {
  const auto ranks = join_mpi();
  EXPECT_EQ(ranks->size(), 1);
  EXPECT_EQ(ranks->all_reduce_sum(5), 5U);
}

TEST(ScratchMemory, TrainsTheSameBytesInFiles) {
  const test::TempFolder folder;
  const auto images = clustered_images(21, 1000, 300, 3);
  ScratchMemory memory(100'000, folder.path());
  TrainingSet set(DescriptorKind::kOrb, &memory);
  for (const auto& image : images) set.append(image);
  EXPECT_GE(memory.bytes_in_files(), 21'000U * kOrbBytes);
  EXPECT_EQ(serialize_vocabulary(train_vocabulary(std::move(set), options_of(Seeding::kKmeansPlusPlus))),
            serialize_vocabulary(train_vocabulary(images, options_of(Seeding::kKmeansPlusPlus))));
  EXPECT_EQ(memory.bytes_in_files(), 0U);
  EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
}

TEST(ScratchMemory, AFolderThatIsNotThereIsNamed) {
  ScratchMemory memory(0, "/nowhere/at/all");
  EXPECT_THAT(test::input_error([&] { (void)std::pmr::vector<uint8_t>(1 << 20, &memory); }),
              testing::AllOf(testing::HasSubstr("/nowhere/at/all"), testing::HasSubstr("--scratch")));
}

}  // namespace
}  // namespace kinloop
