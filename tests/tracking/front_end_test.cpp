#include "kinloop/tracking/front_end.hpp"

#include <gtest/gtest.h>
#include <opencv2/core/utility.hpp>

#include "kinloop/features/extraction/surf.hpp"
#include "kinloop/features/features.hpp"
#include "kinloop/optimize/pose/icp.hpp"
#include "tests/features/cluttered_image.hpp"

namespace kinloop {
namespace {

bool same_bytes(const cv::Mat& a, const cv::Mat& b) {
  return a.size() == b.size() && a.type() == b.type() &&
         std::equal(a.datastart, a.datastart + a.total() * a.elemSize(), b.datastart);
}

/// A textured frame, large enough for OpenCV to split it.
Frame large_frame(const PinholeCamera& camera) {
  const cv::Size size(camera.width, camera.height);
  cv::Mat channels[3], bgr, depth_m(size, CV_32FC1);
  for (uint64_t c = 0; c < 3; ++c) cv::resize(test::cluttered_image(c + 1), channels[c], size);
  cv::merge(channels, 3, bgr);
  for (int y = 0; y < size.height; ++y) {
    for (int x = 0; x < size.width; ++x) {
      const int offset = 3 * x - 2 * y;
      depth_m.at<float>(y, x) = 2.0F + 3e-4F * static_cast<float>(offset);
    }
  }
  Frame frame;
  frame.id = FrameId{0};
  frame.color = bgr;
  frame.depth_m = depth_m;
  return frame;
}

/// Everything that OpenCV computes of a frame.
struct Computed {
  Frame frame;
  std::shared_ptr<const Features> features;
  IcpFrame dense;
};

Computed compute(const Frame& frame, const PinholeCamera& camera, FeatureKind kind, int threads) {
  const int before = cv::getNumThreads();
  cv::setNumThreads(threads);
  FeatureOptions options;
  options.kind = kind;
  const Sensor sensor{camera};
  const FrontEnd front_end(sensor, options);
  Computed computed{front_end.prepare(frame), nullptr, {}};
  computed.features = front_end.features(computed.frame);
  computed.dense = make_icp_frame(make_icp_camera(sensor, {}), frame.depth_m, computed.frame.gray);
  cv::setNumThreads(before);
  return computed;
}

TEST(FrontEnd, TheThreadsOfOpenCvDoNotMatter) {
  PinholeCamera camera = test::ideal_camera();
  camera.width = 1280;
  camera.height = 960;
  camera.fx = camera.fy = 1050;
  camera.cx = 640;
  camera.cy = 480;
  camera.lens.k1 = 0.05;
  const Frame frame = large_frame(camera);
  for (const auto kind : {FeatureKind::kOrb, FeatureKind::kSift, FeatureKind::kSurf}) {
    if (kind == FeatureKind::kSurf && !surf_available()) continue;
    const Computed one = compute(frame, camera, kind, 1);
    ASSERT_GT(one.features->size(), 500U);
    for (const int threads : {2, 5}) {
      SCOPED_TRACE(name_of(kind));
      const Computed many = compute(frame, camera, kind, threads);
      EXPECT_TRUE(same_bytes(one.frame.gray, many.frame.gray));
      ASSERT_EQ(one.frame.octaves.size(), many.frame.octaves.size());
      for (size_t i = 0; i < one.frame.octaves.size(); ++i)
        EXPECT_TRUE(same_bytes(one.frame.octaves[i], many.frame.octaves[i]));
      EXPECT_EQ(one.features->raw_pixels, many.features->raw_pixels);
      EXPECT_EQ(one.features->depths_m, many.features->depths_m);
      EXPECT_EQ(one.features->levels, many.features->levels);
      EXPECT_TRUE(same_bytes(one.features->descriptors, many.features->descriptors));
      ASSERT_FALSE(one.dense.levels.empty());
      ASSERT_EQ(one.dense.levels.size(), many.dense.levels.size());
      for (size_t i = 0; i < one.dense.levels.size(); ++i) {
        EXPECT_TRUE(same_bytes(one.dense.levels[i].gray, many.dense.levels[i].gray));
        EXPECT_EQ(one.dense.levels[i].points, many.dense.levels[i].points);
      }
    }
  }
}

TEST(FrontEnd, AMaskLeavesOutKeypointsDepthAndSurfaces) {
  PinholeCamera camera = test::ideal_camera();
  const FrontEnd front_end(Sensor{camera}, {});
  Frame frame = large_frame(camera);
  const Frame whole = front_end.prepare(frame);
  cv::Mat mask(camera.height, camera.width, CV_8UC1, cv::Scalar(255));
  const cv::Rect left(0, 0, camera.width / 2, camera.height);
  mask(left) = 0;
  frame.mask = mask;
  // By the source, or later.
  for (const Frame& masked :
       {front_end.prepare(frame), front_end.ignore(whole, mask, IgnoreCause::kFixedToCamera)}) {
    EXPECT_EQ(cv::countNonZero(masked.depth_m(left)), 0);
    EXPECT_EQ(cv::countNonZero(masked.depth_m), camera.height * (camera.width - left.width));
    const auto features = front_end.features(masked);
    ASSERT_GT(features->size(), 50U);
    EXPECT_EQ(features->descriptors.rows, static_cast<int>(features->size()));
    for (const Eigen::Vector2f& pixel : features->raw_pixels)
      EXPECT_GE(pixel.x(), static_cast<float>(left.width) - 0.5F);
    const auto& points = masked.surfaces->inverse_depths_per_m;
    EXPECT_GT(std::count(points.begin(), points.end(), 0.0F), static_cast<long>(points.size() / 2 - 100));
  }
  EXPECT_GT(front_end.features(whole)->size(),
            front_end.features(front_end.ignore(whole, mask, IgnoreCause::kFixedToCamera))->size());
  frame.mask = mask(cv::Rect(0, 0, 10, 10));
  EXPECT_THROW(front_end.prepare(frame), std::logic_error);
}

TEST(FrontEnd, TwoMasksAddUp) {
  PinholeCamera camera = test::ideal_camera();
  const FrontEnd front_end(Sensor{camera}, {});
  Frame frame = large_frame(camera);
  cv::Mat left(camera.height, camera.width, CV_8UC1, cv::Scalar(255)), top = left.clone();
  left(cv::Rect(0, 0, camera.width / 2, camera.height)) = 0;
  top(cv::Rect(0, 0, camera.width, camera.height / 2)) = 0;
  frame.mask = left;
  const Frame both = front_end.ignore(front_end.prepare(frame), top, IgnoreCause::kFixedToCamera);
  const cv::Mat used = used_pixels(both.ignored);
  EXPECT_EQ(cv::countNonZero(used), camera.width / 2 * (camera.height / 2));
  EXPECT_EQ(cv::countNonZero(both.depth_m), cv::countNonZero(used));
}

TEST(FrontEnd, WhatMovedKeepsItsSurfaces) {
  PinholeCamera camera = test::ideal_camera();
  const FrontEnd front_end(Sensor{camera}, {});
  const Frame whole = front_end.prepare(large_frame(camera));
  cv::Mat mask(camera.height, camera.width, CV_8UC1, cv::Scalar(255));
  mask(cv::Rect(0, 0, camera.width / 2, camera.height)) = 0;
  const Frame without = front_end.ignore(whole, mask, IgnoreCause::kMoved);
  EXPECT_EQ(without.surfaces, whole.surfaces);
  EXPECT_LT(front_end.features(without)->size(), front_end.features(whole)->size());
  EXPECT_EQ(cv::countNonZero(without.depth_m), cv::countNonZero(mask));
}

}  // namespace
}  // namespace kinloop
