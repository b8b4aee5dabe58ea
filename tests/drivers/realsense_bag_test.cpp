#ifdef KINLOOP_WITH_ROSBAG

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <ros/serialization.h>
#include <rosbag/bag.h>

#include "drivers/ros/bag_source.hpp"
#include "kinloop/sensor/camera/registration.hpp"
#include "tests/drivers/message_writer.hpp"
#include "tests/drivers/mutation.hpp"
#include "tests/drivers/sequence_folder.hpp"
#include "tests/support/expect_error.hpp"

namespace kinloop::test {

/// A message of any type, already serialised.
struct SerializedMessage {
  std::string type, data;
};

}  // namespace kinloop::test

// What rosbag asks of a message class.
namespace ros {
namespace message_traits {
template <>
struct MD5Sum<kinloop::test::SerializedMessage> {
  static const char* value(const kinloop::test::SerializedMessage&) { return "*"; }
};
template <>
struct DataType<kinloop::test::SerializedMessage> {
  static const char* value(const kinloop::test::SerializedMessage& m) { return m.type.c_str(); }
};
template <>
struct Definition<kinloop::test::SerializedMessage> {
  static const char* value(const kinloop::test::SerializedMessage&) { return ""; }
};
}  // namespace message_traits
namespace serialization {
template <>
struct Serializer<kinloop::test::SerializedMessage> {
  template <class Stream>
  static void write(Stream& stream, const kinloop::test::SerializedMessage& m) {
    std::memcpy(stream.advance(static_cast<uint32_t>(m.data.size())), m.data.data(), m.data.size());
  }
  static uint32_t serializedLength(const kinloop::test::SerializedMessage& m) {
    return static_cast<uint32_t>(m.data.size());
  }
};
}  // namespace serialization
}  // namespace ros

namespace kinloop {
namespace {

using test::input_error;
using testing::AllOf;
using testing::HasSubstr;

constexpr auto kRos1 = test::Serialization::kRos1;
const std::string kColorStream = "/device_0/sensor_1/Color_0", kDepthStream = "/device_0/sensor_0/Depth_0";
constexpr const char* kUnitTopic = "/device_0/sensor_0/option/Depth Units/value";

/// A recording of the SDK: depth at half the size of colour, from another pose.
class RealsenseBagTest : public testing::Test {
 protected:
  RealsenseBagTest() {
    PinholeCamera& c = camera.color;
    c.width = test::kWidth, c.height = test::kHeight;
    c.fx = c.fy = 25, c.cx = 15.5, c.cy = 11.5;
    camera.depth = resized(c, test::kWidth / 2);
    camera.T_color_depth = {exp_so3({0, 0.01, 0}), {0.015, 0, 0.001}};
  }

  void add(const std::string& topic, const std::string& type, int64_t stamp_ns, const std::string& data) {
    bag.write(topic, ros::Time(0, static_cast<uint32_t>(stamp_ns)), test::SerializedMessage{type, data});
  }
  void add_calibration() {
    const SE3 T_depth_reference{exp_so3({0.1, 0, 0}), {0.1, 0.2, 0.3}};
    add(kColorStream + "/info/camera_info", "sensor_msgs/CameraInfo", 1,
        info_message(kRos1, camera.color, "Brown Conrady"));
    add(kDepthStream + "/info/camera_info", "sensor_msgs/CameraInfo", 1,
        info_message(kRos1, *camera.depth, "None"));
    add(kDepthStream + "/tf/0", "geometry_msgs/Transform", 1,
        test::MessageWriter(kRos1).transform(T_depth_reference).bytes());
    add(kColorStream + "/tf/0", "geometry_msgs/Transform", 1,
        test::MessageWriter(kRos1).transform(camera.T_color_depth * T_depth_reference).bytes());
  }
  void add_images(int64_t stamp_ns, const std::string& depth_suffix = "", const std::string& frame = "0") {
    add(kColorStream + "/image/data", "sensor_msgs/Image", stamp_ns,
        image_message(kRos1, stamp_ns, test::make_color(1), "bgr8"));
    add(kDepthStream + "/image/data", "sensor_msgs/Image", stamp_ns,
        image_message(kRos1, stamp_ns, test::make_depth(6000, {16, 12}), "mono16", frame) + depth_suffix);
  }
  /// The registered depth of a frame; its raw depth is `depth_m` everywhere.
  void expect_depth(double depth_m) {
    bag.close();
    const auto source = open_bag(path, {});
    const auto frame = source->next();
    ASSERT_TRUE(frame);
    const cv::Mat raw(12, 16, CV_32FC1, cv::Scalar(depth_m));
    EXPECT_LT(cv::norm(frame->depth_m, DepthRegistration(camera)(raw), cv::NORM_INF), 1e-5);
    EXPECT_GT(cv::countNonZero(frame->depth_m), 400);
  }

  const test::TempFolder folder;
  const std::string path = folder.path() / "rs.bag";
  RgbdCamera camera;
  rosbag::Bag bag{path, rosbag::bagmode::Write};
};

TEST_F(RealsenseBagTest, DepthIsScaledAndRegistered) {
  add_calibration();
  const float unit = 0.00025F;
  add(kUnitTopic, "std_msgs/Float32", 1, test::MessageWriter(kRos1).number(unit).bytes());
  add_images(100);
  expect_depth(1.5);
}

TEST_F(RealsenseBagTest, OldFilesHaveTheUnitAsAProperty) {
  add_calibration();
  add("/device_0/sensor_0/property", "diagnostic_msgs/KeyValue", 1,
      test::MessageWriter(kRos1).text("Depth Units").text("0.000500").bytes());
  add_images(100);
  expect_depth(3);
}

TEST_F(RealsenseBagTest, NewFilesHaveTheUnitAfterEachImage) {
  add_calibration();
  const float unit = 0.0002F;
  add_images(100, test::MessageWriter(kRos1).number(unit).bytes(), "1");
  expect_depth(1.2);
}

TEST_F(RealsenseBagTest, WithoutAUnitDepthIsInMillimetres) {
  add_calibration();
  add_images(100);
  expect_depth(6);
}

TEST_F(RealsenseBagTest, NamesWhatIsMissing) {
  add_images(100);
  bag.close();
  EXPECT_THAT(input_error([&] { open_bag(path, {}); }),
              AllOf(HasSubstr("camera_info"), HasSubstr("--camera")));
  EXPECT_TRUE(open_bag(path, camera)->next());
  bag.open(path, rosbag::bagmode::Write);
  add(kColorStream + "/info/camera_info", "sensor_msgs/CameraInfo", 1, info_message(kRos1, camera.color));
  add(kDepthStream + "/info/camera_info", "sensor_msgs/CameraInfo", 1, info_message(kRos1, *camera.depth));
  add_images(100);
  bag.close();
  EXPECT_THAT(input_error([&] { open_bag(path, {}); }),
              AllOf(HasSubstr("/tf/0"), HasSubstr("T_color_depth")));
  bag.open(path, rosbag::bagmode::Write);
  add(kDepthStream + "/image/data", "sensor_msgs/Image", 1,
      image_message(kRos1, 1, test::make_depth(1), "mono16"));
  bag.close();
  EXPECT_THAT(input_error([&] { open_bag(path, {}); }), HasSubstr("without colour"));
}

TEST_F(RealsenseBagTest, NoMutatedFileBreaksTheReader) {
  add_calibration();
  add_images(100);
  add_images(200);
  bag.close();
  std::ifstream file(path, std::ios::binary);
  const std::string bytes((std::istreambuf_iterator<char>(file)), {});
  Random random(20);
  for (int i = test::mutations(2000); i > 0; --i)
    test::read_all(folder.write("m.bag", test::mutated(bytes, random)));
}

}  // namespace
}  // namespace kinloop

#endif
