#include "kinloop/sensor/surfaces/mask.hpp"

#include <gtest/gtest.h>
#include <opencv2/core.hpp>

namespace kinloop {
namespace {

TEST(Mask, TheIntersectionUsesWhatBothUse) {
  const cv::Mat a = (cv::Mat_<uint8_t>(1, 4) << 0, 0, 255, 255), b = (cv::Mat_<uint8_t>(1, 4) << 0, 1, 0, 1);
  const cv::Mat both = intersection_of_masks(a, b);
  for (int x = 0; x < 4; ++x)
    EXPECT_EQ(both.at<uint8_t>(x) != 0, a.at<uint8_t>(x) != 0 && b.at<uint8_t>(x) != 0) << x;
}

TEST(Mask, AnEmptyOneUsesAll) {
  const cv::Mat a = (cv::Mat_<uint8_t>(1, 2) << 0, 255);
  EXPECT_EQ(intersection_of_masks(a, {}).data, a.data);
  EXPECT_EQ(intersection_of_masks({}, a).data, a.data);
  EXPECT_TRUE(intersection_of_masks({}, {}).empty());
}

}  // namespace
}  // namespace kinloop
