#include "kinloop/tracking/evidence/surface_evidence.hpp"

#include <gtest/gtest.h>

namespace kinloop {
namespace {

/// A frame with 500 keypoints that matches `inliers` of 500 visible landmarks.
struct Found {
  explicit Found(int inliers) {
    Features features;
    features.pixels.resize(500);
    frame.features = std::make_shared<const Features>(features);
    tracked = unlocated(frame);
    tracked.outcome = TrackingOutcome::kTracked;
    tracked.evidence.visible_landmarks = 500;
    tracked.evidence.inliers = inliers;
  }
  Frame frame;
  TrackedFrame tracked;
};

bool contradicts(const SurfaceAgreement& agreement, int inliers) {
  const Found found(inliers);
  return contradicts_unexpected_pose(agreement, found.tracked, found.frame);
}

/// Whether a pose is in doubt, with the default bound of what dense odometry may accumulate.
bool is_in_doubt(const TrackedFrame& tracked, bool doubtful_before) {
  constexpr double kMaxSigma_m = 0.1;
  return cause_of_doubt(tracked, doubtful_before, kMaxSigma_m) != DoubtCause::kNone;
}

TEST(SurfaceEvidence, ContradictsFewChanceMatches) {
  EXPECT_TRUE(contradicts({2000, 200, 0}, 20));
  EXPECT_FALSE(contradicts({2000, 40, 0}, 20));
  EXPECT_FALSE(contradicts({2000, 40, 1500}, 20));  // occlusion says nothing
}

TEST(SurfaceEvidence, ManyLandmarksOutweighAPasserBy) {
  EXPECT_FALSE(contradicts({2000, 300, 0}, 250));
  EXPECT_TRUE(contradicts({2000, 300, 0}, 100));  // of 500: more than by chance, but not most of them
  EXPECT_TRUE(contradicts({2000, 2000, 0}, 250));
}

TEST(SurfaceEvidence, FewPointsDecideNothing) {
  EXPECT_FALSE(contradicts({50, 50, 0}, 20));
  EXPECT_FALSE(contradicts({}, 20));
}

TEST(SurfaceEvidence, DoubtsWhatMostOfTheViewContradicts) {
  TrackedFrame tracked = Found(200).tracked;
  tracked.evidence.surfaces = {2000, 200, 0};
  EXPECT_FALSE(is_in_doubt(tracked, false));
  tracked.evidence.surfaces = {2000, 1000, 0};
  EXPECT_TRUE(is_in_doubt(tracked, false));
  tracked.velocity.angular_rad_s = {0, 2, 0};  // the rolling shutter distorts both views
  EXPECT_FALSE(is_in_doubt(tracked, false));
  tracked.evidence.surfaces = {1000, 2000, 0};
  EXPECT_TRUE(is_in_doubt(tracked, false));
}

TEST(SurfaceEvidence, StaysInDoubtUntilFewPointsContradict) {
  TrackedFrame tracked = Found(200).tracked;
  tracked.evidence.surfaces = {1600, 400, 0};
  EXPECT_FALSE(is_in_doubt(tracked, false));
  EXPECT_TRUE(is_in_doubt(tracked, true));
  tracked.evidence.surfaces = {1900, 100, 0};
  EXPECT_FALSE(is_in_doubt(tracked, true));
}

TEST(SurfaceEvidence, DoubtsDenseOdometryThatIsUncertain) {
  TrackedFrame tracked = Found(0).tracked;
  tracked.covariance = Matrix6d::Identity() * 0.01 * 0.01;
  tracked.method = TrackingMethod::kDense;
  EXPECT_FALSE(is_in_doubt(tracked, false));
  tracked.covariance(1, 1) = 1;  // along a wall
  EXPECT_TRUE(is_in_doubt(tracked, false));
  tracked.method = TrackingMethod::kKeypoints;
  tracked.evidence.inliers = 200;
  EXPECT_FALSE(is_in_doubt(tracked, false));
}

TEST(SurfaceEvidence, DoubtsAPoseOfAFewLandmarks) {
  TrackedFrame tracked = Found(20).tracked;
  EXPECT_FALSE(is_in_doubt(tracked, false));
  tracked.evidence.inliers = 8;
  EXPECT_TRUE(is_in_doubt(tracked, false));
}

TEST(SurfaceEvidence, FindsThatTriangulatedLandmarksWithoutSurfacesDoNotHoldTheScale) {
  TrackedFrame tracked = Found(200).tracked;
  tracked.evidence.with_depth = 8;
  EXPECT_TRUE(lacks_scale(tracked, false));
  tracked.evidence.surfaces = {500, 0, 0};
  EXPECT_FALSE(lacks_scale(tracked, false));
}

TEST(SurfaceEvidence, RestoresTheScaleByLandmarksOfKnownDepthAlone) {
  TrackedFrame tracked = Found(200).tracked;
  tracked.evidence.surfaces = {500, 0, 0};
  tracked.evidence.with_depth = 8;
  EXPECT_TRUE(lacks_scale(tracked, true));
  tracked.evidence.with_depth = 20;
  EXPECT_FALSE(lacks_scale(tracked, true));
}

TEST(SurfaceEvidence, LeavesTheScaleOfAPoseThatThePreviousFrameHoldsAsItWas) {
  const TrackedFrame tracked = Found(8).tracked;
  EXPECT_FALSE(lacks_scale(tracked, false));
  EXPECT_TRUE(lacks_scale(tracked, true));
}

TEST(SurfaceEvidence, LeavesTheScaleOfDenseOdometryAsItWas) {
  TrackedFrame tracked = Found(0).tracked;
  tracked.method = TrackingMethod::kDense;
  EXPECT_FALSE(lacks_scale(tracked, false));
  EXPECT_TRUE(lacks_scale(tracked, true));
}

TEST(SurfaceEvidence, DoubtsAPoseIfHalfOfTheImageMoves) {
  TrackedFrame tracked = Found(200).tracked;
  tracked.evidence.moved_share = 0.4;
  EXPECT_FALSE(is_in_doubt(tracked, false));
  tracked.evidence.moved_share = 0.6;
  EXPECT_TRUE(is_in_doubt(tracked, false));
}

TEST(PositionSigma, IsThatOfTheLeastCertainDirection) {
  TrackedFrame tracked;
  EXPECT_EQ(position_sigma_m(tracked.covariance), 0);
  const Eigen::Matrix3d R = Eigen::AngleAxisd(1, Eigen::Vector3d(1, 2, 3).normalized()).toRotationMatrix();
  tracked.covariance.topLeftCorner<3, 3>() =
      R * Eigen::Vector3d(1e-4, 9e-4, 1e-6).asDiagonal() * R.transpose();
  tracked.covariance(4, 4) = 1;  // of the rotation
  EXPECT_NEAR(position_sigma_m(tracked.covariance), 0.03, 1e-9);
}

}  // namespace
}  // namespace kinloop
