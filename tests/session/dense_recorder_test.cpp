#include "session/store/dense_recorder.hpp"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "tests/dense/plane_view.hpp"

namespace kinloop {
namespace {

RgbdCamera camera() {
  RgbdCamera camera;
  camera.color = test::small_camera();
  return camera;
}

SE3 pose_of(uint32_t frame, double error) {
  const double t = frame;
  return {exp_so3({0.01 * t, 0.02 * t + error, 0}), {0.05 * t, error, 0}};
}

TrackedFrame tracked_frame(uint32_t id, const RgbdImages& seen,
                           std::shared_ptr<const SurfaceGrid> surfaces = nullptr) {
  Frame frame;
  frame.id = FrameId{id};
  frame.color = seen.color;
  frame.depth_m = seen.depth_m;
  frame.surfaces = std::move(surfaces);
  TrackedFrame tracked;
  tracked.id = frame.id;
  tracked.outcome = TrackingOutcome::kTracked;
  tracked.frame = std::make_shared<const Frame>(frame);
  return tracked;
}

/// Feeds frames of a wall to the recorder; every `step`-th frame becomes a keyframe.
void show_wall(DenseRecorder& recorder, uint32_t frames, uint32_t step) {
  for (uint32_t i = 0; i < frames; ++i) {
    const auto seen = test::view_of_wall(camera().color, pose_of(i, 0), 1.8, {0, 128, 255});
    TrackedFrame tracked = tracked_frame(i, seen);
    if (i % step == 0) tracked.keyframe = KeyframeId{i / step};
    recorder.on_frame(tracked);
  }
}

/// All stored views, at poses with an error of `error`.
std::vector<PosedImage> views_of(const DenseRecorder& recorder, double error) {
  std::vector<PosedImage> views;
  for (size_t i = 0; i < recorder.image_count(); ++i) {
    views.push_back({i, pose_of(recorder.frame_of_image(i).value, error)});
  }
  return views;
}

ColoredCloud cloud_of(DenseRecorder& recorder, double error, int threads) {
  recorder.wait_for_jobs();
  return recorder.fuse_views(views_of(recorder, error), {.color = camera().color}, threads, {});
}

void expect_same(const ColoredCloud& a, const ColoredCloud& b) {
  ASSERT_GT(a.size(), 1000U);
  EXPECT_EQ(a.points, b.points);
  EXPECT_EQ(a.colors, b.colors);
}

TEST(DenseRecorder, OnlineAndOfflinePatchesAreIdentical) {
  DenseRecorder recorder(camera(), {});
  show_wall(recorder, 40, 4);
  const auto while_running = cloud_of(recorder, 0.03, 2);
  EXPECT_EQ(recorder.image_count(), 10U);

  DenseRecorder restored(camera(), {});
  for (size_t i = 0; i < recorder.image_count(); ++i) restored.restore(recorder.saved_images(i));
  // Surfaces follow the corrected poses of their keyframes.
  expect_same(cloud_of(recorder, 0, 2), cloud_of(restored, 0, 1));
  expect_same(while_running, cloud_of(restored, 0.03, 1));
}

TEST(DenseRecorder, WhatMovesIsNotInTheCloud) {
  const auto grid = make_surface_camera(make_sensor(camera()));
  const auto count_points = [&](int moved_columns) {
    DenseRecorder recorder(camera(), {});
    const auto seen = test::view_of_wall(camera().color, {}, 1.8, {0, 128, 255});
    const auto surfaces = std::make_shared<const SurfaceGrid>(make_surface_grid(grid, seen.depth_m));
    for (uint32_t i = 0; i < 4; ++i) {
      TrackedFrame tracked = tracked_frame(i, seen, surfaces);
      tracked.keyframe = KeyframeId{i};
      if (moved_columns > 0) {
        tracked.moved = cv::Mat::zeros(grid->grid.height, grid->grid.width, CV_8UC1);
        tracked.moved.colRange(0, moved_columns).setTo(255);
      }
      recorder.on_frame(tracked);
    }
    recorder.wait_for_jobs();
    std::vector<PosedImage> views;
    for (size_t i = 0; i < recorder.image_count(); ++i) views.push_back({i, SE3{}});
    return static_cast<double>(recorder.fuse_views(views, {.color = camera().color}, 1, {}).size());
  };
  const double all = count_points(0), half = count_points(grid->grid.width / 2);
  ASSERT_GT(all, 1000);
  EXPECT_LT(half, 0.55 * all);
  EXPECT_GT(half, 0.35 * all);
}

TEST(DenseRecorder, ExecutionModeDoesNotMatter) {
  DenseRecorder lagged(camera(), {});
  show_wall(lagged, 30, 3);
  const auto expected = cloud_of(lagged, 0, 1);
  for (const auto mode : {ExecutorMode::kInline, ExecutorMode::kLive}) {
    DenseOptions in_memory;
    in_memory.surfel_memory_mib = 16;
    ExecutorOptions executor;
    executor.mode = mode;
    DenseRecorder other(camera(), in_memory, executor);
    show_wall(other, 30, 3);
    expect_same(cloud_of(other, 0, 2), expected);
  }
}

TEST(DenseRecorder, SurfelsAtTheEndGiveTheSameCloud) {
  DenseRecorder during(camera(), {});
  show_wall(during, 30, 3);
  DenseOptions options;
  options.surfels_at_end = true;
  DenseRecorder at_end(camera(), options);
  show_wall(at_end, 30, 3);
  expect_same(cloud_of(at_end, 0, 2), cloud_of(during, 0, 1));
}

TEST(DenseRecorder, KeepsAllFramesUnderBackpressure) {
  DenseOptions all;
  all.frame_step = 1;
  ExecutorOptions slow;
  slow.dense_lag_frames = 1000;
  DenseRecorder recorder(camera(), all, slow);
  show_wall(recorder, 20, 100);
  recorder.wait_for_jobs();
  ASSERT_EQ(recorder.image_count(), 20U);
  for (uint32_t i = 0; i < 20; ++i) {
    EXPECT_EQ(recorder.frame_of_image(i), FrameId{i});
    EXPECT_TRUE(recorder.images_of(FrameId{i}));
  }
  EXPECT_FALSE(recorder.images_of(FrameId{20}));
}

TEST(DenseRecorder, RecordsExtraFramesWhenKeyframesAreSparse) {
  for (const uint32_t frames : {1, 4, 40, 400}) {
    DenseRecorder recorder(camera(), {});
    show_wall(recorder, frames, 100'000);
    recorder.wait_for_jobs();
    const double most = 9 + 8 * std::max(0.0, std::log(frames / 40.0));
    EXPECT_LE(static_cast<double>(recorder.image_count()), most) << frames;
    EXPECT_GE(recorder.image_count(), std::min<size_t>(1 + (frames - 1) / 5, 8)) << frames;
    EXPECT_GT(cloud_of(recorder, 0, 1).size(), 1000U) << frames;
  }
}

TEST(DenseRecorder, RecordsOnlyKeyframesWhenTheyAreDense) {
  DenseRecorder recorder(camera(), {});
  show_wall(recorder, 360, 12);
  recorder.wait_for_jobs();
  ASSERT_GT(recorder.image_count(), 12U);
  for (size_t i = 0; i < recorder.image_count(); ++i) {
    const uint32_t frame = recorder.frame_of_image(i).value;
    EXPECT_TRUE(frame % 12 == 0 || frame < 12 * 8) << frame;
  }
}

}  // namespace
}  // namespace kinloop
