// Raw SIFT and SURF descriptors: the properties that hold for bits must hold for bytes.

#include <gmock/gmock.h>

#include "kinloop/core/random.hpp"
#include "kinloop/place/vocabulary/descriptor_space.hpp"
#include "kinloop/place/vocabulary/vocabulary_file.hpp"
#include "tests/support/temp_folder.hpp"
#include "tools/vocabulary_training/trainer.hpp"
#include "tools/vocabulary_training/vocabulary_stats.hpp"

namespace kinloop {
namespace {

/// Rows around `centres` points, off by up to `noise` in each component.
cv::Mat clustered_rows(int rows, int bytes, uint32_t centres, double noise, uint64_t seed) {
  Random random(seed);
  cv::Mat mat(rows, bytes, CV_8UC1);
  for (int row = 0; row < rows; ++row) {
    Random centre(hash(9, random.index(centres)));
    for (int i = 0; i < bytes; ++i) {
      const double value = centre.uniform(40, 210) + random.uniform(-noise, noise);
      mat.at<uint8_t>(row, i) = cv::saturate_cast<uint8_t>(value);
    }
  }
  return mat;
}

TEST(EuclideanSpace, TheMeanIsTheBestOfTheGrid) {
  const cv::Mat rows = clustered_rows(7, 64, 7, 30, 1);
  const auto points = as_points<SurfSpace>(std::span(rows.ptr(0), rows.total()));
  std::vector<uint64_t> counts(SurfSpace::kCounts, 0);
  for (const auto& point : points) SurfSpace::add(point, counts.data());
  const auto sum_to = [&](const SurfSpace::Point& centre) {
    uint64_t sum = 0;
    for (const auto& point : points) sum += SurfSpace::distance(point, centre);
    return sum;
  };
  const auto mean = SurfSpace::mean(counts.data(), points.size(), {});
  for (size_t i = 0; i < mean.size(); ++i) {
    for (const int step : {-1, 1}) {
      auto moved = mean;
      moved[i] = static_cast<uint8_t>(moved[i] + step);
      EXPECT_GE(sum_to(moved), sum_to(mean)) << i;
    }
  }
}

TEST(EuclideanSpace, FarthestIsFarthest) {
  SiftSpace::Point low, high;
  low.fill(0);
  high.fill(255);
  EXPECT_EQ(SiftSpace::distance(low, high), SiftSpace::kMaxDistance);
  EXPECT_EQ(SiftSpace::distance(high, low), SiftSpace::kMaxDistance);
}

class EuclideanVocabulary : public testing::TestWithParam<DescriptorKind> {};

TEST_P(EuclideanVocabulary, FindsTheClustersAndIsKeptInAFile) {
  constexpr double kNoise = 12;
  const auto bytes = static_cast<int>(descriptor_traits(GetParam()).bytes);
  std::vector<cv::Mat> images;
  for (uint64_t i = 0; i < 10; ++i) images.push_back(clustered_rows(120, bytes, 16, kNoise, i));
  TrainOptions options;
  options.branching = 16;
  options.depth = 1;
  const Vocabulary trained = train_vocabulary(to_training_set(images, GetParam()), options);
  EXPECT_EQ(trained.word_count(), 16U);
  // The variance of uniform noise, a third of its square, in each component.
  const double expected = bytes * kNoise * kNoise / 3;
  EXPECT_NEAR(quantization_error(trained, images), expected, 0.05 * expected);

  const test::TempFolder folder;
  write_vocabulary(folder.path() / "a.kinvoc", trained);
  const Vocabulary read = read_vocabulary(folder.path() / "a.kinvoc");
  EXPECT_EQ(read.tree().kind, GetParam());
  EXPECT_EQ(read.quantize(images[0]).words, trained.quantize(images[0]).words);
  EXPECT_THROW((void)read.quantize(cv::Mat(1, 32, CV_8UC1, cv::Scalar(0))), std::logic_error);
}

INSTANTIATE_TEST_SUITE_P(Kinds, EuclideanVocabulary,
                         testing::Values(DescriptorKind::kSift, DescriptorKind::kSurf));

}  // namespace
}  // namespace kinloop
