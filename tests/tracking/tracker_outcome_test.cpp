// Outcomes of the tracker: Tracked, Relocalized, NewMap and Lost.

#include <gtest/gtest.h>

#include "kinloop/loop/place_recognition.hpp"
#include "kinloop/tracking/tracker.hpp"
#include "tests/support/synthetic_map.hpp"
#include "tools/vocabulary_training/trainer.hpp"

namespace kinloop {
namespace {

/// The vocabulary weights words by the number of images that contain them: as many "images" as walls have
/// patches.
Vocabulary world_vocabulary(const test::SyntheticWorld& world) {
  std::vector<cv::Mat> images;
  for (int row = 0; row < world.descriptors.rows; row += 40)
    images.push_back(world.descriptors.rowRange(row, row + 40));
  TrainOptions options;
  options.depth = 3;
  return train_vocabulary(images, options);
}

TrackerOptions impatient() {
  TrackerOptions options;
  options.lost_frames_before_new_component = 2;
  return options;
}

class TrackerOutcome : public testing::Test {
 protected:
  /// Builds a map of three keyframes that look in one direction; the rest of the room is unmapped.
  void build_map() {
    for (int i = 0; i < 3; ++i) {
      const auto view = test::observe(world_, pose(i), {}, 10 + static_cast<uint64_t>(i));
      places_.add(built_.map.keyframe(test::add_view(built_, world_, view, pose(i))));
    }
  }

  static SE3 pose(double i) { return test::camera_at(0.05 * i, {0.03 * i, 0, 0}); }
  static SE3 elsewhere() { return test::camera_at(3.14159, {0, 0, 0}); }

  /// Tracks the next frame and updates the tracker with it.
  FrameTracking show(const SE3& T_world_camera) {
    const auto view = test::observe(world_, T_world_camera, {}, 100 + id_);
    return show(view);
  }
  FrameTracking show(const test::SyntheticView& view) {
    PreparedFrame frame = test::make_frame(id_, view);
    frame.gray.setTo(id_ + 1);  // no frame repeats the previous image
    ++id_;
    Timings timings;
    FrameTracking tracking = tracker_.track(frame, {built_.map, sensor_, relocalize_}, timings);
    const TrackResult* result = located(tracking.outcome);
    tracker_.update(built_.map, result != nullptr ? result->reference : tracker_.reference(), &tracking);
    return tracking;
  }

  [[nodiscard]] double error_m(const FrameTracking& tracking, const SE3& truth) const {
    const TrackResult& result = *located(tracking.outcome);
    const SE3 T = built_.map.keyframe(result.reference).T_world_camera * result.T_reference_camera;
    return test::distance_m(T, truth);
  }

  test::SyntheticWorld world_ = test::make_world(4000, 1);
  test::SyntheticMap built_;
  PlaceRecognition places_{world_.camera, {}, world_vocabulary(world_)};
  Relocalizer relocalize_ = [this](const PreparedFrame& frame) {
    return places_.relocalize(frame, built_.map);
  };
  Tracker tracker_{world_.camera, impatient()};
  SensorVector sensor_ = SensorVector::Zero();
  uint32_t id_ = 0;
};

TEST_F(TrackerOutcome, FirstFrameStartsAMap) {
  EXPECT_TRUE(std::holds_alternative<NewMap>(show(pose(0)).outcome));
}

TEST_F(TrackerOutcome, FrameWithoutDepthStartsNoMap) {
  const auto blind = test::observe(world_, pose(0), {0.5, 1.425e-3, 12, 1.0}, 7);
  EXPECT_TRUE(std::holds_alternative<Lost>(show(blind).outcome));
}

TEST_F(TrackerOutcome, RelocalizesWithoutAPreviousFrame) {
  build_map();
  const FrameTracking found = show(pose(1.5));
  ASSERT_TRUE(std::holds_alternative<Relocalized>(found.outcome));
  EXPECT_LT(error_m(found, pose(1.5)), 0.003);
}

TEST_F(TrackerOutcome, TracksAfterRelocalization) {
  build_map();
  show(pose(1.5));
  const FrameTracking next = show(pose(1.7));
  ASSERT_TRUE(std::holds_alternative<Tracked>(next.outcome));
  EXPECT_LT(error_m(next, pose(1.7)), 0.003);
  EXPECT_GT(next.motion.velocity().linear_m_s.norm(), 0);
}

TEST_F(TrackerOutcome, PreviousFrameIsExpressedInANewReference) {
  build_map();
  show(pose(1.5));
  const KeyframeId other{tracker_.reference() == KeyframeId{0} ? 2U : 0U};
  tracker_.update(built_.map, other);
  const FrameTracking next = show(pose(1.7));
  ASSERT_TRUE(std::holds_alternative<Tracked>(next.outcome));
  EXPECT_EQ(std::get<Tracked>(next.outcome).result.reference, other);
  EXPECT_EQ(std::get<Tracked>(next.outcome).result.stats.attempts, 1);  // found at its predicted pose
  EXPECT_LT(error_m(next, pose(1.7)), 0.003);
}

TEST_F(TrackerOutcome, UnknownPlaceIsLostThenStartsANewMap) {
  build_map();
  show(pose(1.5));
  EXPECT_TRUE(std::holds_alternative<Lost>(show(elsewhere()).outcome));
  EXPECT_TRUE(std::holds_alternative<Lost>(show(elsewhere()).outcome));
  EXPECT_TRUE(std::holds_alternative<NewMap>(show(elsewhere()).outcome));
}

TEST_F(TrackerOutcome, ReturningCameraIsRelocalized) {
  build_map();
  show(pose(1.5));
  show(elsewhere());
  show(elsewhere());
  const FrameTracking back = show(pose(0.5));
  ASSERT_NE(located(back.outcome), nullptr);
  EXPECT_LT(error_m(back, pose(0.5)), 0.004);
}

TEST_F(TrackerOutcome, TrackHasNoSideEffects) {
  build_map();
  show(pose(1.5));
  const auto view = test::observe(world_, pose(1.7), {}, 9);
  PreparedFrame frame = test::make_frame(50, view);
  frame.gray.setTo(200);
  const TrackingContext context{built_.map, sensor_, relocalize_};
  Timings timings;
  const FrameTracking once = tracker_.track(frame, context, timings);
  const FrameTracking again = tracker_.track(frame, context, timings);
  ASSERT_NE(located(once.outcome), nullptr);
  ASSERT_NE(located(again.outcome), nullptr);
  EXPECT_EQ(located(once.outcome)->T_reference_camera.translation,
            located(again.outcome)->T_reference_camera.translation);
}

}  // namespace
}  // namespace kinloop
