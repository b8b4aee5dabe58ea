// Outcomes of the tracker: Tracked, Relocalized, NewMap and Lost.

#include <gtest/gtest.h>
#include <opencv2/core.hpp>

#include "kinloop/loop/recognition/place_recognition.hpp"
#include "kinloop/map/frames/frame_log.hpp"
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

/// The view with its first `count` keypoints only.
test::SyntheticView with_fewer_features(const test::SyntheticView& view, size_t count) {
  Features few = *view.features;
  const auto shorten = [&](auto& values) {
    if (values.size() > count) values.resize(count);
  };
  shorten(few.pixels);
  shorten(few.depths_m);
  shorten(few.raw_pixels);
  shorten(few.measured_pixels);
  shorten(few.measured_depths_m);
  shorten(few.inverse_depth_gradients);
  shorten(few.levels);
  shorten(few.angles_rad);
  shorten(few.sigmas_px);
  few.descriptors = few.descriptors.rowRange(0, static_cast<int>(few.pixels.size())).clone();
  test::SyntheticView shortened = view;
  shorten(shortened.point_of);
  shortened.features = std::make_shared<const Features>(std::move(few));
  return shortened;
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
  static SE3 turned(double angle_rad) { return test::camera_at(angle_rad, {0, 0, 0}); }
  static SE3 elsewhere() { return test::camera_at(3.14159, {0, 0, 0}); }

  /// Tracks the next frame and updates the tracker with it.
  TrackedFrame show(const SE3& T_world_camera) {
    return show(test::observe(world_, T_world_camera, {}, 100 + id_));
  }
  TrackedFrame show(const test::SyntheticView& view) {
    Frame frame = test::make_frame(id_, view);
    frame.gray.setTo(id_ + 1);  // no frame repeats the previous image
    ++id_;
    const TrackedFrame tracked = tracker_.track(frame, {built_.map, sensor_, relocalize_});
    tracker_.update(tracked, built_.map);
    return tracked;
  }

  /// Turns from the mapped part of the room, from `angle_rad` on, until the pose is in doubt.
  TrackedFrame turn_into_doubt(double& angle_rad) {
    TrackedFrame latest = show(turned(angle_rad));
    while (!latest.is_lost() && !latest.is_doubtful()) latest = show(turned(angle_rad += 0.03));
    return latest;
  }

  /// The frame as if it were recognized, on many landmarks, `x_m` from the first keyframe.
  static std::optional<TrackedFrame> found_away(const Frame& frame, double x_m) {
    TrackedFrame found = unlocated(frame);
    found.outcome = TrackingOutcome::kRelocalized;
    found.reference = KeyframeId{0};
    found.T_reference_camera.translation = {x_m, 0, 0};
    found.evidence.inliers = found.evidence.with_depth = 500;
    return found;
  }

  [[nodiscard]] double error_m(const TrackedFrame& tracked, const SE3& truth) const {
    return test::distance_m(tracked.world(built_.map), truth);
  }

  test::SyntheticWorld world_ = test::make_world(4000, 1);
  test::SyntheticMap built_;
  Sensor sensor_{world_.camera};
  PlaceRecognition places_{sensor_, {}, world_vocabulary(world_)};
  Relocalizer relocalize_ = [this](const Frame& frame) { return places_.relocalize(frame, built_.map); };
  Timings timings_;
  FrontEnd front_end_{sensor_, impatient().features};
  Tracker tracker_{front_end_, impatient(), timings_};
  uint32_t id_ = 0;
};

TEST_F(TrackerOutcome, FirstFrameStartsAMap) {
  EXPECT_EQ(show(pose(0)).outcome, TrackingOutcome::kNewMap);
}

TEST_F(TrackerOutcome, FrameWithoutDepthStartsNoMap) {
  const auto blind = test::observe(world_, pose(0), {0.5, 1.425e-3, 12, 1.0}, 7);
  EXPECT_EQ(show(blind).outcome, TrackingOutcome::kLost);
}

TEST_F(TrackerOutcome, RelocalizesWithoutAPreviousFrame) {
  build_map();
  const TrackedFrame found = show(pose(1.5));
  ASSERT_EQ(found.outcome, TrackingOutcome::kRelocalized);
  EXPECT_LT(error_m(found, pose(1.5)), 0.003);
}

TEST_F(TrackerOutcome, TracksAfterRelocalization) {
  build_map();
  show(pose(1.5));
  const TrackedFrame next = show(pose(1.7));
  ASSERT_EQ(next.outcome, TrackingOutcome::kTracked);
  EXPECT_LT(error_m(next, pose(1.7)), 0.003);
  EXPECT_GT(next.velocity.linear_m_s.norm(), 0);
}

TEST_F(TrackerOutcome, AWeakRelocalizationIsInDoubtUntilAFrameConfirmsIt) {
  build_map();
  relocalize_ = [this](const Frame& frame) {
    auto found = places_.relocalize(frame, built_.map);
    if (found) found->evidence.inliers = 40;
    return found;
  };
  const TrackedFrame weak = show(pose(1.5));
  ASSERT_EQ(weak.outcome, TrackingOutcome::kRelocalized);
  EXPECT_TRUE(weak.is_doubtful());
  EXPECT_FALSE(show(pose(1.55)).is_doubtful());
}

TEST_F(TrackerOutcome, AWeakRelocalizationThatNothingConfirmsIsGivenUp) {
  build_map();
  relocalize_ = [this](const Frame& frame) -> std::optional<TrackedFrame> {
    if (frame.id.value > 0) return std::nullopt;
    return places_.relocalize(frame, built_.map);
  };
  const auto view = [this](double i) {
    return with_fewer_features(test::observe(world_, pose(i), {}, 100 + id_), 59);
  };
  const TrackedFrame weak = show(view(1.5));
  ASSERT_EQ(weak.outcome, TrackingOutcome::kRelocalized);
  EXPECT_TRUE(weak.is_doubtful());
  TrackedFrame latest;
  for (int i = 0; i < 40; ++i) {
    latest = show(view(1.5));
    EXPECT_TRUE(latest.is_doubtful() || latest.is_lost()) << i;
  }
  EXPECT_TRUE(latest.is_lost());
}

TEST_F(TrackerOutcome, WhereHardlyAnyLandmarkInViewIsFoundThePoseIsInDoubt) {
  constexpr size_t kFound = 40;
  world_ = test::make_world(20000, 1);
  build_map();
  show(pose(1.5));
  test::SyntheticView view = test::observe(world_, pose(1.55), {}, 100 + id_);
  ASSERT_GT(view.features->size(), kFound * 100 / 8);
  Features hidden = *view.features;
  hidden.descriptors = hidden.descriptors.clone();
  cv::randu(hidden.descriptors.rowRange(kFound, hidden.descriptors.rows), 0, 256);
  view.features = std::make_shared<const Features>(std::move(hidden));
  const TrackedFrame latest = show(view);
  ASSERT_TRUE(latest.is_located());
  EXPECT_GE(latest.evidence.inliers, 15);
  EXPECT_EQ(latest.trust.cause, DoubtCause::kHidden);
}

/// What hides the landmarks holds the camera, which then turns to where none are expected.
TEST_F(TrackerOutcome, OdometryCarriesOnWhatWasWrongWithThePreviousPose) {
  constexpr size_t kFound = 40;
  world_ = test::make_world(20000, 1);
  build_map();
  show(pose(1.5));
  const auto look_hidden = [&](double angle_rad, size_t found) {
    test::SyntheticView view =
        test::observe(world_, test::camera_at(angle_rad, {0.0465, 0, 0}), {}, 100 + id_);
    Features features = *view.features;
    features.descriptors = features.descriptors.clone();
    cv::Mat others = features.descriptors.rowRange(static_cast<int>(found), features.descriptors.rows);
    cv::bitwise_not(others, others);
    view.features = std::make_shared<const Features>(std::move(features));
    return show(view);
  };
  double angle_rad = 0.0775;
  TrackedFrame latest = look_hidden(angle_rad, kFound);
  ASSERT_EQ(latest.trust.cause, DoubtCause::kHidden);
  do {
    latest = look_hidden(angle_rad += 0.03, 0);
    ASSERT_FALSE(latest.is_lost());
    EXPECT_LT(latest.evidence.inliers, 15);
  } while (latest.evidence.visible_landmarks > 20 && angle_rad < 2);
  EXPECT_LT(angle_rad, 2);
  EXPECT_EQ(latest.trust.cause, DoubtCause::kHidden);
}

/// The camera turns away from the map, held by keypoints of the previous frame that are no landmarks, and
/// back.
TEST_F(TrackerOutcome, AfterAPoseOfAFewLandmarksAFewMoreAreInDoubtToo) {
  build_map();
  double angle_rad = 0.05;
  TrackedFrame latest = turn_into_doubt(angle_rad);
  ASSERT_FALSE(latest.is_lost());
  EXPECT_LT(latest.evidence.inliers, 15);
  bool few_in_doubt = false;
  while (latest.is_doubtful()) {
    latest = show(turned(angle_rad -= 0.01));
    ASSERT_FALSE(latest.is_lost());
    few_in_doubt |= latest.is_doubtful() && latest.evidence.inliers >= 15;
  }
  EXPECT_TRUE(few_in_doubt);
  EXPECT_GE(latest.evidence.inliers, 30);
}

/// Held by keypoints of the previous frame, it could stay in doubt for ever.
TEST_F(TrackerOutcome, ACameraThatStaysInDoubtBesideTheMapStartsANewMap) {
  build_map();
  show(pose(1.5));
  relocalize_ = [](const Frame&) { return std::nullopt; };
  double angle_rad = 0.05;
  TrackedFrame latest = turn_into_doubt(angle_rad);
  const int64_t doubtful_since_ns = latest.stamp_ns;
  while (latest.is_doubtful() && id_ < 400) latest = show(turned(angle_rad));
  EXPECT_EQ(latest.outcome, TrackingOutcome::kNewMap);
  EXPECT_GE(latest.stamp_ns - doubtful_since_ns, 5'000'000'000);
}

TEST_F(TrackerOutcome, ACameraIsNotRelocalizedWhereItCannotHaveGot) {
  build_map();
  show(pose(1.5));
  relocalize_ = [](const Frame& frame) { return found_away(frame, 2); };
  EXPECT_TRUE(show(elsewhere()).is_lost());
  id_ += 60;  // two seconds later
  EXPECT_EQ(show(elsewhere()).outcome, TrackingOutcome::kRelocalized);
}

TEST_F(TrackerOutcome, InDoubtACameraIsNotRecognizedWhereItCannotHaveGotSinceItsLastPoseBeyondDoubt) {
  build_map();
  show(pose(1.5));
  relocalize_ = [](const Frame& frame) { return found_away(frame, 5); };
  double angle_rad = 0.05;
  TrackedFrame latest = turn_into_doubt(angle_rad);
  const int64_t doubtful_since_ns = latest.stamp_ns;
  while (latest.is_doubtful() && id_ < 400) latest = show(turned(angle_rad));
  EXPECT_EQ(latest.outcome, TrackingOutcome::kRelocalized);
  EXPECT_GE(latest.stamp_ns - doubtful_since_ns, 2'000'000'000) << "at 1 m/s^2, beside half a metre of drift";
}

TEST_F(TrackerOutcome, PreviousFrameIsExpressedInANewReference) {
  build_map();
  show(pose(1.5));
  const KeyframeId other{tracker_.reference() == KeyframeId{0} ? 2U : 0U};
  tracker_.update(built_.map, other);
  const TrackedFrame next = show(pose(1.7));
  ASSERT_EQ(next.outcome, TrackingOutcome::kTracked);
  EXPECT_EQ(next.reference, other);
  EXPECT_EQ(next.evidence.attempts, 1);  // found at its predicted pose
  EXPECT_LT(error_m(next, pose(1.7)), 0.003);
}

TEST_F(TrackerOutcome, UnknownPlaceIsLostThenStartsANewMap) {
  build_map();
  show(pose(1.5));
  EXPECT_EQ(show(elsewhere()).outcome, TrackingOutcome::kLost);
  EXPECT_EQ(show(elsewhere()).outcome, TrackingOutcome::kLost);
  EXPECT_EQ(show(elsewhere()).outcome, TrackingOutcome::kNewMap);
}

TEST_F(TrackerOutcome, BehindSomethingThatMovesTheCameraIsHiddenNotElsewhere) {
  build_map();
  TrackedFrame latest = show(pose(1.5));
  latest.moved = cv::Mat::ones(60, 80, CV_8UC1);
  latest.evidence.moved_share = 1;  // by surfaces
  tracker_.update(latest, built_.map);
  for (int i = 0; i < 5; ++i) EXPECT_EQ(show(elsewhere()).outcome, TrackingOutcome::kLost);
  id_ += 150;  // more than 5 s later
  EXPECT_EQ(show(elsewhere()).outcome, TrackingOutcome::kNewMap);
}

TEST_F(TrackerOutcome, AfterLongDoubtThePlaceIsRecognizedAnew) {
  build_map();
  relocalize_ = [this](const Frame& frame) -> std::optional<TrackedFrame> {
    if (frame.id.value == 0) return places_.relocalize(frame, built_.map);
    return found_away(frame, 2);
  };
  const auto few = [this] {
    return with_fewer_features(test::observe(world_, pose(1.5), {}, 100 + id_), 59);
  };
  TrackedFrame latest = show(few());  // relocalized on weak evidence, which nothing confirms
  ASSERT_TRUE(latest.is_doubtful());
  for (latest = show(few()); latest.outcome == TrackingOutcome::kTracked && id_ < 30; latest = show(few()))
    EXPECT_TRUE(latest.is_doubtful());
  EXPECT_EQ(latest.outcome, TrackingOutcome::kRelocalized);
  EXPECT_GT(latest.id.value, 15U);  // half a second
  EXPECT_FALSE(latest.is_doubtful());
}

TEST_F(TrackerOutcome, ReturningCameraIsRelocalized) {
  build_map();
  show(pose(1.5));
  show(elsewhere());
  show(elsewhere());
  const TrackedFrame back = show(pose(0.5));
  ASSERT_TRUE(back.is_located());
  EXPECT_LT(error_m(back, pose(0.5)), 0.004);
}

TEST_F(TrackerOutcome, TrackHasNoSideEffects) {
  build_map();
  show(pose(1.5));
  const auto view = test::observe(world_, pose(1.7), {}, 9);
  Frame frame = test::make_frame(50, view);
  frame.gray.setTo(200);
  const TrackingContext context{built_.map, sensor_, relocalize_};
  const TrackedFrame once = tracker_.track(frame, context);
  const TrackedFrame again = tracker_.track(frame, context);
  ASSERT_TRUE(once.is_located());
  ASSERT_TRUE(again.is_located());
  EXPECT_EQ(once.T_reference_camera.translation, again.T_reference_camera.translation);
}

}  // namespace
}  // namespace kinloop
