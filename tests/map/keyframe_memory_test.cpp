#include "kinloop/map/keyframe_memory.hpp"

#include <gtest/gtest.h>

#include "kinloop/core/log.hpp"
#include "tests/support/environment.hpp"
#include "tests/support/synthetic_world.hpp"
#include "tests/support/temp_folder.hpp"

namespace kinloop {
namespace {

/// Patches of every other keypoint, each of one grey value.
KeypointPatches patches_of(size_t keypoints, uint8_t gray) {
  std::vector<bool> has_patch;
  std::vector<Patch> patches;
  for (size_t i = 0; i < keypoints; ++i) {
    has_patch.push_back(i % 2 == 1);
    if (!has_patch.back()) continue;
    Patch& patch = patches.emplace_back();
    patch.texels.fill(static_cast<uint8_t>(gray + i));
    patch.octave = static_cast<int>(i % 3);
  }
  return {has_patch, patches};
}

/// Keyframes with the same number of keypoints, and what they hold.
class KeyframeMemoryTest : public testing::Test {
 protected:
  static constexpr size_t kKeypoints = 100, kKeyframes = 10;
  static constexpr size_t kBytesPerKeyframe = kKeypoints * kOrbBytes + kKeypoints / 2 * sizeof(Patch);

  void add_keyframe() {
    const auto number = static_cast<uint32_t>(map_.keyframes().size());
    Features features;
    features.pixels.assign(kKeypoints, Eigen::Vector2f::Zero());
    features.descriptors.create(static_cast<int>(kKeypoints), kOrbBytes, CV_8UC1);
    for (auto it = features.descriptors.begin<uint8_t>(); it != features.descriptors.end<uint8_t>(); ++it)
      *it = static_cast<uint8_t>(random_.next());
    descriptors_.push_back(features.descriptors.clone());
    const KeyframeId id =
        map_.add_keyframe(FrameId{number}, number, {}, std::make_shared<Features>(features));
    map_.set_patches(id, patches_of(kKeypoints, static_cast<uint8_t>(number)));
  }

  void expect_unchanged() const {
    for (const Keyframe& keyframe : map_.keyframes()) {
      const cv::Mat& expected = descriptors_[keyframe.id.value];
      ASSERT_EQ(keyframe.features->descriptors.size(), expected.size());
      EXPECT_TRUE(std::equal(expected.begin<uint8_t>(), expected.end<uint8_t>(),
                             keyframe.features->descriptors.begin<uint8_t>()));
      const KeypointPatches patches = patches_of(kKeypoints, static_cast<uint8_t>(keyframe.id.value));
      for (size_t i = 0; i < kKeypoints; ++i) {
        const Patch *found = keyframe.patches->find(i), *wanted = patches.find(i);
        ASSERT_EQ(found == nullptr, wanted == nullptr);
        if (found == nullptr) continue;
        EXPECT_EQ(found->texels, wanted->texels);
        EXPECT_EQ(found->octave, wanted->octave);
      }
    }
  }

  Map map_;
  std::vector<cv::Mat> descriptors_;  // by keyframe
  Random random_{1};
};

TEST_F(KeyframeMemoryTest, TheOldestGoToDiskAndStayTheSame) {
  KeyframeMemory memory(3 * kBytesPerKeyframe);
  for (size_t i = 0; i < kKeyframes; ++i) {
    add_keyframe();
    memory.apply_limit(map_);
    EXPECT_EQ(memory.bytes_in_memory(), std::min<size_t>(i + 1, 3) * kBytesPerKeyframe);
    EXPECT_EQ(memory.bytes_in_memory() + memory.bytes_on_disk(), (i + 1) * kBytesPerKeyframe);
  }
  for (const Keyframe& keyframe : map_.keyframes())
    EXPECT_EQ(keyframe.features->descriptor_storage != nullptr, keyframe.id.value < kKeyframes - 3);
  expect_unchanged();
}

TEST_F(KeyframeMemoryTest, CopiesOutliveTheMap) {
  std::shared_ptr<const Features> features;
  {
    Map map;
    KeyframeMemory memory(0);
    add_keyframe();
    map.append(map_.data());
    memory.apply_limit(map);
    EXPECT_EQ(memory.bytes_in_memory(), 0U);
    features = std::make_shared<const Features>(*map.keyframes()[0].features);
  }
  EXPECT_EQ(features->descriptors.at<uint8_t>(99, 31), descriptors_[0].at<uint8_t>(99, 31));
}

TEST_F(KeyframeMemoryTest, WithoutADiskEverythingStaysInMemory) {
  const test::TempFolder folder;
  const test::EnvironmentVariable elsewhere("TMPDIR", (folder.path() / "nowhere").string());
  log::set_level(spdlog::level::off);
  KeyframeMemory memory(0);
  for (size_t i = 0; i < kKeyframes; ++i) {
    add_keyframe();
    memory.apply_limit(map_);
  }
  log::set_level(spdlog::level::info);
  EXPECT_EQ(memory.bytes_in_memory(), kKeyframes * kBytesPerKeyframe);
  EXPECT_EQ(memory.bytes_on_disk(), 0U);
  expect_unchanged();
}

}  // namespace
}  // namespace kinloop
