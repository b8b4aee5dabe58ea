#include "drivers/ros/bag_source.hpp"

#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/core.hpp>

#include "tests/drivers/sequence_folder.hpp"
#include "tests/support/expect_error.hpp"

#ifdef KINLOOP_WITH_ROSBAG

#include <rosbag/bag.h>

#include "drivers/datasets/tum_source.hpp"
#include "drivers/ros/messages/ros_messages.hpp"
#include "drivers/ros/messages/ros_topics.hpp"

namespace kinloop {
namespace {

using test::input_error;
using testing::AllOf;
using testing::HasSubstr;

constexpr const char* kColor = "/kinect2/qhd/image_color_rect";
constexpr const char* kDepth = "/kinect2/qhd/image_depth_rect";
constexpr const char* kInfo = "/kinect2/qhd/camera_info";

ros::Time time_of(int64_t stamp_ns) {
  ros::Time time;
  time.fromNSec(static_cast<uint64_t>(stamp_ns));
  return time;
}

ros1::Image message_of(int64_t stamp_ns, const cv::Mat& image, const char* encoding) {
  ros1::Image message;
  message.header.stamp = time_of(stamp_ns);
  message.width = static_cast<uint32_t>(image.cols);
  message.height = static_cast<uint32_t>(image.rows);
  message.step = static_cast<uint32_t>(image.step);
  message.encoding = encoding;
  message.data.assign(image.data, image.data + image.step * static_cast<size_t>(image.rows));
  return message;
}

ros1::CameraInfo camera_message() {
  ros1::CameraInfo info;
  info.width = test::kWidth, info.height = test::kHeight;
  info.distortion_model = "plumb_bob";
  info.K[0] = 25, info.K[2] = 15.5, info.K[4] = 25, info.K[5] = 11.5, info.K[8] = 1;
  info.P[0] = 25, info.P[2] = 15.5, info.P[5] = 25, info.P[6] = 11.5, info.P[10] = 1;
  return info;
}

class BagTest : public testing::Test {
 protected:
  [[nodiscard]] std::filesystem::path path() const { return folder.path() / "test.bag"; }

  /// A bag with the messages written by `fill`.
  template <class Fill>
  void write(const Fill& fill) {
    rosbag::Bag bag(path().string(), rosbag::bagmode::Write);
    bag.write(kInfo, time_of(1), camera_message());
    fill(bag);
    bag.close();
  }
  static void add(rosbag::Bag& bag, const char* topic, int64_t stamp_ns, const cv::Mat& image,
                  const char* encoding) {
    bag.write(topic, time_of(stamp_ns), message_of(stamp_ns, image, encoding));
  }

  test::TempFolder folder;
};

TEST_F(BagTest, GivesTheFramesThatAFolderWithTheSameImagesGives) {
  const test::SequenceFolder sequence(8);
  TumSource expected(sequence.path());
  write([&](rosbag::Bag& bag) {
    TumSource source(sequence.path());
    while (const auto frame = source.next()) {
      cv::Mat millimetres;
      frame->depth_m.convertTo(millimetres, CV_16UC1, 1000);
      add(bag, kColor, frame->stamp_ns, frame->color.bgr(), "bgr8");
      add(bag, kDepth, *frame->depth_stamp_ns, millimetres, "16UC1");
    }
  });
  const auto source = open_bag(path(), {});
  EXPECT_EQ(source->info().frames, 8U);
  EXPECT_EQ(source->camera().color.fx, 25);
  while (const auto frame = expected.next()) {
    const auto from_bag = source->next();
    ASSERT_TRUE(from_bag);
    EXPECT_EQ(from_bag->id, frame->id);
    EXPECT_EQ(from_bag->stamp_ns, frame->stamp_ns);
    EXPECT_EQ(from_bag->depth_stamp_ns, frame->depth_stamp_ns);
    EXPECT_EQ(cv::norm(from_bag->color.bgr(), frame->color.bgr(), cv::NORM_INF), 0);
    EXPECT_EQ(cv::norm(from_bag->depth_m, frame->depth_m, cv::NORM_INF), 0);
  }
  EXPECT_FALSE(source->next());
  EXPECT_TRUE(source->skipped().empty());
}

/// The log time of a bag that is recorded now.
constexpr int64_t kNow_ns = 1'700'000'000'000'000'000;

TEST_F(BagTest, SimulationTimeMayBeginAtZero) {
  constexpr int64_t kStep_ns = 66'666'667;
  write([&](rosbag::Bag& bag) {
    for (int i = 0; i < 6; ++i) {
      const auto at = time_of(kNow_ns + i * kStep_ns);
      bag.write(kColor, at, message_of(i * kStep_ns, test::make_color(i), "bgr8"));
      bag.write(kDepth, at, message_of(i * kStep_ns, test::make_depth(1500), "16UC1"));
    }
  });
  const auto source = open_bag(path(), {});
  for (int i = 0; i < 6; ++i) {
    const auto frame = source->next();
    ASSERT_TRUE(frame);
    EXPECT_EQ(frame->stamp_ns, i * kStep_ns);
  }
  EXPECT_FALSE(source->next());
  EXPECT_TRUE(source->skipped().empty());
}

TEST_F(BagTest, EmptyStampsAreReplacedByTheTimeOfRecording) {
  for (const bool all_empty : {true, false}) {
    write([&](rosbag::Bag& bag) {
      for (int i = 0; i < 6; ++i) {
        const int64_t at_ns = kNow_ns + i * 66'666'667;
        const int64_t stamp_ns = all_empty || i == 2 ? 0 : at_ns;
        bag.write(kColor, time_of(at_ns), message_of(stamp_ns, test::make_color(i), "bgr8"));
        bag.write(kDepth, time_of(at_ns), message_of(stamp_ns, test::make_depth(1500), "16UC1"));
      }
    });
    const auto source = open_bag(path(), {});
    for (int i = 0; i < 6; ++i) {
      const auto frame = source->next();
      ASSERT_TRUE(frame);
      EXPECT_EQ(frame->stamp_ns, kNow_ns + i * 66'666'667);
    }
    EXPECT_TRUE(source->skipped().empty());
  }
}

TEST_F(BagTest, ColourOfAFasterCameraIsNotLost) {
  write([&](rosbag::Bag& bag) {
    for (int64_t i = 0; i < 36; ++i) {
      const int64_t stamp_ns = kNow_ns + i * 33'333'333;
      add(bag, kColor, stamp_ns, test::make_color(1), "bgr8");
      if (i % 3 == 0) add(bag, kDepth, stamp_ns, test::make_depth(1000), "16UC1");
    }
  });
  testing::internal::CaptureStdout();
  const auto source = open_bag(path(), {});
  size_t frames = 0;
  while (source->next()) ++frames;
  EXPECT_THAT(testing::internal::GetCapturedStdout(), HasSubstr("images not used: no image of the other"));
  EXPECT_EQ(frames, 12U);
  EXPECT_TRUE(source->skipped().empty()) << source->skipped().size();
}

TEST_F(BagTest, SkipsAndCountsWhatItCannotUse) {
  write([&](rosbag::Bag& bag) {
    for (int64_t i = 1; i <= 5; ++i) {
      const int64_t stamp = i * 100'000'000;
      add(bag, kColor, stamp, test::make_color(1), i == 2 ? "bayer_rggb8" : "bgr8");
      add(bag, kDepth, stamp, test::make_depth(1000), "16UC1");
    }
    add(bag, kColor, 300'000'000, test::make_color(2), "bgr8");  // time decreases
    add(bag, kColor, 600'000'000, test::make_color(3, CV_8UC3, {16, 12}), "bgr8");
  });
  const auto source = open_bag(path(), {});
  size_t frames = 0;
  while (source->next()) ++frames;
  EXPECT_EQ(frames, 4U);
  std::string reasons;
  for (const auto& skipped : source->skipped()) reasons += skipped.reason + "\n";
  EXPECT_THAT(reasons, AllOf(HasSubstr("bayer_rggb8"), HasSubstr("does not increase"), HasSubstr("16 x 12"),
                             HasSubstr("no image of the other")));
}

TEST_F(BagTest, RejectsBagsWithoutACamera) {
  EXPECT_THAT(input_error([&] { open_bag(folder.path() / "absent.bag", {}); }), HasSubstr("absent.bag"));
  folder.write("text.bag", "no bag");
  EXPECT_THAT(input_error([&] { open_bag(folder.path() / "text.bag", {}); }), HasSubstr("text.bag"));
  write([](rosbag::Bag&) {});
  EXPECT_THAT(input_error([&] { open_bag(path(), {}); }), AllOf(HasSubstr("--topics"), HasSubstr(kInfo)));
  write([](rosbag::Bag& bag) {
    add(bag, kColor, 100, test::make_color(1), "bgr8");
    add(bag, kDepth, 100, test::make_color(1), "bgr8");
  });
  EXPECT_THAT(input_error([&] { open_bag(path(), {})->next(); }),
              AllOf(HasSubstr("no usable frame"), HasSubstr("16UC1")));
}

TEST_F(BagTest, ABagThatIsStillNamedActiveIsRead) {
  write([](rosbag::Bag& bag) {
    add(bag, kColor, 100, test::make_color(1), "bgr8");
    add(bag, kDepth, 100, test::make_depth(1000), "16UC1");
  });
  const auto active = folder.path() / "test.bag.active";
  std::filesystem::rename(path(), active);
  EXPECT_TRUE(is_bag(active));
  EXPECT_TRUE(open_bag(active, {})->next());
}

TEST_F(BagTest, DepthOfAnUnknownCameraAsksForIt) {
  write([](rosbag::Bag& bag) {
    add(bag, "/camera/rgb/image_raw", 100, test::make_color(1), "bgr8");
    ros1::Image depth = message_of(100, test::make_depth(1000), "16UC1");
    depth.header.frame_id = "depth";
    bag.write("/camera/depth/image_raw", time_of(100), depth);
    bag.write("/camera/rgb/camera_info", time_of(100), camera_message());
  });
  EXPECT_THAT(input_error([&] { open_bag(path(), {}); }),
              AllOf(HasSubstr("/camera/depth/camera_info"), HasSubstr("--camera")));
}

TEST_F(BagTest, EveryCompressionGivesTheSameImages) {
  for (const auto compression :
       {rosbag::compression::Uncompressed, rosbag::compression::LZ4, rosbag::compression::BZ2}) {
    write([&](rosbag::Bag& bag) {
      bag.setCompression(compression);
      bag.setChunkThreshold(5000);
      for (int i = 1; i <= 5; ++i) {
        add(bag, kColor, i * 100'000'000, test::make_color(i), "bgr8");
        add(bag, kDepth, i * 100'000'000, test::make_depth(1000), "16UC1");
      }
    });
    const auto source = open_bag(path(), {});
    for (int i = 1; i <= 5; ++i) {
      const auto frame = source->next();
      ASSERT_TRUE(frame);
      EXPECT_EQ(cv::norm(frame->color.bgr(), test::make_color(i), cv::NORM_INF), 0);
    }
    EXPECT_FALSE(source->next());
  }
}

TEST_F(BagTest, ATruncatedBagGivesItsFirstFrames) {
  write([&](rosbag::Bag& bag) {
    bag.setChunkThreshold(5000);
    for (int i = 1; i <= 5; ++i) {
      add(bag, kColor, i * 100'000'000, test::make_color(i), "bgr8");
      add(bag, kDepth, i * 100'000'000, test::make_depth(1000), "16UC1");
    }
  });
  std::ifstream file(path(), std::ios::binary);
  const std::string whole((std::istreambuf_iterator<char>(file)), {});
  size_t before = 0;
  for (size_t size = 0; size < whole.size(); size += 101) {
    size_t frames = 0;
    try {
      const auto source = open_bag(folder.write("cut.bag", whole.substr(0, size)), {});
      while (source->next()) ++frames;
    } catch (const InputError& error) {
      EXPECT_THAT(error.what(), HasSubstr("cut.bag"));
    }
    EXPECT_GE(frames, before);
    before = frames;
    std::filesystem::remove(folder.path() / "cut.bag");
  }
  EXPECT_EQ(before, 5U);
}

TEST_F(BagTest, TakesOtherTopicsAndAnotherCamera) {
  write([&](rosbag::Bag& bag) {
    add(bag, "/my/color", 100, test::make_color(1), "bgr8");
    add(bag, "/my/depth", 100, test::make_depth(1000), "16UC1");
  });
  RgbdCamera camera;
  camera.color.width = test::kWidth, camera.color.height = test::kHeight;
  camera.color.fx = camera.color.fy = 33;
  const auto source = open_bag(path(), camera, "/my/color,/my/depth");
  EXPECT_EQ(source->camera().color.fx, 33);
  EXPECT_TRUE(source->next());
  EXPECT_THAT(input_error([&] { open_bag(path(), {}, "/my/color,/my/depth"); }),
              HasSubstr("/my/camera_info"));
}

}  // namespace
}  // namespace kinloop

#endif
