// The reader on real recordings.

#include <gmock/gmock.h>
#include <opencv2/core.hpp>

#include "drivers/datasets/reading/lists/tum_listing.hpp"
#include "drivers/datasets/tum_source.hpp"
#include "tests/support/shared_data.hpp"
#include "tests/support/temp_folder.hpp"

namespace kinloop {
namespace {

using test::shared_data;
using test::TempFolder;
using testing::IsEmpty;
using testing::SizeIs;

TEST(TumSourceReal, RedKitchen) {
  const auto folder = shared_data("redkitchen");
  KINLOOP_SKIP_WITHOUT(folder);
  TumSource source(folder);
  EXPECT_EQ(source.info().frames, 1000U);
  EXPECT_THAT(source.info().ground_truth, SizeIs(1000));
  EXPECT_EQ(source.camera().color.fx, 522.07);
  for (int i = 0; i < 5; ++i) {
    const auto frame = source.next();
    ASSERT_TRUE(frame);
    EXPECT_EQ(frame->color.size(), cv::Size(640, 480));
    const double known = cv::countNonZero(frame->depth_m) / (640.0 * 480.0);
    EXPECT_GT(known, 0.5);
    double nearest_m = 0, farthest_m = 0;
    cv::minMaxLoc(frame->depth_m, &nearest_m, &farthest_m, nullptr, nullptr, frame->depth_m > 0);
    EXPECT_GT(nearest_m, 0.3);
    EXPECT_LT(farthest_m, 13.2);
  }
  EXPECT_THAT(source.skipped(), IsEmpty());
}

TEST(TumSourceReal, Freiburg1DeskHasTheRightCameraAndPairs) {
  const auto folder = shared_data("rgbd_dataset_freiburg1_desk_9frames");
  KINLOOP_SKIP_WITHOUT(folder);
  TumSource source(folder);
  EXPECT_EQ(source.camera().color.fx, 517.306408);
  EXPECT_EQ(source.next()->stamp_ns, 1305031453359684000);
  int frames = 1;
  while (source.next()) ++frames;
  EXPECT_EQ(frames, 9);
  EXPECT_THAT(source.skipped(), IsEmpty());
}

TEST(TumSourceReal, OwnAssociationEqualsThatOfTheTumTool) {
  const auto folder = shared_data("rgbd_dataset_freiburg1_desk_9frames");
  KINLOOP_SKIP_WITHOUT(folder);
  const TempFolder copy;  // without associations.txt
  for (const char* name : {"rgb.txt", "depth.txt"}) std::filesystem::copy(folder / name, copy.path() / name);
  const auto given = read_tum_listing(folder).frames;
  const auto own = read_tum_listing(copy.path()).frames;
  ASSERT_EQ(own.size(), given.size());
  for (size_t i = 0; i < own.size(); ++i) {
    EXPECT_EQ(own[i].stamp_ns, given[i].stamp_ns);
    EXPECT_EQ(own[i].color.file.filename(), given[i].color.file.filename());
    EXPECT_EQ(own[i].depth.file.filename(), given[i].depth.file.filename());
  }
}

}  // namespace
}  // namespace kinloop
