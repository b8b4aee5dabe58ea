// The simulated Kinect as a frame source: exact geometry, reproducible bytes, a well-textured room.

#include <algorithm>
#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/features2d.hpp>
#include <opencv2/imgproc.hpp>

#include "drivers/datasets/tum_source.hpp"
#include "drivers/datasets/tum_writer.hpp"
#include "kinloop/core/errors.hpp"
#include "kinloop/core/files/text_file.hpp"
#include "kinloop/core/time.hpp"
#include "simulator/room/room_layout.hpp"
#include "simulator/simulated_source.hpp"
#include "tests/support/shared_data.hpp"
#include "tests/support/temp_folder.hpp"

namespace kinloop {
namespace {

SimulationOptions small_options(const KinectNoise& noise) {
  SimulationOptions options;
  options.width = 160;
  options.height = 120;
  options.noise = noise;
  return options;
}

/// One ideal and one noisy sensor in the same room, built once for all tests.
const SimulatedSource& ideal_source() {
  static const SimulatedSource source("ideal", 1, small_options(KinectNoise::none()), 2);
  return source;
}
const SimulatedSource& kinect_source() {
  static const SimulatedSource source("kinect", 1, small_options({}), 2);
  return source;
}

bool same(const cv::Mat& a, const cv::Mat& b) {
  return a.size() == b.size() && a.type() == b.type() && cv::norm(a, b, cv::NORM_INF) == 0;
}

/// World point of a pixel with depth, through the lens.
Eigen::Vector3d world_point(const SimulatedSource& source, const Frame& frame, int x, int y) {
  const PinholeCamera& camera = source.camera().color;
  const double depth_m = static_cast<double>(frame.depth_m.at<float>(y, x));
  const Eigen::Vector3d p_camera = camera.unproject(camera.undistort(Eigen::Vector2d(x, y)), depth_m);
  return source.info().ground_truth[frame.id.value].T_world_camera * p_camera;
}

TEST(SimulatedSource, DepthOfTheIdealSensorLiesOnTheSurface) {
  const SimulatedSource& source = ideal_source();
  for (const size_t index : {0U, 150U, 420U}) {
    const Frame frame = source.frame(index);
    int known = 0;
    for (int y = 0; y < frame.depth_m.rows; y += 5) {
      for (int x = 0; x < frame.depth_m.cols; x += 5) {
        if (frame.depth_m.at<float>(y, x) <= 0) continue;
        ++known;
        // Half a depth unit at oblique incidence, and the renderer's float arithmetic.
        ASSERT_LT(source.distance_to_surface(world_point(source, frame, x, y)), 2.5e-4);
      }
    }
    EXPECT_GT(known, 700);
  }
}

TEST(SimulatedSource, NothingOccludesTheMeasuredDepth) {
  const SimulatedSource& source = ideal_source();
  const Frame frame = source.frame(300);
  const Eigen::Vector3d center = source.info().ground_truth[300].T_world_camera.translation;
  EXPECT_GT(cv::countNonZero(frame.depth_m), 0.9 * static_cast<double>(frame.depth_m.total()));
  for (int y = 3; y < frame.depth_m.rows; y += 23) {
    for (int x = 3; x < frame.depth_m.cols; x += 23) {
      const Eigen::Vector3d p = world_point(source, frame, x, y);
      // Sphere tracing (Hart 1996) along the ray must arrive.
      const double range_m = (p - center).norm();
      double walked_m = 0;
      for (int step = 0; step < 300 && walked_m < range_m - 1e-3; ++step) {
        walked_m += std::max(source.distance_to_surface(center + walked_m / range_m * (p - center)), 2e-4);
      }
      EXPECT_NEAR(walked_m, range_m, 2e-3);
    }
  }
}

TEST(SimulatedSource, APointLooksAlikeFromTwoPlaces) {
  const SimulatedSource& source = ideal_source();
  const Frame a = source.frame(200), b = source.frame(206);
  const cv::Mat color_a = a.color.bgr(), color_b = b.color.bgr();
  const SE3 T_b_world = source.info().ground_truth[206].T_world_camera.inverse();
  const PinholeCamera& camera = source.camera().color;
  std::vector<double> differences;
  for (int y = 2; y < color_a.rows; y += 3) {
    for (int x = 2; x < color_a.cols; x += 3) {
      if (a.depth_m.at<float>(y, x) <= 0) continue;
      const Eigen::Vector3d p_b = T_b_world * world_point(source, a, x, y);
      const Eigen::Vector2d pixel = camera.distort(camera.project(p_b));
      if (p_b.z() < 0.1 || !camera.contains(pixel, 1)) continue;
      const cv::Point at(static_cast<int>(std::lround(pixel.x())), static_cast<int>(std::lround(pixel.y())));
      if (std::abs(static_cast<double>(b.depth_m.at<float>(at)) - p_b.z()) > 0.03) continue;  // occluded
      for (int c = 0; c < 3; ++c) {
        differences.push_back(std::abs(color_a.at<cv::Vec3b>(y, x)[c] - color_b.at<cv::Vec3b>(at)[c]));
      }
    }
  }
  ASSERT_GT(differences.size(), 2000U);
  std::nth_element(differences.begin(), differences.begin() + static_cast<long>(differences.size() / 2),
                   differences.end());
  EXPECT_LE(differences[differences.size() / 2], 5);
}

TEST(SimulatedSource, GivesTheSameBytesForAnyNumberOfThreadsAndEveryTime) {
  SimulatedSource alone("kinect", 1, small_options({}), 1);
  for (const size_t i : {0U, 1U, 3U}) {
    if (i == 3) {
      EXPECT_TRUE(alone.pass_over());
    }
    const auto first = alone.next();
    ASSERT_TRUE(first.has_value());
    const Frame second = kinect_source().frame(i);
    EXPECT_EQ(first->stamp_ns, second.stamp_ns);
    EXPECT_EQ(first->id, second.id);
    EXPECT_TRUE(same(first->color.bgr(), second.color.bgr()));
    EXPECT_TRUE(same(first->depth_m, second.depth_m));
  }
}

TEST(SimulatedSource, SeedsGiveDifferentRooms) {
  SimulationOptions options = small_options(KinectNoise::none());
  options.frames = 1;
  const SimulatedSource other("other", 2, options, 2);
  EXPECT_FALSE(same(other.frame(0).color.bgr(), ideal_source().frame(0).color.bgr()));
}

TEST(SimulatedSource, DoesNotExposeTheSensorGroundTruth) {
  const SimulatedSource& source = kinect_source();
  EXPECT_FALSE(source.camera().rolling_shutter_s);
  EXPECT_EQ(source.camera().depth_delay_s, 0);
  EXPECT_EQ(source.truth().rolling_shutter_s, 0.030);
  EXPECT_EQ(source.truth().depth_delay_s, 0.015);
  EXPECT_EQ(ideal_source().truth().rolling_shutter_s, 0);
  EXPECT_EQ(ideal_source().camera().rolling_shutter_s, 0) << "of an ideal sensor it is known";
  EXPECT_EQ(source.camera().depth_scale, 5000);
  EXPECT_NEAR(source.camera().color.fx, 517.306408 / 4, 1e-6);
  EXPECT_GT(source.info().ground_truth.size(), 500U);
}

TEST(SimulatedSource, TheMiddleRowShowsTheTrueDepthAtTheStampAndTheOthersDoNot) {
  KinectNoise rolling = KinectNoise::none();
  rolling.rolling_shutter_s = 0.030;
  const SimulatedSource source("rolling", 1, small_options(rolling), 2);
  const Frame skewed = source.frame(100), exact = ideal_source().frame(100);
  const auto row_error = [&](int y) {
    return cv::norm(skewed.depth_m.row(y), exact.depth_m.row(y), cv::NORM_L1);
  };
  EXPECT_LT(row_error(59) + row_error(60), 0.2 * (row_error(2) + row_error(117)));
}

TEST(SimulatedSource, DepthComesLater) {
  KinectNoise late = KinectNoise::none();
  late.depth_delay_s = 1.0 / 30;
  const SimulatedSource source("late", 1, small_options(late), 2);
  // With a delay of exactly one frame, depth is that of the next frame; colour stays.
  const double difference =
      cv::norm(source.frame(100).depth_m, ideal_source().frame(101).depth_m, cv::NORM_L1);
  const double undelayed =
      cv::norm(source.frame(100).depth_m, ideal_source().frame(100).depth_m, cv::NORM_L1);
  EXPECT_LT(difference, 0.01 * undelayed);
  EXPECT_TRUE(same(source.frame(100).color.bgr(), ideal_source().frame(100).color.bgr()));
}

TEST(SimulatedSource, DepthIsThatOfItsOwnStamp) {
  KinectNoise stamped = KinectNoise::none();
  stamped.depth_stamps = true;
  const SimulatedSource source("stamped", 1, small_options(stamped), 2);
  const Frame frame = source.frame(100);
  ASSERT_NE(*frame.depth_stamp_ns, frame.stamp_ns);
  KinectNoise late = KinectNoise::none();
  late.depth_delay_s = to_seconds(*frame.depth_stamp_ns - frame.stamp_ns);
  const SimulatedSource delayed("delayed", 1, small_options(late), 2);
  const auto& truth = delayed.info().ground_truth;
  const auto at = std::find_if(truth.begin(), truth.end(),
                               [&](const StampedPose& pose) { return pose.stamp_ns == frame.stamp_ns; });
  const Frame expected = delayed.frame(static_cast<size_t>(at - truth.begin()));
  EXPECT_TRUE(same(frame.depth_m, expected.depth_m));
  EXPECT_TRUE(same(frame.color.bgr(), expected.color.bgr()));
}

TEST(SimulatedSource, ThePathKeepsClearOfEverything) {
  const SimulatedSource& source = ideal_source();
  ASSERT_GT(source.info().ground_truth.size(), 500U);
  for (const StampedPose& pose : source.info().ground_truth) {
    ASSERT_GT(source.distance_to_surface(pose.T_world_camera.translation), sim::kPathClearance_m - 0.05);
  }
}

TEST(SimulatedSource, MostViewsAreFullOfCornersDepthAndLight) {
  const SimulatedSource source("full size", 1, {}, 2);
  const cv::Ptr<cv::ORB> orb = cv::ORB::create(1000);
  int rich = 0, views = 0;
  double known = 0;
  for (size_t i = 0; i < source.info().frames; i += 56, ++views) {
    const Frame frame = source.frame(i);
    const cv::Mat grey = frame.color.gray();
    std::vector<cv::KeyPoint> corners;
    orb->detect(grey, corners);
    rich += corners.size() >= 700 ? 1 : 0;
    known += cv::countNonZero(frame.depth_m) / static_cast<double>(frame.depth_m.total());
    EXPECT_GT(cv::mean(grey)[0], 60);
    EXPECT_LT(cv::mean(grey)[0], 190);
  }
  EXPECT_GE(rich, 0.9 * views);
  EXPECT_GT(known / views, 0.75);
}

TEST(SimulatedSource, RendersAlongARecordedPathInItsOwnWorld) {
  const std::filesystem::path file = test::shared_data("trajectories/fr1_room_like.txt");
  if (!std::filesystem::exists(file)) GTEST_SKIP() << file << " is not there";
  const auto source = make_simulated_source("sim:room:3", small_options(KinectNoise::none()), 2, file);
  const Trajectory path = read_tum_trajectory(file);
  ASSERT_EQ(source->info().ground_truth.size(), path.size());
  for (size_t i = 0; i < path.size(); i += 10) {
    const SE3& T = source->info().ground_truth[i].T_world_camera;
    ASSERT_EQ(source->info().ground_truth[i].stamp_ns, path[i].stamp_ns);
    ASSERT_LT((T.translation - path[i].T_world_camera.translation).norm(), 1e-9);
    ASSERT_GT(source->distance_to_surface(T.translation), 0.25);
  }
  double median_sum = 0;
  int views = 0;
  for (size_t i = 0; i < path.size(); i += 200, ++views) {
    const Frame frame = source->frame(i);
    median_sum += cv::mean(frame.depth_m, frame.depth_m > 0)[0];
    const Eigen::Vector3d p = world_point(*source, frame, 80, 60);
    EXPECT_TRUE(frame.depth_m.at<float>(60, 80) == 0 || source->distance_to_surface(p) < 1e-3);
  }
  EXPECT_GT(median_sum / views, 0.8);
  EXPECT_LT(median_sum / views, 3);
}

TEST(SimulatedSource, RefusesWhatItCannotSimulate) {
  EXPECT_THROW(make_simulated_source("sim:garden", {}, 1), UsageError);
  EXPECT_THROW(make_simulated_source("sim:room:", {}, 1), UsageError);
  EXPECT_THROW(make_simulated_source("sim:room:7x", {}, 1), UsageError);
  EXPECT_THROW(make_simulated_source("sim:room:-1", {}, 1), UsageError);
  EXPECT_THROW(make_simulated_source("sim:room", {}, 1, "/nowhere/path.txt"), InputError);
  const test::TempFolder folder;
  EXPECT_THROW(make_simulated_source("sim:room", {}, 1, folder.write("empty.txt", "# nothing\n")),
               InputError);
  const std::string far = "0 0 0 0 0 0 0 1\n1 5000 0 0 0 0 0 1\n";
  EXPECT_THROW(make_simulated_source("sim:room", {}, 1, folder.write("far.txt", far)), InputError);
}

TEST(TumWriter, WhatIsWrittenReadsBackAsTheSameFrames) {
  const SimulatedSource& source = kinect_source();
  const test::TempFolder folder;
  TumWriter writer(folder.path(), source.camera());
  constexpr size_t kFrames = 3;
  for (size_t i = 0; i < kFrames; ++i) {
    const Frame frame = source.frame(i);
    writer.append(frame);
  }
  EXPECT_FALSE(std::filesystem::exists(folder.path() / "rgb.txt"));  // not yet a sequence
  writer.finish(source.info().ground_truth);

  TumSource read(folder.path());
  EXPECT_EQ(read.camera().color.fx, source.camera().color.fx);
  EXPECT_EQ(read.camera().color.lens.k3, source.camera().color.lens.k3);
  EXPECT_EQ(read.info().ground_truth.size(), source.info().ground_truth.size());
  for (size_t i = 0; i < kFrames; ++i) {
    const auto frame = read.next();
    ASSERT_TRUE(frame.has_value());
    const Frame rendered = source.frame(i);
    EXPECT_EQ(frame->stamp_ns, rendered.stamp_ns);
    EXPECT_EQ(frame->depth_stamp_ns, rendered.depth_stamp_ns);
    EXPECT_NE(frame->depth_stamp_ns, frame->stamp_ns);
    EXPECT_TRUE(same(frame->color.bgr(), rendered.color.bgr()));
    EXPECT_TRUE(same(frame->depth_m, rendered.depth_m));
  }
  EXPECT_FALSE(read.next().has_value());
  EXPECT_TRUE(read.skipped().empty());
}

TEST(TumWriter, LeavesAnOlderSequenceAlone) {
  const test::TempFolder folder;
  folder.write("rgb.txt", "old");
  folder.write("camera.yaml", "old");
  EXPECT_THROW(TumWriter(folder.path(), ideal_source().camera()), InputError);
  EXPECT_EQ(read_file(folder.path() / "camera.yaml"), "old");
}

TEST(TumWriter, RejectsFramesOutOfOrderAndInvalidFolders) {
  const test::TempFolder folder;
  TumWriter writer(folder.path(), ideal_source().camera());
  const Frame frame = ideal_source().frame(0);
  writer.append(frame);
  EXPECT_THROW(writer.append(frame), std::logic_error);
  EXPECT_THROW(TumWriter(folder.write("file", "x"), ideal_source().camera()), InputError);
}

}  // namespace
}  // namespace kinloop
