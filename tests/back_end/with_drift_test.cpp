#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "kinloop/back_end/final/final_pass.hpp"

namespace kinloop {
namespace {

constexpr uint32_t kKeyframes = 20;
constexpr double kVariance = 1e-6;  // of the position after each step, m^2

std::shared_ptr<const Features> some_features(size_t count) {
  Features features;
  features.pixels.resize(count);
  features.depths_m.resize(count, 1);
  return std::make_shared<const Features>(std::move(features));
}

/// Of the sideways positions of an exact adjustment, by keyframe.
std::vector<double> sigmas_m(const Map& map) {
  std::vector<double> sigmas;
  const std::vector<Matrix6d> exact(map.keyframes().size(), Matrix6d::Zero());
  for (const Matrix6d& covariance : with_drift(exact, map)) sigmas.push_back(std::sqrt(covariance(1, 1)));
  return sigmas;
}

/// Keyframes one metre apart, each tracked against the one before. All share landmarks with their neighbour.
struct Walk {
  Map map;

  Walk() {
    const auto features = some_features(200);
    for (uint32_t k = 0; k < kKeyframes; ++k) {
      map.add_keyframe(FrameId{k}, k, SE3{Eigen::Quaterniond::Identity(), {1.0 * k, 0, 0}}, features);
      OdometryStep step{k == 0 ? KeyframeId{} : KeyframeId{k - 1}, kVariance * Matrix6d::Identity()};
      step.covariance.bottomRightCorner<3, 3>() *= 1e-6;  // so that positions alone add up
      map.set_odometry(KeyframeId{k}, step);
      if (k > 0) share(k - 1, k, 0);
    }
  }

  /// Lets two keyframes share 50 landmarks, from these keypoints on.
  void share(uint32_t a, uint32_t b, uint32_t first_feature) {
    for (uint32_t i = first_feature; i < first_feature + 50; ++i) {
      const LandmarkId landmark = map.add_landmark(KeyframeId{a}, i, {0, 0, 1});
      map.add_observation(landmark, {KeyframeId{b}, 50 + i});
    }
  }

  [[nodiscard]] std::vector<double> sigmas_m() const { return kinloop::sigmas_m(map); }
};

TEST(WithDrift, AddUpWhereTheCameraSeesNothingAgain) {
  const auto sigmas_m = Walk().sigmas_m();
  EXPECT_EQ(sigmas_m[0], 0);
  EXPECT_NEAR(sigmas_m[19] / sigmas_m[1], std::sqrt(19), 0.05);
}

TEST(WithDrift, ARevisitTiesBothVisitsTogether) {
  const auto open_m = Walk().sigmas_m();
  Walk closed;
  closed.share(0, 19, 100);
  const auto closed_m = closed.sigmas_m();
  EXPECT_LT(closed_m[19], 1.1 * open_m[1]);
  EXPECT_NEAR(closed_m[10] / open_m[10], std::sqrt(0.5), 0.05);  // of two ways of ten steps
}

TEST(WithDrift, NeighboursAreNoRevisits) {
  Walk walk;
  for (uint32_t k = 2; k < kKeyframes; ++k) walk.share(k - 2, k, 100);
  EXPECT_THAT(walk.sigmas_m(), testing::Pointwise(testing::DoubleNear(1e-9), Walk().sigmas_m()));
}

/// The adjustment holds the first keyframe of such a part constant: what it says is relative to that.
TEST(WithDrift, APartThatOnlyOdometryTiesHasTheUncertaintyOfThatStep) {
  Walk walk;
  constexpr uint32_t kFirst = 10;
  for (uint32_t i = 0; i < 50; ++i)
    walk.map.remove_observation(walk.map.keyframe(KeyframeId{kFirst}).landmark_of[50 + i],
                                {KeyframeId{kFirst}, 50 + i});
  constexpr double kStepVariance = 1e-2, kAdjustedVariance = 1e-4;
  OdometryStep step = *walk.map.keyframe(KeyframeId{kFirst}).odometry;
  step.covariance(1, 1) = kStepVariance;
  walk.map.set_odometry(KeyframeId{kFirst}, step);
  std::vector<Matrix6d> adjusted(kKeyframes, Matrix6d::Zero());
  for (uint32_t k = 1; k < kKeyframes; ++k) adjusted[k](1, 1) = k == kFirst ? 0 : kAdjustedVariance;
  const auto covariances = with_drift(adjusted, walk.map);
  EXPECT_NEAR(covariances[kFirst - 1](1, 1), kAdjustedVariance, 1e-5);
  EXPECT_NEAR(covariances[kFirst](1, 1), kAdjustedVariance + kStepVariance, 1e-4);
  EXPECT_NEAR(covariances[kKeyframes - 1](1, 1), 2 * kAdjustedVariance + kStepVariance, 1e-4);
}

TEST(WithDrift, ALoopTiesComponentsTogether) {
  Walk walk;
  walk.map.set_odometry(KeyframeId{10}, {});  // begins a component, which a loop has joined
  EXPECT_EQ(walk.sigmas_m()[10], 0) << "unknown";
  walk.map.add_loop_closure({.a = KeyframeId{0},
                             .b = KeyframeId{10},
                             .T_a_b = SE3{Eigen::Quaterniond::Identity(), {10, 0, 0}},
                             .information = 1e4 * Matrix6d::Identity(),
                             .stage = LoopStage::kVerified});
  EXPECT_NEAR(walk.sigmas_m()[10], 1e-2, 1e-6);
}

TEST(WithDrift, LoadedKeyframesAreExact) {
  const Walk fresh;
  MapData data = fresh.map.data();
  for (uint32_t k = 0; k < 10; ++k) data.keyframes[k].odometry.reset();
  Map map;
  map.append(std::move(data));
  const auto partly_m = sigmas_m(map), fresh_m = fresh.sigmas_m();
  for (uint32_t k = 0; k < 10; ++k) EXPECT_EQ(partly_m[k], 0) << k;
  EXPECT_NEAR(partly_m[19], fresh_m[10], 1e-9);
}

TEST(WithDrift, StepsOfUnknownCovarianceCountAsExact) {
  Walk walk;
  walk.map.set_odometry(KeyframeId{5}, {KeyframeId{4}});
  EXPECT_NEAR(walk.sigmas_m()[5], walk.sigmas_m()[4], 1e-5);
}

}  // namespace
}  // namespace kinloop
