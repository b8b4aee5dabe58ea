#include <limits>

#include <Eigen/Cholesky>
#include <gtest/gtest.h>

#include "kinloop/back_end/final/final_pass.hpp"
#include "kinloop/core/random.hpp"
#include "kinloop/core/time.hpp"

namespace kinloop {
namespace {

constexpr int kFrames = 1200, kInterval = 6;
constexpr double kShared_m = 2e-3, kShared_rad = 1e-3;  // errors that the keypoints of a frame share

SE3 true_pose(int frame) {
  const double t = frame / 30.0;
  return {exp_so3({0.1 * t, 0.3 * t, 0}), {0.2 * t, 0, 0.1 * t}};
}

/// A chain of keyframes and the frames between them, each off by an error of its own.
struct Chain {
  Map map;
  FrameLog log;
  /// Of the residuals alone, which do not show the shared errors.
  std::vector<Matrix6d> of_residuals;

  Chain() {
    Random random(5);
    for (int i = 0; i < kFrames; ++i) {
      Vector6d off;
      for (int k = 0; k < 6; ++k) off(k) = (k < 3 ? kShared_m : kShared_rad) * random.gaussian();
      const SE3 estimated = true_pose(i) * SE3::exp(off);
      LoggedFrame entry;
      entry.stamp_ns = to_ns(i / 30.0);
      entry.outcome = TrackingOutcome::kTracked;
      entry.covariance = 1e-8 * Matrix6d::Identity();
      if (i % kInterval == 0) {
        entry.keyframe = map.add_keyframe(FrameId{static_cast<uint32_t>(i)}, entry.stamp_ns, estimated,
                                          std::make_shared<const Features>(), 0);
        of_residuals.push_back((i == 0 ? 0 : 1e-8) * Matrix6d::Identity());
      }
      entry.reference = map.keyframes().back().id;
      entry.T_reference_camera = map.keyframe(entry.reference).T_world_camera.inverse() * estimated;
      log.push_back(entry);
    }
  }
};

/// Mean normalised squared errors of translation and rotation, aligned at the first pose.
Eigen::Vector2d mean_nees(const Chain& chain, const std::vector<Matrix6d>& of_frame, bool of_keyframes) {
  const SE3 T_world_truth = chain.log[0].world(chain.map) * true_pose(0).inverse();
  Eigen::Vector2d sum(0, 0);
  int count = 0;
  for (int i = 1; i < kFrames; ++i) {
    const auto index = static_cast<size_t>(i);
    if (chain.log[index].keyframe.valid() != of_keyframes) continue;
    const Vector6d e = (chain.log[index].world(chain.map).inverse() * T_world_truth * true_pose(i)).log();
    const Eigen::Matrix3d translation = of_frame[index].topLeftCorner<3, 3>(),
                          rotation = of_frame[index].bottomRightCorner<3, 3>();
    sum += Eigen::Vector2d(e.head<3>().dot(translation.llt().solve(e.head<3>())),
                           e.tail<3>().dot(rotation.llt().solve(e.tail<3>())));
    ++count;
  }
  return sum / count;
}

TEST(PoseCovariances, AreThoseOfErrorsThatTheKeypointsOfAFrameShare) {
  const Chain chain;
  const auto found = pose_covariances(chain.log, chain.map, chain.of_residuals);
  for (const bool of_keyframes : {true, false}) {
    const Eigen::Vector2d nees = mean_nees(chain, found.frames, of_keyframes);
    EXPECT_GT(nees.minCoeff(), 1.5) << of_keyframes;  // 3 is right
    EXPECT_LT(nees.maxCoeff(), 6) << of_keyframes;
  }
}

TEST(PoseCovariances, AreThoseOfAWrongScale) {
  const Chain chain;
  constexpr double kScaleSigma = 0.01;
  const auto without = pose_covariances(chain.log, chain.map, chain.of_residuals),
             with = pose_covariances(chain.log, chain.map, chain.of_residuals, kScaleSigma);
  const SE3 T_first_world = chain.log[0].world(chain.map).inverse();
  for (const size_t i : {size_t{0}, size_t{6}, size_t{100}, size_t{kFrames - 1}}) {
    const SE3 T_first_camera = T_first_world * chain.log[i].world(chain.map);
    const SE3 larger{T_first_camera.rotation, (1 + kScaleSigma) * T_first_camera.translation};
    const Vector6d off = (T_first_camera.inverse() * larger).log();
    const Matrix6d added = with.frames[i] - without.frames[i];
    EXPECT_LT((added - off * off.transpose()).norm(), 1e-9) << i;
  }
}

TEST(PoseCovariances, OfFramesIncludeThatOfTheirKeyframe) {
  Chain chain;
  const auto before = pose_covariances(chain.log, chain.map, chain.of_residuals);
  for (Matrix6d& covariance : chain.of_residuals) covariance *= 1e4;
  const auto after = pose_covariances(chain.log, chain.map, chain.of_residuals);
  for (const size_t i : {20U, 600U}) {
    const Matrix6d added = after.frames[i] - before.frames[i];
    EXPECT_GE(added.topLeftCorner(3, 3).trace(), 3 * 0.99e-4) << i;
  }
}

TEST(PoseCovariances, OfKeyframesInTheLogAreThoseOfTheMap) {
  const Chain chain;
  const auto found = pose_covariances(chain.log, chain.map, chain.of_residuals);
  EXPECT_TRUE(found.keyframes[0].isZero(0));  // the reference
  for (size_t i = 0; i < chain.log.size(); i += kInterval) {
    EXPECT_EQ(found.frames[i], found.keyframes[chain.log[i].keyframe.value]);
  }
}

TEST(PoseCovariances, AreUnknownForLostFramesAndUnobservedKeyframes) {
  Chain chain;
  chain.log[10].outcome = TrackingOutcome::kLost;
  chain.of_residuals[50] = Vector6d::Constant(std::numeric_limits<double>::infinity()).asDiagonal();
  const auto found = pose_covariances(chain.log, chain.map, chain.of_residuals);
  EXPECT_TRUE(found.frames[10].isZero(0));
  EXPECT_TRUE(found.frames[50 * kInterval + 1].isZero(0));
  ASSERT_EQ(found.frames.size(), chain.log.size());
  for (const Matrix6d& covariance : found.frames) EXPECT_TRUE(covariance.allFinite());
}

}  // namespace
}  // namespace kinloop
