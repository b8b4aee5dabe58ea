// Simulated sensors with a depth camera of its own, as frame sources.

#include <gtest/gtest.h>
#include <opencv2/core.hpp>

#include "drivers/datasets/tum_source.hpp"
#include "drivers/datasets/tum_writer.hpp"
#include "kinloop/core/errors.hpp"
#include "simulator/simulated_source.hpp"
#include "tests/support/temp_folder.hpp"

namespace kinloop {
namespace {

class SimulatedSensors : public testing::TestWithParam<SimulatedSensor> {
 protected:
  /// A third of the usual size.
  static SimulationOptions options(SimulatedSensor sensor = GetParam()) {
    SimulationOptions small;
    small.sensor = sensor;
    small.width = sensor == SimulatedSensor::kKinect2 ? 320 : 208;
    small.height = sensor == SimulatedSensor::kKinect2 ? 180 : 156;
    small.frames = 60;
    return small;
  }
  /// With noise; built once for all tests.
  static const SimulatedSource& source() {
    static const SimulatedSource kinect2("room", 1, options(SimulatedSensor::kKinect2), 2);
    static const SimulatedSource realsense("room", 1, options(SimulatedSensor::kRealsense), 2);
    return GetParam() == SimulatedSensor::kKinect2 ? kinect2 : realsense;
  }
};

bool same_image(const cv::Mat& a, const cv::Mat& b) {
  return a.size() == b.size() && a.type() == b.type() && cv::norm(a, b, cv::NORM_INF) == 0;
}

TEST_P(SimulatedSensors, DepthHasACameraOfItsOwnAndIsRegistered) {
  const SimulatedSource& source = this->source();
  ASSERT_TRUE(source.device().depth);
  EXPECT_FALSE(source.camera().depth);
  EXPECT_EQ(source.camera().sensor.model, GetParam() == SimulatedSensor::kKinect2
                                              ? DepthSensorModel::kKinect2
                                              : DepthSensorModel::kRealsenseD4xx);
  const Frame raw = source.device_frame(20), frame = source.frame(20);
  EXPECT_EQ(raw.depth_m.size(), cv::Size(source.device().depth->width, source.device().depth->height));
  EXPECT_NE(raw.depth_m.size(), raw.color.bgr().size());
  EXPECT_EQ(frame.depth_m.size(), frame.color.bgr().size());
  EXPECT_TRUE(same_image(raw.color.bgr(), frame.color.bgr()));
  EXPECT_GT(cv::countNonZero(frame.depth_m), 0.5 * static_cast<double>(frame.depth_m.total()));
}

TEST_P(SimulatedSensors, IdealDepthLiesOnTheSurface) {
  SimulationOptions ideal = options();
  ideal.remove_noise();
  const SimulatedSource source("room", 1, ideal, 2);
  const Frame frame = source.frame(30);
  const PinholeCamera& camera = source.camera().color;
  int known = 0, near = 0;
  for (int y = 0; y < frame.depth_m.rows; y += 3) {
    for (int x = 0; x < frame.depth_m.cols; x += 3) {
      const auto depth_m = static_cast<double>(frame.depth_m.at<float>(y, x));
      if (depth_m <= 0) continue;
      const Eigen::Vector3d p = source.info().ground_truth[30].T_world_camera *
                                camera.unproject(camera.undistort(Eigen::Vector2d(x, y)), depth_m);
      ++known;
      near += source.distance_to_surface(p) < 2e-3 ? 1 : 0;  // registration joins pixels across small steps
    }
  }
  EXPECT_GT(known, 1000);
  EXPECT_GT(near, 0.97 * known);
}

TEST_P(SimulatedSensors, GiveTheSameBytesForAnyNumberOfThreads) {
  const SimulatedSource alone("room", 1, options(), 1);
  const Frame a = alone.device_frame(10), b = source().device_frame(10);
  EXPECT_TRUE(same_image(a.color.bgr(), b.color.bgr()));
  EXPECT_TRUE(same_image(a.depth_m, b.depth_m));
}

TEST_P(SimulatedSensors, WhatIsWrittenReadsBackAsTheSameFrames) {
  const SimulatedSource& source = this->source();
  const test::TempFolder folder;
  TumWriter writer(folder.path(), source.device());
  for (size_t i = 0; i < 2; ++i) writer.append(source.device_frame(i));
  writer.finish(source.info().ground_truth);
  TumSource read(folder.path());
  EXPECT_EQ(read.camera().sensor.model, source.camera().sensor.model);
  for (size_t i = 0; i < 2; ++i) {
    const auto frame = read.next();
    ASSERT_TRUE(frame);
    EXPECT_TRUE(same_image(frame->color.bgr(), source.frame(i).color.bgr()));
    EXPECT_TRUE(same_image(frame->depth_m, source.frame(i).depth_m));
  }
}

TEST_P(SimulatedSensors, TheirRoomAndPathAreThoseOfTheKinect1) {
  SimulationOptions kinect1 = options();
  kinect1.sensor = SimulatedSensor::kKinect1;
  const SimulatedSource other("room", 1, kinect1, 2);
  const StampedPose a = source().info().ground_truth[9], b = other.info().ground_truth[9];
  EXPECT_EQ(a.stamp_ns, b.stamp_ns);
  EXPECT_EQ(a.T_world_camera.translation, b.T_world_camera.translation);
}

INSTANTIATE_TEST_SUITE_P(All, SimulatedSensors,
                         testing::Values(SimulatedSensor::kKinect2, SimulatedSensor::kRealsense),
                         [](const auto& sensor) { return std::string(name_of(sensor.param)); });

TEST(SimulatedSize, IsThatOfTheSensorUnlessGiven) {
  SimulationOptions options;
  options.frames = 1;
  EXPECT_EQ(SimulatedSource("room", 1, options, 2).camera().color.width, 640);
  options.sensor = SimulatedSensor::kKinect2;
  EXPECT_EQ(SimulatedSource("room", 1, options, 2).camera().color.width, 960);
  options.width = 8;
  EXPECT_THROW(SimulatedSource("room", 1, options, 2), UsageError);
}

}  // namespace
}  // namespace kinloop
