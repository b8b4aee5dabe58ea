#include <gtest/gtest.h>

#include "session/store/map_store.hpp"
#include "tests/io/sample_map.hpp"
#include "tests/support/temp_folder.hpp"

namespace kinloop {
namespace {

/// The images of keyframe `index` of the sample map: a wall that faces the camera, 2 m away.
SavedImages wall_image(size_t index) {
  const cv::Mat color(120, 160, CV_8UC3, cv::Scalar(90, 90, 90)), wall_m(120, 160, CV_32FC1, cv::Scalar(2));
  return {FrameId{static_cast<uint32_t>(3 * index)}, encode_images(color, wall_m, {}).encoded};
}

TEST(RestoreSurfaces, KeyframesKnowWhatTheirImagesShow) {
  const test::TempFolder folder;
  write_map(folder.path() / "map.kinmap", test::some_saved_map(), test::kImages, wall_image);
  const MapReader reader(folder.path() / "map.kinmap");
  SavedMap saved = reader.read().first;
  restore_surfaces(saved, reader);
  for (size_t i = 0; i < test::kKeyframes; ++i) {
    const auto& surfaces = saved.map.keyframes[i].surfaces;
    ASSERT_EQ(surfaces != nullptr, i < test::kImages) << "keyframe " << i;
    if (!surfaces) continue;
    EXPECT_TRUE(has_depth(*surfaces));
    EXPECT_EQ(state_in_view({0, 0, 2}, *surfaces), PointState::kConsistent);
    EXPECT_EQ(state_in_view({0, 0, 1.5}, *surfaces), PointState::kContradicted);
  }
}

}  // namespace
}  // namespace kinloop
