// From Slam's events to the messages for a browser.

#include "viewer/live/run_scene.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstring>
#include <thread>

#include <gmock/gmock.h>
#include <opencv2/imgcodecs.hpp>

#include "dense/files/ply.hpp"
#include "kinloop/core/errors.hpp"
#include "kinloop/core/files/text_file.hpp"
#include "tests/support/temp_folder.hpp"
#include "tests/viewer/scene_parts.hpp"
#include "viewer/live/live_viewer.hpp"
#include "viewer/saved/saved_run.hpp"

namespace kinloop {
namespace {

constexpr int kWidth = 160, kHeight = 120;

RgbdCamera small_camera() {
  RgbdCamera camera;
  camera.color = {kWidth, kHeight, 140, 140, 79.5, 59.5, {}};
  return camera;
}

/// A wall at 2 m, red on the left and blue on the right, with one keypoint in the middle.
Frame wall_frame(uint32_t id) {
  Frame frame;
  frame.id = FrameId{id};
  frame.stamp_ns = int64_t{id} * 33'000'000;
  cv::Mat color(kHeight, kWidth, CV_8UC3, cv::Scalar(0, 0, 200));
  color.colRange(kWidth / 2, kWidth) = cv::Scalar(200, 0, 0);
  frame.color = color;
  frame.depth_m = cv::Mat(kHeight, kWidth, CV_32FC1, 2.0F);
  auto features = std::make_shared<Features>();
  features->raw_pixels = features->pixels = {{80, 60}};
  features->depths_m = {2};
  frame.features = features;
  frame.surfaces = std::make_shared<const SurfaceGrid>(
      make_surface_grid(make_surface_camera(make_sensor(small_camera())), frame.depth_m));
  return frame;
}

/// A run of frames, each 5 cm further along x; every second becomes a keyframe.
class FakeRun {
 public:
  explicit FakeRun(RunFeed& feed) : feed_(feed) {}

  /// `moved`: see TrackedFrame::moved.
  void frame(TrackingOutcome outcome = TrackingOutcome::kTracked, bool doubtful = false,
             const cv::Mat& moved = {}) {
    const Frame frame = wall_frame(next_++);
    TrackedFrame tracked = unlocated(frame);
    tracked.moved = moved;
    tracked.outcome = outcome;
    if (doubtful) doubt(tracked, DoubtCause::kUnknown);
    tracked.frame = std::make_shared<const Frame>(frame);
    if (!tracked.is_lost()) {
      if (next_ % 2 == 1) {
        const SE3 pose{Eigen::Quaterniond::Identity(),
                       {0.05 * static_cast<double>(map_.keyframes().size()), 0, 0}};
        tracked.keyframe = map_.add_keyframe(frame.id, frame.stamp_ns, pose, frame.features);
      }
      tracked.reference = map_.keyframes().back().id;
      tracked.T_reference_camera.translation.y() = 0.5;
    }
    feed_.on_frame(tracked);
    feed_.on_map(map_);
  }

  Map& map() { return map_; }

 private:
  RunFeed& feed_;
  Map map_;
  uint32_t next_ = 0;
};

class RunSceneTest : public testing::Test {
 protected:
  void update(bool watched = true) { run_scene_.update(feed_.take(), {}, watched); }

  void show_frames(int count) {
    for (int i = 0; i < count; ++i) {
      run_.frame();
      update();
    }
  }

  std::optional<ScenePart> part(PartKind kind, uint32_t index = 0) {
    uint64_t seen = 0;
    while (const auto next = scene_.next_after(seen)) {
      if (next->kind == kind && next->index == index) return next;
      seen = next->version;
    }
    return std::nullopt;
  }
  float number(PartKind kind, uint32_t index, size_t at) {
    float value = 0;
    const auto found = part(kind, index);
    require(found && found->body->size() >= 4 * at + 4, "a part with such a number");
    std::memcpy(&value, found->body->data() + 4 * at, sizeof value);
    return value;
  }
  nlohmann::json status() {
    const auto found = part(PartKind::kStatus);
    return nlohmann::json::parse(found->body->begin(), found->body->end());
  }

  ViewerOptions options_{.voxel_m = 0.05};  // wider than the pixels of such a small camera
  RunFeed feed_;
  FakeRun run_{feed_};
  Scene scene_{"run"};
  RunScene run_scene_{scene_, {"sequence", 10, small_camera(), {}, options_}};
};

TEST_F(RunSceneTest, ShowsKeyframesPathCameraImagesAndStatus) {
  for (int i = 0; i < 4; ++i) run_.frame();
  update();
  EXPECT_EQ(part(PartKind::kKeyframes)->body->size(), 2U * 28);
  EXPECT_FLOAT_EQ(number(PartKind::kKeyframes, 0, 7), 0.05F);  // x of the second keyframe
  EXPECT_EQ(part(PartKind::kPath)->body->size(), 4U * 16);
  EXPECT_FLOAT_EQ(number(PartKind::kPath, 0, 2), 0.5F);  // relative to the keyframe
  EXPECT_FLOAT_EQ(number(PartKind::kCamera, 0, 0), 0.05F);
  EXPECT_FLOAT_EQ(number(PartKind::kCamera, 0, 1), 0.5F);
  const auto jpeg = part(PartKind::kColorImage);
  EXPECT_EQ(cv::imdecode(*jpeg->body, cv::IMREAD_COLOR).cols, kWidth);  // small images are not enlarged
  EXPECT_EQ(part(PartKind::kFeatures)->body->size(), 8U);
  EXPECT_EQ(status()["frame"], 4);
  EXPECT_EQ(status()["keyframes"], 2);
  EXPECT_EQ(status()["tracking"], "tracking");
  EXPECT_GT(status()["points"], 100);
}

TEST_F(RunSceneTest, WithoutNewsNothingChanges) {
  run_.frame();
  update();
  update();  // frames per second may have changed
  const auto last = [this] {
    uint64_t seen = 0;
    while (const auto next = scene_.next_after(seen)) seen = next->version;
    return seen;
  };
  const uint64_t before = last();
  update();
  EXPECT_EQ(last(), before);
}

TEST_F(RunSceneTest, AMapCorrectionSendsOnlyPoses) {
  show_frames(200);
  const auto cloud = part(PartKind::kCloud, 0), path = part(PartKind::kPath, 0),
             later = part(PartKind::kKeyframes, 1);
  ASSERT_TRUE(cloud && path && later);
  MapUpdate bend;
  bend.T_world_camera = {{KeyframeId{3}, SE3{Eigen::Quaterniond::Identity(), {1, 2, 3}}}};
  bend.newest_keyframe = KeyframeId{99};
  ASSERT_TRUE(run_.map().apply(bend));
  feed_.on_map(run_.map());
  update();
  EXPECT_FLOAT_EQ(number(PartKind::kKeyframes, 0, 3 * 7 + 2), 3);
  EXPECT_EQ(part(PartKind::kCloud, 0)->version, cloud->version);
  EXPECT_EQ(part(PartKind::kPath, 0)->version, path->version);
  EXPECT_EQ(part(PartKind::kKeyframes, 1)->version, later->version);  // 36 unchanged keyframes
}

TEST_F(RunSceneTest, AMapCorrectionMovesTheMeshByPosesAlone) {
  show_frames(40);
  const auto before = test::parts(scene_, PartKind::kMeshPiece);
  ASSERT_FALSE(before.empty());
  MapUpdate bend;
  for (uint32_t i = 0; i < 20; ++i)
    bend.T_world_camera.emplace_back(KeyframeId{i}, SE3{Eigen::Quaterniond::Identity(), {1, 2, 3}});
  bend.newest_keyframe = KeyframeId{19};
  ASSERT_TRUE(run_.map().apply(bend));
  feed_.on_map(run_.map());
  update();
  const auto after = test::parts(scene_, PartKind::kMeshPiece);
  ASSERT_EQ(after.size(), before.size());
  for (size_t i = 0; i < after.size(); ++i) EXPECT_EQ(after[i].version, before[i].version);
}

TEST_F(RunSceneTest, OfTheMeshOnlyPiecesThatChangedAreSent) {
  show_frames(40);
  const auto before = test::parts(scene_, PartKind::kMeshPiece);
  ASSERT_FALSE(before.empty());
  run_.frame();
  run_.frame();  // 5 cm further: what is behind the camera by 1 m stays as it is
  update();
  const auto after = test::parts(scene_, PartKind::kMeshPiece);
  const uint64_t newest = before.back().version;
  const auto sent =
      std::ranges::count_if(after, [&](const ScenePart& part) { return part.version > newest; });
  EXPECT_LT(static_cast<size_t>(sent), after.size());
}

TEST_F(RunSceneTest, TheWholeMeshIsThereAfterTheEnd) {
  for (int i = 0; i < 7; ++i) run_.frame();
  update();
  feed_.on_finish(FrameLog(3), run_.map());
  for (int i = 0; i < 100; ++i) update();
  ASSERT_FALSE(test::parts(scene_, PartKind::kMeshPiece).empty());
  const uint64_t newest = test::parts(scene_, PartKind::kMeshPiece).back().version;
  update();
  EXPECT_EQ(test::parts(scene_, PartKind::kMeshPiece).back().version, newest);
}

TEST_F(RunSceneTest, WithoutTheOptionThereIsNoMesh) {
  ViewerOptions options = options_;
  options.mesh = false;
  Scene scene("run");
  RunScene run_scene(scene, {"sequence", 10, small_camera(), {}, options});
  for (int i = 0; i < 40; ++i) {
    run_.frame();
    run_scene.update(feed_.take(), {}, true);
  }
  EXPECT_TRUE(test::parts(scene, PartKind::kMeshPiece).empty());
  EXPECT_FALSE(test::parts(scene, PartKind::kCloud).empty());
}

TEST_F(RunSceneTest, WhatMovesIsInNeitherCloudNorMesh) {
  const PinholeCamera grid = wall_frame(0).surfaces->camera->grid;
  cv::Mat moved(grid.height, grid.width, CV_8UC1, cv::Scalar(0));
  moved.colRange(0, grid.width / 2) = 255;  // the red half
  for (int i = 0; i < 40; ++i) {
    run_.frame(TrackingOutcome::kTracked, false, moved);
    update();
  }
  for (const PartKind kind : {PartKind::kCloud, PartKind::kMeshPiece}) {
    const auto found = test::parts(scene_, kind);
    ASSERT_FALSE(found.empty());
    for (const ScenePart& part : found) {
      uint32_t count = 0;
      std::memcpy(&count, part.body->data() + 4, sizeof count);
      EXPECT_GT(count, 0U);
      const uint8_t* colors = part.body->data() + 24 + size_t{8} * count;
      for (uint32_t i = 0; i < count; ++i) EXPECT_GT(colors[4 * i + 2], 0) << "blue";
    }
  }
}

TEST_F(RunSceneTest, LostFramesLeaveAGap) {
  run_.frame();
  run_.frame(TrackingOutcome::kLost);
  update();
  EXPECT_TRUE(std::isnan(number(PartKind::kPath, 0, 5)));
  EXPECT_EQ(status()["tracking"], "lost");
}

TEST_F(RunSceneTest, TellsWhatSpoilsTheRecording) {
  run_.frame();
  update();
  EXPECT_TRUE(status()["hints"].empty());
  run_scene_.update(feed_.take(), {.hints = {"Too dark"}}, true);
  EXPECT_EQ(status()["hints"], nlohmann::json({"Too dark"}));
}

TEST_F(RunSceneTest, DoubtfulAndLostFramesAreMarked) {
  run_.frame();
  update();
  EXPECT_FALSE(part(PartKind::kDoubt));
  run_.frame(TrackingOutcome::kTracked, true);
  run_.frame(TrackingOutcome::kLost);
  run_.frame();
  run_.frame(TrackingOutcome::kTracked, true);
  update();
  EXPECT_EQ(*part(PartKind::kDoubt)->body, encode_ranges(std::vector<FrameRange>{{1, 3}, {4, 5}}));
  EXPECT_EQ(status()["tracking"], "doubtful");
}

TEST_F(RunSceneTest, NoImagesAreEncodedWithoutClients) {
  run_.frame();
  update(false);
  EXPECT_FALSE(part(PartKind::kColorImage));
  EXPECT_TRUE(part(PartKind::kCloud, 0));  // kept for browsers that connect later
}

TEST_F(RunSceneTest, TheSameWallIsSentOnce) {
  run_.frame();
  update();
  const size_t points = status()["points"];
  for (int i = 0; i < 2; ++i) run_.frame();
  update();
  EXPECT_LT(status()["points"].get<size_t>(), points + points / 5);  // only the new 5 cm at its side
}

TEST_F(RunSceneTest, TheFinalPathReplacesTheLivePath) {
  for (int i = 0; i < 5; ++i) run_.frame();
  update();
  FrameLog log(3);
  for (auto& entry : log) {
    entry.outcome = TrackingOutcome::kTracked;
    entry.reference = KeyframeId{0};
    entry.T_reference_camera.translation.x() = 9;
  }
  feed_.on_finish(log, run_.map());
  update();
  EXPECT_EQ(part(PartKind::kPath)->body->size(), 3U * 16);
  EXPECT_FLOAT_EQ(number(PartKind::kPath, 0, 1), 9);
}

TEST_F(RunSceneTest, UnreadEventsStayBounded) {
  for (int i = 0; i < 500; ++i) run_.frame();
  const RunEvents events = feed_.take();
  EXPECT_EQ(events.keyframes.size(), RunFeed::kMaxQueuedKeyframes);
  EXPECT_EQ(events.keyframes.back().keyframe, KeyframeId{249});
  EXPECT_EQ(events.frames.size(), 500U);
  EXPECT_TRUE(feed_.take().frames.empty());
}

TEST(Shuffled, IsTheSameCloudInAnotherOrderTheSameEveryTime) {
  ColoredCloud cloud;
  for (int i = 0; i < 1000; ++i) {
    cloud.points.emplace_back(static_cast<float>(i), 0, 0);
    cloud.colors.push_back({static_cast<uint8_t>(i % 256), 0, 0});
  }
  const ColoredCloud mixed = shuffled(cloud);
  float first_half = 0;
  std::vector<bool> there(1000);
  for (size_t i = 0; i < 1000; ++i) {
    const auto which = static_cast<size_t>(mixed.points[i].x());
    there[which] = true;
    EXPECT_EQ(mixed.colors[i][0], which % 256);  // colours stay with their points
    if (i < 500) first_half += mixed.points[i].x() / 500;
  }
  EXPECT_EQ(std::count(there.begin(), there.end(), true), 1000);
  EXPECT_NEAR(first_half, 500, 50);  // any prefix is spread over the whole
  EXPECT_EQ(shuffled(cloud).points, mixed.points);
}

TEST(RunControl, ProceedsUnlessPaused) {
  RunControl control;
  const auto never = [] { return false; };
  EXPECT_EQ(control.next_action(never), RunControl::Action::kProcessFrame);
  control.request_save();
  EXPECT_EQ(control.next_action(never), RunControl::Action::kSaveMap);
  EXPECT_EQ(control.next_action(never), RunControl::Action::kProcessFrame);
  control.pause();
  EXPECT_EQ(control.next_action([] { return true; }),
            RunControl::Action::kProcessFrame);  // the run is to end
}

TEST(RunControl, ProceedsHoweverOftenASaveIsRequested) {
  RunControl control(false, std::chrono::hours(1));
  const auto never = [] { return false; };
  int saves = 0;
  for (int i = 0; i < 100; ++i) {
    control.request_save();
    saves += control.next_action(never) == RunControl::Action::kSaveMap;
  }
  EXPECT_EQ(saves, 1);
  control.pause();
  EXPECT_EQ(control.next_action(never), RunControl::Action::kSaveMap) << "a paused run loses no time";
}

TEST(RunControl, ASaveThatCameTooEarlyIsMadeUpFor) {
  RunControl control(false, std::chrono::milliseconds(20));
  const auto never = [] { return false; };
  control.request_save();
  EXPECT_EQ(control.next_action(never), RunControl::Action::kSaveMap);
  control.request_save();
  EXPECT_EQ(control.next_action(never), RunControl::Action::kProcessFrame);
  std::this_thread::sleep_for(std::chrono::milliseconds(30));
  EXPECT_EQ(control.next_action(never), RunControl::Action::kSaveMap);
  EXPECT_EQ(control.next_action(never), RunControl::Action::kProcessFrame);
}

TEST(RunControl, AStepIsOneFrameAndSavingIsNoStep) {
  RunControl control;
  control.pause();
  std::atomic<int> frames = 0, saves = 0;
  std::atomic<bool> stop = false;
  std::thread run([&] {
    while (!stop) {
      const auto action = control.next_action([&] { return stop.load(); });
      if (!stop) ++(action == RunControl::Action::kSaveMap ? saves : frames);
    }
  });
  const auto becomes = [](const std::atomic<int>& count, int value) {
    for (int i = 0; i < 500 && count != value; ++i)
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    return count == value;
  };
  control.step();
  EXPECT_TRUE(becomes(frames, 1));
  control.request_save();
  EXPECT_TRUE(becomes(saves, 1));
  control.step();
  control.step();
  EXPECT_TRUE(becomes(frames, 3));
  EXPECT_TRUE(control.paused());
  stop = true;
  run.join();
  EXPECT_EQ(frames, 3);
}

TEST(SavedRun, SaysWhatIsMissingOrDamaged) {
  const test::TempFolder folder;
  EXPECT_THROW(read_saved_run(folder.path()), InputError);
  EXPECT_THROW(read_saved_run(folder.path() / "none.ply"), InputError);
  EXPECT_THROW(read_saved_run(folder.write("bad.ply", "ply\nnonsense\n")), InputError);
}

}  // namespace
}  // namespace kinloop
