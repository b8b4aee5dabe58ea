#include "kinloop/tracking/keypoint_tracking.hpp"

#include <gtest/gtest.h>

#include "kinloop/tracking/keyframe_policy.hpp"
#include "kinloop/tracking/motion/motion_model.hpp"
#include "tests/support/synthetic_map.hpp"

namespace kinloop {
namespace {

using test::camera_at;

/// A map of one keyframe at the origin, the previous frame there, and the camera at another pose, with a
/// prediction uncertain by a centimetre and a degree.
PredictedPose uncertain(const SE3& T_reference_camera) {
  return {T_reference_camera, 0.01, 0.02};
}

class KeypointTracking : public testing::Test {
 protected:
  KeypointTracking() {
    const auto view = test::observe(world_, SE3{}, {}, 2);
    const KeyframeId keyframe = test::add_view(built_, world_, view, SE3{});
    local_map_ = make_local_map(built_.map, keyframe, {});
    previous_ = test::tracked_as(keyframe, built_.map, test::make_frame(0, view));
  }

  [[nodiscard]] TrackedFrame track(const Frame& frame, const PredictedPose& predicted) const {
    return track_keypoints({frame, local_map_, sensor_, options_}, previous_, predicted, 4);
  }

  [[nodiscard]] TrackedFrame track_at(const SE3& T_world_camera, const SE3& predicted,
                                      const test::ObservationNoise& noise = {}) const {
    const auto view = test::observe(world_, T_world_camera, noise, 3);
    return track(test::make_frame(1, view), uncertain(predicted));
  }

  test::SyntheticWorld world_ = test::make_world(4000, 1);
  test::SyntheticMap built_;
  LocalMap local_map_;
  TrackedFrame previous_;
  Sensor sensor_{world_.camera};
  TrackingOptions options_;
};

TEST_F(KeypointTracking, FollowsASmallMotion) {
  const SE3 truth = camera_at(0.05, {0.03, 0.01, -0.02});
  const TrackedFrame result = track_at(truth, SE3{});
  ASSERT_TRUE(result.is_located());
  EXPECT_GT(result.evidence.inliers, 150);
  EXPECT_LT(test::distance_m(result.T_reference_camera, truth), 0.005);
  EXPECT_LT(test::angle_rad(result.T_reference_camera, truth), 0.002);
}

TEST_F(KeypointTracking, MatchesVisibleLandmarks) {
  const SE3 truth = camera_at(0.05, {0.03, 0.01, -0.02});
  const auto view = test::observe(world_, truth, {}, 3);
  const TrackedFrame result = track(test::make_frame(1, view), uncertain(SE3{}));
  ASSERT_FALSE(result.matches.empty());
  for (const LandmarkMatch& match : result.matches) {
    EXPECT_EQ(match.landmark, built_.landmark_of_point.at(view.point_of[match.feature]));
  }
}

TEST_F(KeypointTracking, RecoversFromAnUnpredictedJump) {
  const SE3 truth = camera_at(0.35, {0.15, 0.05, 0.1});
  const TrackedFrame result = track_at(truth, SE3{});
  ASSERT_TRUE(result.is_located());
  EXPECT_GT(result.evidence.attempts, 1);
  EXPECT_LT(test::distance_m(result.T_reference_camera, truth), 0.006);
}

TEST_F(KeypointTracking, UsesTheMapWhenDepthIsMissing) {
  const SE3 truth = camera_at(0.04, {0.02, 0, 0});
  const TrackedFrame result = track_at(truth, SE3{}, {0.5, 1.425e-3, 12, 1.0});
  ASSERT_TRUE(result.is_located());
  EXPECT_LT(test::distance_m(result.T_reference_camera, truth), 0.005);
}

TEST_F(KeypointTracking, IsLostInAnUnknownPlace) {
  const TrackedFrame result = track_at(camera_at(3.14159, {0, 0, 0}), SE3{});
  EXPECT_TRUE(result.is_lost());
  EXPECT_TRUE(result.matches.empty());
}

TEST_F(KeypointTracking, IsLostOnABlackImage) {
  test::SyntheticView nothing;
  nothing.features = std::make_shared<const Features>();
  const TrackedFrame result = track(test::make_frame(1, nothing), uncertain(SE3{}));
  EXPECT_TRUE(result.is_lost());
}

/// A wall 2 m ahead with a texture too smooth for corners, seen from `x_m` to the right.
Frame soft_wall(const PinholeCamera& camera, double x_m) {
  constexpr double kWall_m = 2;
  Frame frame;
  frame.features = std::make_shared<const Features>();
  frame.depth_m = cv::Mat(camera.height, camera.width, CV_32FC1, cv::Scalar(kWall_m));
  frame.gray.create(camera.height, camera.width, CV_8UC1);
  for (int y = 0; y < camera.height; ++y) {
    for (int x = 0; x < camera.width; ++x) {
      const Eigen::Vector3d p = camera.unproject(Eigen::Vector2d(x, y), kWall_m);
      const double value = 128 + 50 * std::sin(6 * (p.x() + x_m)) + 50 * std::sin(5 * p.y());
      frame.gray.at<uint8_t>(y, x) = cv::saturate_cast<uint8_t>(value);
    }
  }
  return frame;
}

TEST_F(KeypointTracking, FallsBackToDenseAlignmentWithoutKeypoints) {
  previous_ = unlocated(soft_wall(world_.camera, 0));
  previous_.outcome = TrackingOutcome::kTracked;
  previous_.reference = local_map_.reference;
  previous_.frame = std::make_shared<const Frame>(soft_wall(world_.camera, 0));
  const SE3 truth = camera_at(0, {0.02, 0, 0});
  const Frame frame = soft_wall(world_.camera, 0.02);
  const TrackedFrame result = track(frame, uncertain(SE3{}));
  EXPECT_EQ(result.method, TrackingMethod::kDense);
  EXPECT_LT(test::distance_m(result.T_reference_camera, truth), 0.0003);
  EXPECT_LT(test::angle_rad(result.T_reference_camera, truth), 0.0001);

  options_.icp.photometric_weight = 0;
  const TrackedFrame by_depth = track(frame, uncertain(SE3{}));
  EXPECT_EQ(by_depth.method, TrackingMethod::kDense);
  EXPECT_GT(test::distance_m(by_depth.T_reference_camera, truth), 0.015) << "a wall does not constrain it";
  EXPECT_GT(by_depth.covariance(0, 0), 100 * result.covariance(0, 0)) << "and the covariance shows it";
}

TEST_F(KeypointTracking, GivesTheSameResultTwice) {
  const SE3 truth = camera_at(0.35, {0.15, 0.05, 0.1});
  const TrackedFrame a = track_at(truth, SE3{}), b = track_at(truth, SE3{});
  EXPECT_EQ(a.T_reference_camera.matrix(), b.T_reference_camera.matrix());
  EXPECT_EQ(a.matches.size(), b.matches.size());
}

TEST_F(KeypointTracking, CovarianceIsConsistentWithTheErrors) {
  // The squared error in units of the reported covariance has mean 6 (chi2 with 6 degrees of freedom).
  double sum = 0;
  constexpr int kTrials = 40;
  for (uint64_t trial = 0; trial < kTrials; ++trial) {
    const SE3 truth = camera_at(0.01 * static_cast<double>(trial % 5), {0.02, 0, 0.01});
    const auto view = test::observe(world_, truth, {1.0, 2.85e-3, 12, 0.2}, 100 + trial);
    // Exact landmarks isolate the noise of the frame itself.
    LocalMap exact = local_map_;
    for (size_t i = 0; i < exact.size(); ++i) {
      for (const auto& [point, landmark] : built_.landmark_of_point) {
        if (landmark == exact.ids[i]) exact.p_reference[i] = world_.p_world[point];
      }
    }
    const TrackedFrame result = track_keypoints({test::make_frame(1, view), exact, sensor_, options_},
                                                previous_, uncertain(truth), trial);
    ASSERT_TRUE(result.is_located());
    const Vector6d error = (result.T_reference_camera.inverse() * truth).log();
    sum += error.dot(result.covariance.inverse() * error);
  }
  EXPECT_GT(sum / kTrials, 3.0);
  EXPECT_LT(sum / kTrials, 12.0);
}

TEST(MotionModel, ExtrapolatesTheVelocity) {
  MotionModel motion;
  EXPECT_EQ(motion.predict(1'000'000).T.translation.norm(), 0);
  const SE3 step = camera_at(0.02, {0.01, 0, 0});
  motion.update(motion.velocity_of(step, 33'000'000), 33'000'000);
  EXPECT_LT((motion.predict(33'000'000).T.inverse() * step).log().norm(), 1e-12);
  EXPECT_LT((motion.predict(66'000'000).T.inverse() * (step * step)).log().norm(), 1e-12);
  EXPECT_LT(motion.predict(10'000'000'000).T.translation.norm(),
            0.2);                                 // a long gap is not extrapolated blindly
  motion.update(motion.velocity_of(step, 0), 0);  // a repeated stamp is ignored
  EXPECT_TRUE(motion.predict(33'000'000).T.is_finite());
  motion.reset();
  EXPECT_EQ(motion.predict(33'000'000).T.translation.norm(), 0);
}

TEST(MotionModel, FramesAMicrosecondApartGiveNoVelocity) {
  MotionModel motion;
  const SE3 moved{exp_so3(Eigen::Vector3d::Zero()), {0.001, 0, 0}};
  motion.update(motion.velocity_of(moved, 33'000'000), 33'000'000);
  const PredictedPose before = motion.predict(33'000'000);
  motion.update(motion.velocity_of(moved, 1'000), 1'000);
  const PredictedPose after = motion.predict(33'000'000);
  EXPECT_EQ(after.T.translation, before.T.translation);
  EXPECT_EQ(after.sigma_m, before.sigma_m);
}

TEST(MotionModel, UncertaintyGrowsWithTime) {
  MotionModel motion;
  motion.update(motion.velocity_of(camera_at(0.02, {0.01, 0, 0}), 33'000'000), 33'000'000);
  const PredictedPose soon = motion.predict(33'000'000), late = motion.predict(330'000'000);
  EXPECT_GT(soon.sigma_m, 0);
  EXPECT_GT(soon.sigma_rad, 0);
  EXPECT_GT(late.sigma_m, 10 * soon.sigma_m);
  EXPECT_GT(late.sigma_rad, 10 * soon.sigma_rad);
  motion.reset();
  EXPECT_GT(motion.predict(33'000'000).sigma_m,
            soon.sigma_m);  // an unknown motion is less certain than a known one
}

TEST(MotionModel, UncertaintyFollowsTheMotion) {
  // Velocities that perform a random walk, as the model assumes: its uncertainty must be right on average.
  Random random(5);
  MotionModel motion;
  constexpr int64_t kStep_ns = 40'000'000;
  constexpr double kStep_s = 0.04;
  Vector6d velocity = Vector6d::Zero();
  double shift = 0, turn = 0;
  int count = 0;
  for (int i = 0; i < 4000; ++i) {
    for (int k = 0; k < 6; ++k) velocity[k] = 0.98 * velocity[k] + (k < 3 ? 0.05 : 0.2) * random.gaussian();
    const SE3 step = SE3::exp(velocity * kStep_s);
    if (i > 100) {
      const PredictedPose predicted = motion.predict(kStep_ns);
      const Vector6d error = (predicted.T.inverse() * step).log();
      shift += error.head<3>().squaredNorm() / (3 * predicted.sigma_m * predicted.sigma_m);
      turn += error.tail<3>().squaredNorm() / (3 * predicted.sigma_rad * predicted.sigma_rad);
      ++count;
    }
    motion.update(motion.velocity_of(step, kStep_ns), kStep_ns);
  }
  EXPECT_NEAR(shift / count, 1, 0.1);
  EXPECT_NEAR(turn / count, 1, 0.1);
}

class KeyframePolicy : public testing::Test {
 protected:
  [[nodiscard]] bool asks(const SE3& T_last_keyframe_camera, int inliers, int reference_landmarks) {
    result_.evidence.inliers = inliers;
    return needs_keyframe({result_, {T_last_keyframe_camera}, 5, reference_landmarks}, {});
  }

  KeyframePolicy() {
    const Frame frame = test::make_frame(1, test::observe(test::make_world(3000, 1), SE3{}, {}, 2));
    result_ = unlocated(frame);
    result_.outcome = TrackingOutcome::kTracked;
    result_.frame = std::make_shared<const Frame>(frame);
  }

  TrackedFrame result_;
};

TEST_F(KeyframePolicy, NoKeyframeForAStationaryCamera) {
  EXPECT_FALSE(asks(SE3{}, 30, 300));
}

TEST_F(KeyframePolicy, LargeRotationOrTranslationTriggersAKeyframe) {
  EXPECT_TRUE(asks(camera_at(0.5, {0, 0, 0}), 300, 300));
  EXPECT_TRUE(asks(camera_at(0, {1, 0, 0}), 300, 300));
  EXPECT_FALSE(asks(camera_at(0.02, {0.02, 0, 0}), 300, 300));
}

TEST_F(KeyframePolicy, DirectTrackingSpacesKeyframesByTranslationNotByRotation) {
  result_.evidence.inliers = 300;
  const KeyframeOptions options, direct = spaced_for_direct_tracking(options);
  const auto motion = [&](const SE3& T, const KeyframeOptions& o) {
    return motion_from_nearest(result_.features(), std::vector{T}, o);
  };
  const SE3 turned = camera_at(0.25, {0, 0, 0}), shifted = camera_at(0, {0.25, 0, 0});
  EXPECT_DOUBLE_EQ(motion(turned, direct), motion(turned, options));
  EXPECT_LT(motion(shifted, direct), motion(shifted, options));
  // A motion between the two limits triggers a keyframe only without direct tracking.
  const double share = 1.2 / motion(shifted, options);
  const SE3 between = camera_at(0, {0.25 * share, 0, 0});
  EXPECT_TRUE(needs_keyframe({result_, {between}, 5, 300}, options));
  EXPECT_FALSE(needs_keyframe({result_, {between}, 5, 300}, direct));
  EXPECT_TRUE(needs_keyframe({result_, {turned}, 5, 300}, direct));
}

TEST_F(KeyframePolicy, LowOverlapTriggersAKeyframeOnceTheCameraMoves) {
  EXPECT_TRUE(asks(camera_at(0.1, {0.05, 0, 0}), 100, 300));
  EXPECT_FALSE(asks(camera_at(0.1, {0.05, 0, 0}), 290, 300));
}

TEST_F(KeyframePolicy, NoKeyframeNearAnExistingOne) {
  result_.evidence.inliers = 100;  // of 300: tracking weakens
  const SE3 far_off = camera_at(0.5, {1, 0, 0}), on_the_way = camera_at(0.15, {0, 0, 0}),
            near_by = camera_at(0.01, {0.01, 0, 0});
  EXPECT_TRUE(needs_keyframe({result_, {far_off, on_the_way}, 5, 300}, {}));
  EXPECT_FALSE(needs_keyframe({result_, {far_off, near_by}, 5, 300}, {}));
}

TEST_F(KeyframePolicy, WeakEvidenceExtendsTheMap) {
  doubt(result_, DoubtCause::kFewLandmarks);
  EXPECT_TRUE(may_extend_map(result_)) << "the camera leaves the map";
  result_.evidence.visible_landmarks = 300;
  result_.evidence.inliers = 10;
  EXPECT_FALSE(may_extend_map(result_)) << "something hides the mapped place";
  result_.evidence.visible_landmarks = 3 * static_cast<int>(result_.features().size());
  EXPECT_TRUE(may_extend_map(result_)) << "the image is blurred";
  result_.evidence.visible_landmarks = 300;
  result_.evidence.inliers = 100;
  EXPECT_TRUE(may_extend_map(result_));
}

TEST_F(KeyframePolicy, EvidenceAgainstThePoseDoesNotExtendTheMap) {
  for (const DoubtCause cause : {DoubtCause::kSurfaces, DoubtCause::kScale, DoubtCause::kPlace}) {
    result_.trust = {};
    doubt(result_, cause);
    EXPECT_FALSE(may_extend_map(result_)) << name_of(cause);
  }
}

TEST_F(KeyframePolicy, DenseOdometryExtendsTheMapWhereThereAreKeypoints) {
  result_.method = TrackingMethod::kDense;
  EXPECT_TRUE(asks(camera_at(0.5, {0, 0, 0}), 0, 300));
  Frame dark = *result_.frame;
  dark.features = std::make_shared<const Features>();
  result_.frame = std::make_shared<const Frame>(dark);
  EXPECT_FALSE(asks(camera_at(0.5, {0, 0, 0}), 0, 300));
}

TEST(MotionsFromKeyframes, CoverTheLastAndTheCovisibleKeyframes) {
  const auto world = test::make_world(3000, 1);
  const std::vector<SE3> poses{SE3{}, camera_at(0.1, {0.1, 0, 0}), camera_at(3.1, {0, 0, 0}),
                               camera_at(3.1, {0, 0.1, 0})};
  test::SyntheticMap built;
  for (const SE3& pose : poses) test::add_view(built, world, test::observe(world, pose, {}, 2), pose);
  TrackedFrame result;
  result.outcome = TrackingOutcome::kTracked;
  result.reference = KeyframeId{0};
  result.T_reference_camera = camera_at(0.05, {0.05, 0, 0});
  const auto& landmark_of = built.map.keyframe(KeyframeId{0}).landmark_of;
  for (uint32_t i = 0; i < landmark_of.size(); ++i) {
    if (landmark_of[i].valid()) result.matches.push_back({landmark_of[i], i});
  }
  const auto motions = motions_from_keyframes(built.map, result);
  ASSERT_EQ(motions.size(), 3U);  // relative to 3, the last, and to 0 and 1, but not to 2
  EXPECT_LT(test::distance_m(motions[0], poses[3].inverse() * result.T_reference_camera), 1e-12);
  EXPECT_LT(test::distance_m(motions[1], result.T_reference_camera), 1e-12);
  EXPECT_LT(test::distance_m(motions[2], poses[1].inverse() * result.T_reference_camera), 1e-12);

  result.matches.clear();  // tracked only by points of the previous frame, so no keyframe shares landmarks
  EXPECT_EQ(motions_from_keyframes(built.map, result).size(), 1U);
}

TEST(MotionsFromKeyframes, LeaveOutTheNewestKeyframeInAnotherComponent) {
  const auto world = test::make_world(3000, 1);
  test::SyntheticMap built;
  const auto view = test::observe(world, SE3{}, {}, 2);
  const KeyframeId first = test::add_view(built, world, view, SE3{});
  TrackedFrame tracked;
  tracked.outcome = TrackingOutcome::kTracked;
  tracked.reference = first;
  EXPECT_EQ(motions_from_keyframes(built.map, tracked).size(), 1U);
  built.map.add_keyframe(FrameId{9}, 9, SE3{}, view.features, 1);
  EXPECT_TRUE(motions_from_keyframes(built.map, tracked).empty());
}

TEST_F(KeyframePolicy, ALostFrameNeverBecomesAKeyframe) {
  result_.outcome = TrackingOutcome::kLost;
  EXPECT_FALSE(needs_keyframe({result_, {camera_at(1, {1, 1, 1})}, 5, 300}, {}));
  EXPECT_FALSE(may_extend_map(result_));
}

}  // namespace
}  // namespace kinloop
