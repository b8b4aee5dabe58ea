#include "kinloop/place/vocabulary/default_vocabulary.hpp"

#include <algorithm>
#include <iostream>
#include <numbers>

#include <gmock/gmock.h>

#include "kinloop/core/files/text_file.hpp"
#include "kinloop/core/threads/parallel_for.hpp"
#include "kinloop/core/time.hpp"
#include "kinloop/geometry/trajectory.hpp"
#include "kinloop/place/place_index.hpp"
#include "kinloop/place/vocabulary/vocabulary_file.hpp"
#include "tests/support/shared_data.hpp"
#include "tools/vocabulary_training/descriptors/training_images.hpp"
#include "tools/vocabulary_training/vocabulary_stats.hpp"

namespace kinloop {
namespace {

namespace fs = std::filesystem;

TEST(DefaultVocabulary, IsTheFileOfTheRepository) {
  const fs::path file = test::source_folder() / "kinloop/place/vocabulary/orb.kinvoc";
  EXPECT_LE(fs::file_size(file), 4'000'000U);
  EXPECT_EQ(serialize_vocabulary(load_default_vocabulary()), read_file(file));
}

TEST(DefaultVocabulary, UsesItsWordsEvenly) {
  const Vocabulary vocabulary = load_default_vocabulary();
  const VocabularyStats stats = vocabulary_stats(vocabulary);
  EXPECT_GT(vocabulary.word_count(), 10'000U);
  EXPECT_GT(stats.balance, 0.9);
  EXPECT_GT(stats.idf_min, 0);
}

struct Place {
  int64_t stamp_ns;
  SE3 T_world_camera;
  BowVector bow;
};

/// Every `step`-th image of a sequence with ground truth.
std::vector<Place> places_of(const fs::path& sequence, size_t step) {
  constexpr int64_t kMaxGapNs = kNsPerSecond / 10;
  const Trajectory ground_truth = read_tum_trajectory(sequence / "groundtruth.txt");
  const auto lines = read_table(sequence / "rgb.txt");
  std::vector<fs::path> images;
  std::vector<Place> places;
  for (size_t i = 0; i < lines.size(); i += step) {
    const int64_t stamp_ns = parse_stamp_ns(lines[i].fields.at(0)).value();
    const auto pose = pose_at(ground_truth, stamp_ns, kMaxGapNs);
    if (!pose) continue;
    images.push_back(sequence / lines[i].fields.at(1));
    places.push_back({stamp_ns, *pose, {}});
  }
  const Vocabulary vocabulary = load_default_vocabulary();
  auto place = places.begin();
  DescribeOptions description;
  description.threads = hardware_threads();
  describe_images(images, description, {},
                  [&](const fs::path& path, const std::optional<cv::Mat>& descriptors) {
                    ASSERT_TRUE(descriptors) << path;
                    (place++)->bow = vocabulary.bow_of(vocabulary.quantize(*descriptors).words);
                  });
  return places;
}

TEST(DefaultVocabulary, SeparatesThePlacesOfRedkitchen) {
  const fs::path sequence = test::shared_data("redkitchen");
  if (!fs::exists(sequence)) GTEST_SKIP() << sequence << " is not there";
  const auto places = places_of(sequence, 10);
  // The same view: within 0.5 m and 30 degrees, at least 10 s later. Another view: turned by more than the
  // field of view (60 degrees).
  std::vector<double> same, other;
  for (const Place& a : places) {
    for (const Place& b : places) {
      if (b.stamp_ns - a.stamp_ns < 10 * kNsPerSecond) continue;
      const SE3 T_a_b = a.T_world_camera.inverse() * b.T_world_camera;
      const double angle_deg = T_a_b.angle_rad() * 180 / std::numbers::pi;
      if (angle_deg > 60) other.push_back(similarity(a.bow, b.bow));
      if (angle_deg < 30 && T_a_b.translation.norm() < 0.5) same.push_back(similarity(a.bow, b.bow));
    }
  }
  ASSERT_GT(same.size(), 50U);
  ASSERT_GT(other.size(), 50U);
  std::sort(same.begin(), same.end());
  std::sort(other.begin(), other.end());
  double ordered = 0;
  for (const double score : same) {
    ordered += static_cast<double>(std::lower_bound(other.begin(), other.end(), score) - other.begin());
  }
  const double auc = ordered / (static_cast<double>(same.size()) * static_cast<double>(other.size()));
  const auto above =
      static_cast<double>(same.end() - std::upper_bound(same.begin(), same.end(), other.back()));
  std::cout << same.size() << " pairs of the same view, median score " << same[same.size() / 2] << "; "
            << other.size() << " of other views, " << other[other.size() / 2] << "; same above other in "
            << 100 * auc << " %; " << 100 * above / static_cast<double>(same.size())
            << " % of the same above all others\n";
  EXPECT_GT(auc, 0.9);
  EXPECT_GT(same[same.size() / 2], 1.2 * other[other.size() / 2]);
}

}  // namespace
}  // namespace kinloop
