#include "kinloop/slam/slam.hpp"

#include <gtest/gtest.h>
#include <opencv2/imgproc.hpp>

#include "drivers/datasets/tum_source.hpp"
#include "kinloop/features/extraction/extractor.hpp"
#include "kinloop/features/extraction/surf.hpp"
#include "session/session.hpp"
#include "session/source/frame_pipeline.hpp"
#include "tests/slam/recording.hpp"
#include "tests/support/shared_data.hpp"
#include "tests/support/temp_folder.hpp"
#include "tools/evaluation/evaluate.hpp"
#include "tools/vocabulary_training/trainer.hpp"

namespace kinloop {
namespace {

using test::record_simulation;
using test::Recording;

constexpr int kSimulatedFrames = 40;

/// The first frames of the simulated room, rendered once for all tests of this file.
const Recording& recording() {
  static const Recording kRecording = record_simulation("sim:room", kSimulatedFrames);
  return kRecording;
}

Trajectory run(const std::vector<Frame>& frames, const SlamOptions& options) {
  Slam slam(recording().camera, options);
  for (const Frame& frame : frames) slam.process(frame);
  return slam.finish();
}

void expect_same(const Trajectory& a, const Trajectory& b) {
  ASSERT_EQ(a.size(), b.size());
  for (size_t i = 0; i < a.size(); ++i) {
    EXPECT_EQ(a[i].T_world_camera.translation, b[i].T_world_camera.translation);
    EXPECT_EQ(a[i].T_world_camera.rotation.coeffs(), b[i].T_world_camera.rotation.coeffs());
  }
}

/// A source that returns the recorded frames.
class ReplayedSource : public FrameSource {
 public:
  std::optional<Frame> next() override {
    if (next_ == recording().frames.size()) return std::nullopt;
    if (next_ == fail_at) throw std::runtime_error("read error");
    return recording().frames[next_++];
  }
  [[nodiscard]] const RgbdCamera& camera() const override { return recording().camera; }
  [[nodiscard]] const SourceInfo& info() const override { return info_; }
  [[nodiscard]] SkippedFrames skipped() const override { return {}; }

  size_t fail_at = 1000000;

 private:
  SourceInfo info_;
  size_t next_ = 0;
};

TEST(Slam, TracksTheSimulatedSequence) {
  const Trajectory estimate = run(recording().frames, {});
  ASSERT_EQ(estimate.size(), static_cast<size_t>(kSimulatedFrames));
  const auto ate = absolute_trajectory_error(estimate, recording().truth);
  ASSERT_TRUE(ate.has_value());
  EXPECT_LT(ate->error_m.rmse, 1.5 * 0.0045);
}

/// A camera in motion has no velocity at its first frame. Without compensation of that frame the poses of the
/// first 0.3 s are 15 mm off.
TEST(Slam, TheFirstFramesAreAccurateIfTheTimesOfTheSensorAreKnown) {
  RgbdCamera camera = recording().camera;
  camera.rolling_shutter_s = 0.03;
  camera.depth_delay_s = 0.015;
  Slam slam(camera, {});
  const auto truth_at = [&](size_t i) { return recording().truth[i].T_world_camera; };
  for (size_t i = 0; i < 10; ++i) {
    const SE3 T_first_camera = slam.process(recording().frames[i]).T_world_camera;
    const SE3 error = T_first_camera.inverse() * (truth_at(0).inverse() * truth_at(i));
    EXPECT_LT(error.translation.norm(), 0.006) << i;
  }
}

/// The rooms and paths of other seeds: 2.9 to 7.9 mm.
TEST(Slam, TracksInOtherRooms) {
  for (const std::string scene : {"sim:room:4", "sim:room:5"}) {
    const Recording other = record_simulation(scene, kSimulatedFrames);
    Slam slam(other.camera);
    for (const Frame& frame : other.frames) slam.process(frame);
    const Trajectory estimate = slam.finish();
    EXPECT_EQ(estimate.size(), other.frames.size()) << scene;
    const auto ate = absolute_trajectory_error(estimate, other.truth);
    ASSERT_TRUE(ate.has_value());
    EXPECT_LT(ate->error_m.rmse, 1.5 * 0.0079) << scene;
  }
}

/// A vocabulary trained on the recording itself.
Vocabulary small_vocabulary(const FeatureOptions& features) {
  std::vector<cv::Mat> descriptors;
  for (size_t i = 0; i < recording().frames.size(); i += 10) {
    const cv::Mat gray = recording().frames[i].color.gray();
    descriptors.push_back(
        extract_features(gray, cv::Mat(), Sensor{recording().camera.color}, features).descriptors);
  }
  TrainOptions training;
  training.depth = 2;
  return train_vocabulary(descriptors, training);
}

TEST(Slam, LogsThePosesThatItReturned) {
  Slam slam(recording().camera);
  for (size_t i = 0; i < 20; ++i) {
    const TrackedFrame returned = slam.process(recording().frames[i]);
    const LoggedFrame& logged = slam.log().back();
    ASSERT_FALSE(returned.is_lost());
    EXPECT_EQ(returned.T_world_camera.matrix(), returned.world(slam.map()).matrix());
    EXPECT_EQ(logged.world(slam.map()).matrix(), returned.T_world_camera.matrix());
    EXPECT_EQ(logged.measurements.size(), returned.matches.size());
    EXPECT_TRUE(returned.frame != nullptr && logged.lost == nullptr) << "the log keeps no images";
    if (i > 0) {
      EXPECT_GT(returned.covariance.diagonal().minCoeff(), 0);
    }
  }
}

/// The work on the map comes after the pose.
TEST(Slam, GivesThePoseBeforeItMapsTheFrame) {
  Slam slam(recording().camera), whole(recording().camera);
  size_t keyframes = 0;
  for (size_t i = 0; i < 20; ++i) {
    const TrackedFrame given = slam.track(recording().frames[i]);
    EXPECT_TRUE(i == 0 || !given.keyframe.valid());  // the first one is where the map begins
    EXPECT_EQ(slam.session_log().size(), i);
    EXPECT_EQ(slam.latest()->world(slam.map()).matrix(), given.T_world_camera.matrix());
    const TrackedFrame mapped = slam.update_map();
    EXPECT_EQ(slam.session_log().size(), i + 1);
    EXPECT_LT((mapped.T_world_camera.translation - given.T_world_camera.translation).norm(), 0.005);
    EXPECT_EQ(mapped.T_map_odom.matrix(), given.T_map_odom.matrix());
    keyframes += mapped.keyframe.valid() ? 1 : 0;
    EXPECT_EQ(mapped.T_world_camera.matrix(), whole.process(recording().frames[i]).T_world_camera.matrix());
  }
  EXPECT_GE(keyframes, 2U);
  expect_same(slam.finish(), whole.finish());
}

TEST(Slam, MapsTheFrameBeforeIfThatHasNotBeenDone) {
  Slam slam(recording().camera), whole(recording().camera);
  EXPECT_THROW(slam.update_map(), std::logic_error);
  for (size_t i = 0; i < 20; ++i) {
    slam.track(recording().frames[i]);
    whole.process(recording().frames[i]);
  }
  EXPECT_EQ(slam.session_log().size(), 19U);
  expect_same(slam.finish(), whole.finish());
  EXPECT_EQ(slam.session_log().size(), 20U);
}

TEST(Slam, TracksWithEveryKindOfFeature) {
  for (const auto kind : {FeatureKind::kSift, FeatureKind::kSurf}) {
    if (kind == FeatureKind::kSurf && !surf_available()) continue;
    SlamOptions options;
    options.features.kind = kind;
    Slam slam(recording().camera, options, small_vocabulary(options.features));
    for (const Frame& frame : recording().frames) slam.process(frame);
    const Trajectory estimate = slam.finish();
    ASSERT_EQ(estimate.size(), static_cast<size_t>(kSimulatedFrames)) << name_of(kind);
    const auto ate = absolute_trajectory_error(estimate, recording().truth);
    ASSERT_TRUE(ate.has_value());
    EXPECT_LT(ate->error_m.rmse, 1.5 * 0.0040) << name_of(kind);
  }
}

TEST(Slam, ResultsAreBitwiseReproducible) {
  expect_same(run(recording().frames, {}), run(recording().frames, {}));
}

TEST(Slam, DescriptorsOnDiskGiveIdenticalResults) {
  SlamOptions on_disk;
  on_disk.keyframe_memory_mib = 0;
  expect_same(run(recording().frames, on_disk), run(recording().frames, {}));
}

TEST(Slam, PipelineGivesIdenticalResults) {
  ReplayedSource source;
  Slam slam(source.camera());
  FramePipeline pipeline(source, slam.front_end());
  while (const auto frame = pipeline.next()) slam.process(*frame);
  expect_same(slam.finish(), run(recording().frames, {}));
}

TEST(Session, WritesTheResultsOfSlam) {
  ReplayedSource source;
  SlamOptions options;
  Session session(source, {.slam = options});
  const Trajectory estimate = session.run();
  EXPECT_EQ(cv::getNumThreads(), 1);
  expect_same(estimate, run(recording().frames, options));
  expect_same(estimate, session.trajectory());
  const test::TempFolder folder;
  session.write_trajectory(folder.path() / "trajectory.txt");
  session.write_cloud(folder.path() / "map.ply");
  MapFileNotes notes;
  notes.input = "walk";
  session.write_map(folder.path() / "map.kinmap", notes);
  EXPECT_EQ(read_tum_trajectory(folder.path() / "trajectory.txt").size(), estimate.size());
  EXPECT_GT(std::filesystem::file_size(folder.path() / "map.ply"), 10'000U);
  const SavedMap saved = MapReader(folder.path() / "map.kinmap").read().first;
  EXPECT_EQ(saved.frames.size(), estimate.size());
  EXPECT_EQ(saved.sessions.back().input, "walk");
}

TEST(Session, CanFinishEarly) {
  ReplayedSource source;
  Session session(source, {.record_images = false});
  const Trajectory estimate = session.run([](const ProgressReport& at) { return at.done < 10; });
  EXPECT_EQ(estimate.size(), 10U);
}

TEST(Slam, PipelinePropagatesExceptions) {
  ReplayedSource source;
  source.fail_at = 3;
  Slam slam(source.camera());
  FramePipeline pipeline(source, slam.front_end());
  for (int i = 0; i < 3; ++i) EXPECT_TRUE(pipeline.next().has_value());
  EXPECT_THROW(pipeline.next(), std::runtime_error);
}

TEST(Slam, PipelineStopsWhenDestroyedEarly) {
  ReplayedSource source;
  Slam slam(source.camera());
  FramePipeline pipeline(source, slam.front_end());
  EXPECT_TRUE(pipeline.next().has_value());
}

TEST(Slam, EveryExecutorModeTracksEveryFrame) {
  for (const auto mode : {ExecutorMode::kInline, ExecutorMode::kLagged, ExecutorMode::kLive}) {
    SlamOptions options;
    options.executor.mode = mode;
    EXPECT_EQ(run(recording().frames, options).size(), static_cast<size_t>(kSimulatedFrames))
        << name_of(mode);
  }
}

TEST(Slam, ARepeatedImageKeepsItsPose) {
  auto frames = recording().frames;
  frames[20].color = frames[19].color;  // drivers do this when an image is lost
  frames[20].depth_m = frames[19].depth_m.clone();
  Slam slam(recording().camera);
  for (const Frame& frame : frames) slam.process(frame);
  const Trajectory estimate = slam.finish();
  ASSERT_EQ(estimate.size(), frames.size());
  EXPECT_TRUE(slam.log()[20].is_repeat());
  EXPECT_LT((estimate[20].T_world_camera.translation - estimate[19].T_world_camera.translation).norm(), 1e-9);
  EXPECT_EQ(std::count_if(slam.log().begin(), slam.log().end(), [](const auto& f) { return f.is_repeat(); }),
            1);
}

TEST(Slam, EqualBlackImagesAreNotRepeats) {
  auto frames = recording().frames;
  for (size_t i = 15; i < 22; ++i) {  // colour fails, depth goes on
    frames[i].color = cv::Mat(frames[i].color.size(), CV_8UC3, cv::Scalar::all(0));
  }
  Slam slam(recording().camera);
  for (const Frame& frame : frames) slam.process(frame);
  const Trajectory estimate = slam.finish();
  for (size_t i = 15; i < 22; ++i) EXPECT_FALSE(slam.log()[i].is_repeat()) << i;
  const auto ate = absolute_trajectory_error(estimate, recording().truth);
  ASSERT_TRUE(ate.has_value());
  EXPECT_LT(ate->error_m.max, 1.5 * 0.0117);
}

/// (cv::Mat::zeros() would write into the pixels, which the recording shares.)
Frame blackened(Frame frame) {
  frame.color = cv::Mat(frame.color.size(), CV_8UC3, cv::Scalar::all(0));
  frame.depth_m = cv::Mat(frame.depth_m.size(), CV_32FC1, cv::Scalar::all(0));
  return frame;
}

TEST(Slam, RepeatedImageAfterALostFrameIsTrackedNormally) {
  auto frames = recording().frames;
  frames[20] = blackened(frames[20]);
  frames[21].color = frames[19].color;
  frames[21].depth_m = frames[19].depth_m.clone();
  Slam slam(recording().camera);
  for (const Frame& frame : frames) slam.process(frame);
  const Trajectory estimate = slam.finish();
  ASSERT_EQ(estimate.size(), frames.size());
  EXPECT_EQ(slam.log()[20].method, TrackingMethod::kPredicted);
  EXPECT_FALSE(slam.log()[21].is_repeat());
  EXPECT_LT((estimate[21].T_world_camera.translation - estimate[19].T_world_camera.translation).norm(),
            0.006);
}

TEST(Slam, RelocalizesAfterABlackoutAndPredictsThePosesInIt) {
  auto frames = recording().frames;
  for (size_t i = 15; i < 22; ++i) frames[i] = blackened(frames[i]);
  const Trajectory estimate = run(frames, {});
  EXPECT_EQ(estimate.size(), frames.size());
  const auto ate = absolute_trajectory_error(estimate, recording().truth);
  ASSERT_TRUE(ate.has_value());
  EXPECT_LT(ate->error_m.rmse, 1.5 * 0.0040);
}

/// Returns the frame with all columns black except [begin, end).
Frame columns_of(const Frame& frame, int begin, int end) {
  Frame part = blackened(frame);
  const cv::Range shown(begin, end);
  cv::Mat color(frame.color.size(), CV_8UC3, cv::Scalar::all(0));
  frame.color.bgr().colRange(shown).copyTo(color.colRange(shown));
  part.color = color;
  frame.depth_m.colRange(shown).copyTo(part.depth_m.colRange(shown));
  return part;
}

/// One half of the view first, then the other, then both: only the last part determines their relative pose.
std::vector<Frame> sides_then_whole() {
  auto frames = recording().frames;
  const int width = frames[0].color.size().width, middle = width / 2;
  for (size_t i = 0; i < 8; ++i) frames[i] = columns_of(frames[i], 0, middle - 10);
  for (size_t i = 8; i < 20; ++i) frames[i] = columns_of(frames[i], middle + 10, width);
  return frames;
}

SlamOptions eager_for_keyframes() {
  SlamOptions options;
  options.tracking.keyframe.max_relative_translation = 0.02;
  options.tracking.keyframe.max_rotation_rad = 0.05;
  return options;
}

TEST(Slam, StartsANewComponentWhenLostAndMergesIt) {
  Slam slam(recording().camera, eager_for_keyframes());
  const auto frames = sides_then_whole();
  for (const Frame& frame : frames) slam.process(frame);
  const Trajectory estimate = slam.finish();
  EXPECT_EQ(slam.map().component_count(), 2U);
  for (const Keyframe& keyframe : slam.map().keyframes()) EXPECT_EQ(keyframe.component, 0U);
  EXPECT_GE(estimate.size(), frames.size() - 2);  // most frames lost in between are relocalized at the end
  const auto ate = absolute_trajectory_error(estimate, recording().truth);
  ASSERT_TRUE(ate.has_value());
  EXPECT_LT(ate->error_m.rmse, 1.5 * 0.0060);
}

TEST(Slam, UnmergedComponentIsNotInTheTrajectory) {
  Slam slam(recording().camera);
  const auto frames = sides_then_whole();
  for (size_t i = 0; i < 15; ++i) slam.process(frames[i]);
  EXPECT_EQ(slam.finish().size(), 8U);
  EXPECT_EQ(slam.map().component_count(), 2U);
  EXPECT_EQ(main_component(slam.log(), slam.map()), 0U);
}

TEST(Slam, WaitsForTheConfiguredNumberOfLostFrames) {
  SlamOptions options;
  options.lost_frames_before_new_component = 0;  // never
  Slam slam(recording().camera, options);
  const auto frames = sides_then_whole();
  for (size_t i = 0; i < 20; ++i) slam.process(frames[i]);
  EXPECT_EQ(slam.finish().size(), 8U);
  EXPECT_EQ(slam.map().component_count(), 1U);
}

TEST(Slam, WaitsForEnoughKeypointsToInitialize) {
  Slam slam(recording().camera);
  EXPECT_TRUE(slam.process(blackened(recording().frames[0])).is_lost());
  EXPECT_FALSE(slam.process(recording().frames[1]).is_lost());
  EXPECT_EQ(slam.finish().size(), 1U);
}

TEST(Slam, AnEmptyRunFinishes) {
  Slam slam(recording().camera);
  EXPECT_TRUE(slam.finish().empty());
}

TEST(Slam, RejectsImagesOfAnotherSize) {
  const Slam slam(recording().camera);
  Frame frame = recording().frames[0];
  frame.color = cv::Mat(10, 10, CV_8UC3);
  EXPECT_THROW((void)slam.front_end().prepare(frame), std::logic_error);
}

TEST(Slam, RejectsFramesThatAreNotInOrderOfTime) {
  Slam slam(recording().camera);
  slam.process(recording().frames[1]);
  EXPECT_THROW(slam.process(recording().frames[0]), std::logic_error);
  EXPECT_THROW(slam.process(recording().frames[1]), std::logic_error);
  slam.process(recording().frames[2]);
  EXPECT_EQ(slam.finish().size(), 2U);
}

TEST(Slam, MapInvariantsHold) {
  Slam slam(recording().camera);
  for (const Frame& frame : recording().frames) {
    slam.process(frame);
    slam.map().check_invariants();
  }
  slam.finish();
  slam.map().check_invariants();
}

TEST(Slam, TracksARealKinect) {
  const auto folder = test::shared_data("redkitchen");
  KINLOOP_SKIP_WITHOUT(folder);
  TumSource source(folder);
  Slam slam(source.camera());
  for (int i = 0; i < 150; ++i) slam.process(*source.next());
  const Trajectory estimate = slam.finish();
  ASSERT_EQ(estimate.size(), 150U);
  const auto ate = absolute_trajectory_error(estimate, source.info().ground_truth);
  ASSERT_TRUE(ate.has_value());
  EXPECT_LT(ate->error_m.rmse, 1.5 * 0.0072);
}

}  // namespace
}  // namespace kinloop
