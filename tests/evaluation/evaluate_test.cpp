#include "tools/evaluation/evaluate.hpp"

#include <cmath>
#include <numbers>
#include <string>
#include <tuple>

#include <fmt/format.h>
#include <gmock/gmock.h>

#include "kinloop/core/random.hpp"
#include "kinloop/core/time.hpp"
#include "tests/support/random_vectors.hpp"
#include "tests/support/shared_data.hpp"

namespace kinloop {
namespace {

constexpr int64_t kFrameNs = 33'000'000;
constexpr int64_t kStartNs = 1'305'031'910 * kNsPerSecond;

/// A winding path in all three dimensions, with rotation.
SE3 pose_on_path(double t_s) {
  return {exp_so3({0.3 * std::sin(t_s), 0.5 * t_s, 0.2 * std::cos(2 * t_s)}),
          {std::cos(t_s), 0.4 * std::sin(3 * t_s), 0.2 * t_s}};
}

Trajectory winding_path(size_t count) {
  Trajectory path;
  for (size_t i = 0; i < count; ++i) {
    const auto stamp_ns = static_cast<int64_t>(i) * kFrameNs;
    path.push_back({kStartNs + stamp_ns, pose_on_path(to_seconds(stamp_ns))});
  }
  return path;
}

SE3 some_motion() {
  return {exp_so3({0.4, -1.1, 0.7}), {3, -2, 5}};
}

Trajectory moved(const SE3& T, Trajectory path) {
  for (auto& pose : path) pose.T_world_camera = T * pose.T_world_camera;
  return path;
}

TEST(AbsoluteError, IsInvariantToTheWorldFrame) {
  const auto truth = winding_path(100);
  const auto ate = absolute_trajectory_error(moved(some_motion(), truth), truth);
  ASSERT_TRUE(ate);
  EXPECT_NEAR(ate->error_m.max, 0, 1e-9);
  EXPECT_EQ(ate->error_m.count, 100U);
  EXPECT_LT((ate->T_truth_estimate * some_motion()).log().norm(), 1e-9);
}

TEST(AbsoluteError, EqualsTheAddedNoise) {
  const auto truth = winding_path(3000);
  auto estimate = moved(some_motion(), truth);
  Random random(1);
  constexpr double kSigma = 0.02;
  for (auto& pose : estimate) {
    pose.T_world_camera.translation += kSigma * test::gaussian_vector<3>(random);
  }
  const auto ate = absolute_trajectory_error(estimate, truth);
  ASSERT_TRUE(ate);
  EXPECT_NEAR(ate->error_m.rmse, kSigma * std::sqrt(3.0), 0.02 * kSigma);
}

TEST(AbsoluteError, NoOtherAlignmentIsBetter) {
  const auto truth = winding_path(200);
  auto estimate = truth;
  Random random(2);
  for (auto& pose : estimate) pose.T_world_camera.translation.x() += 0.1 * random.uniform();
  const auto ate = absolute_trajectory_error(estimate, truth);
  ASSERT_TRUE(ate);
  for (int i = 0; i < 50; ++i) {
    Vector6d twist;
    for (int k = 0; k < 6; ++k) twist[k] = 0.01 * random.gaussian();
    const SE3 T_truth_estimate = SE3::exp(twist) * ate->T_truth_estimate;
    double sum = 0;
    for (size_t k = 0; k < truth.size(); ++k) {
      sum += (T_truth_estimate * estimate[k].T_world_camera.translation - truth[k].T_world_camera.translation)
                 .squaredNorm();
    }
    EXPECT_GE(std::sqrt(sum / static_cast<double>(truth.size())), ate->error_m.rmse);
  }
}

TEST(AbsoluteError, NamesTheErrorOfEachPose) {
  const auto truth = winding_path(300);
  auto estimate = truth;
  estimate[70].T_world_camera.translation.z() += 0.5;
  const auto ate = absolute_trajectory_error(estimate, truth);
  ASSERT_TRUE(ate);
  const auto worst = std::max_element(ate->poses.begin(), ate->poses.end(),
                                      [](const auto& a, const auto& b) { return a.error_m < b.error_m; });
  EXPECT_EQ(worst->stamp_ns, estimate[70].stamp_ns);
  EXPECT_NEAR(worst->error_m, 0.5, 0.02);
}

TEST(AbsoluteError, DoesNotScale) {
  const auto truth = winding_path(100);
  auto estimate = truth;
  for (auto& pose : estimate) pose.T_world_camera.translation *= 1.1;
  const auto ate = absolute_trajectory_error(estimate, truth);
  ASSERT_TRUE(ate);
  EXPECT_GT(ate->error_m.rmse, 0.05);
}

TEST(AbsoluteError, WithoutTruthAtTheSameTimeIsNothing) {
  const auto truth = winding_path(100);
  auto estimate = truth;
  for (auto& pose : estimate) pose.stamp_ns += 3600 * kNsPerSecond;
  EXPECT_FALSE(absolute_trajectory_error(estimate, truth));
  EXPECT_FALSE(absolute_trajectory_error({}, truth));
  EXPECT_FALSE(absolute_trajectory_error(truth, {}));
  EXPECT_FALSE(evaluate({}, {}));
}

TEST(Evaluate, ReportsDisjointTimeSpans) {
  const Trajectory path = winding_path(2);
  EXPECT_EQ(evaluation_failure({}, path),
            "fewer than three poses have ground truth within 0.02 s: the estimate is empty, the truth lasts "
            "from 1305031910.000000 to 1305031910.033000");
}

TEST(RelativeError, IsInvariantToTheWorldFrame) {
  const auto truth = winding_path(100);
  const auto rpe = relative_pose_error(moved(some_motion(), truth), truth);
  ASSERT_TRUE(rpe);
  EXPECT_NEAR(rpe->translation_m.max, 0, 1e-9);
  EXPECT_NEAR(rpe->rotation_deg.max, 0, 1e-6);
}

TEST(RelativeError, OfConstantRotationIsTheAnglePerInterval) {
  const auto truth = winding_path(200);
  auto estimate = truth;
  constexpr double kDriftRad = 1e-3;  // per frame
  for (size_t i = 0; i < estimate.size(); ++i) {
    estimate[i].T_world_camera.rotation = exp_so3({0, 0, kDriftRad * static_cast<double>(i)});
    estimate[i].T_world_camera.translation.setZero();
  }
  auto still = estimate;
  for (auto& pose : still) pose.T_world_camera = SE3();
  const auto frame = relative_pose_error(estimate, still, {1, RpeDelta::Unit::kFrames});
  const auto second = relative_pose_error(estimate, still, {1, RpeDelta::Unit::kSeconds});
  ASSERT_TRUE(frame && second);
  constexpr double kDegPerRad = 180 / std::numbers::pi;
  EXPECT_NEAR(frame->rotation_deg.rmse, kDriftRad * kDegPerRad, 1e-9);
  EXPECT_NEAR(second->rotation_deg.rmse, 30 * kDriftRad * kDegPerRad, 1e-9);  // 30 x 33 ms is closest to 1 s
  EXPECT_NEAR(frame->translation_m.max, 0, 1e-12);
}

TEST(RelativeError, AJumpIsSeenByThePairsAcrossItAlone) {
  const auto truth = winding_path(200);
  auto estimate = truth;
  const SE3 jump{Eigen::Quaterniond::Identity(), {0.3, 0, 0}};
  for (size_t i = 100; i < estimate.size(); ++i) {
    estimate[i].T_world_camera = jump * estimate[i].T_world_camera;
  }
  const auto rpe = relative_pose_error(estimate, truth, {1, RpeDelta::Unit::kFrames});
  ASSERT_TRUE(rpe);
  EXPECT_NEAR(rpe->translation_m.max, 0.3, 1e-9);
  EXPECT_NEAR(rpe->translation_m.rmse * std::sqrt(static_cast<double>(rpe->translation_m.count)), 0.3, 1e-9);
}

TEST(RelativeError, PosesFarFromAnyTruthAreLeftOut) {
  const auto truth = winding_path(200);
  Trajectory gap;
  for (size_t i = 0; i < truth.size(); ++i) {
    if (i < 80 || i >= 120) gap.push_back(truth[i]);
  }
  const auto all = relative_pose_error(truth, truth, {1, RpeDelta::Unit::kFrames});
  const auto rest = relative_pose_error(truth, gap, {1, RpeDelta::Unit::kFrames});
  ASSERT_TRUE(all && rest);
  EXPECT_EQ(all->translation_m.count, 198U);  // the TUM tool omits the pair that ends at the last pose
  // Truth up to two intervals away still counts: two more poses on either side of the gap.
  EXPECT_EQ(rest->translation_m.count, 198U - 37U);
}

TEST(RelativeError, OfPosesTooSparseForTheIntervalIsNothing) {
  const auto truth = winding_path(600);
  Trajectory sparse;
  for (size_t i = 0; i < truth.size(); i += 50) sparse.push_back(truth[i]);  // 1.65 s apart
  EXPECT_FALSE(relative_pose_error(sparse, truth));
  EXPECT_EQ(rpe_failure(sparse, {}), "the poses are too sparse: 1.65 s apart (median)");
  EXPECT_TRUE(relative_pose_error(sparse, truth, {1.65, RpeDelta::Unit::kSeconds}));
}

TEST(RelativeError, OverADistanceIsTheScaleError) {
  Trajectory truth, estimate;
  for (int i = 0; i < 200; ++i) {
    const SE3 pose{exp_so3({0, 0.01 * i, 0}), {0.02 * i, 0, 0}};
    truth.push_back({i * kFrameNs, pose});
    estimate.push_back({i * kFrameNs, {pose.rotation, 1.05 * pose.translation}});
  }
  const auto rpe = relative_pose_error(estimate, truth, {1.05, RpeDelta::Unit::kMeters});
  ASSERT_TRUE(rpe);
  EXPECT_GE(rpe->translation_m.count, 150U);  // and a few that are up to 10 % shorter
  EXPECT_NEAR(rpe->translation_m.max, 0.05, 1e-9);
  EXPECT_NEAR(rpe->rotation_deg.max, 0, 1e-6);
  EXPECT_FALSE(relative_pose_error(estimate, truth, {100, RpeDelta::Unit::kMeters}));
}

TEST(RpeDelta, IsParsedWithItsUnit) {
  for (const char* text : {"1 s", "10 f", "0.5 m"}) {
    std::string compact = text;
    std::erase(compact, ' ');
    const auto delta = parse_rpe_delta(compact);
    ASSERT_TRUE(delta) << text;
    EXPECT_EQ(to_string(*delta), text);
  }
  for (const char* text : {"", "s", "1", "-1s", "0m", "1.5f", "1km", "nanm", "1e9s", "9999999s"}) {
    EXPECT_FALSE(parse_rpe_delta(text)) << text;
  }
}

TEST(EvaluationOptions, TheOffsetIsAddedToTheEstimate) {
  const auto truth = winding_path(200);
  const auto late = shifted(truth, 2 * kNsPerSecond);
  EvaluationOptions options;
  options.offset_ns = -2 * kNsPerSecond;
  const auto found = evaluate(late, truth, options);
  ASSERT_TRUE(found && found->rpe_second);
  EXPECT_EQ(found->ate.error_m.count, 200U);
  EXPECT_LT(found->ate.error_m.max, 1e-9);
  EXPECT_EQ(found->ate.poses[0].stamp_ns, late[0].stamp_ns);
  EXPECT_EQ(found->coverage.matched_fraction, 1);
}

TEST(EvaluationOptions, PosesFartherApartThanAllowedAreNotCompared) {
  const auto truth = winding_path(200);
  EvaluationOptions options;
  options.offset_ns = 15'000'000;
  EXPECT_TRUE(evaluate(truth, truth, options));
  options.max_difference_ns = 14'000'000;
  EXPECT_FALSE(evaluate(truth, truth, options));
}

TEST(EvaluationOptions, AnEstimatedScaleAppliesToDriftToo) {
  const auto truth = winding_path(200);
  auto half = moved(some_motion(), truth);
  for (auto& pose : half) pose.T_world_camera.translation *= 0.5;
  EvaluationOptions options;
  options.alignment = Alignment::kSim3;
  const auto found = evaluate(half, truth, options);
  ASSERT_TRUE(found && found->rpe_second);
  EXPECT_NEAR(found->ate.scale, 2, 1e-9);
  EXPECT_LT(found->ate.error_m.max, 1e-9);
  EXPECT_LT(found->rpe_second->translation_m.max, 1e-9);
}

TEST(EvaluationOptions, EvoTakesTheClosestTruthOfEachPoseAgain) {
  const auto truth = winding_path(100);
  Trajectory twice;  // two estimates for each true pose
  for (const auto& pose : truth) {
    twice.push_back(pose);
    twice.push_back({pose.stamp_ns + 1'000'000, pose.T_world_camera});
  }
  twice.pop_back();
  Trajectory fewer(truth.begin(), truth.begin() + 99);
  fewer.insert(fewer.begin() + 1, {fewer[0].stamp_ns + 1'000'000, fewer[0].T_world_camera});
  for (const auto& [estimate, evo, tum] : {std::tuple{twice, 100U, 100U}, std::tuple{fewer, 100U, 99U}}) {
    EXPECT_EQ(pair_poses(estimate, truth, 10'000'000, Convention::kEvo).size(), evo);
    EXPECT_EQ(pair_poses(estimate, truth, 10'000'000, Convention::kTum).size(), tum);
  }
  EvaluationOptions options;
  options.convention = Convention::kEvo;
  const auto rpe = relative_pose_error(truth, truth, {10, RpeDelta::Unit::kFrames}, options);
  ASSERT_TRUE(rpe);
  EXPECT_EQ(rpe->translation_m.count, 90U);
  EXPECT_TRUE(pair_poses({}, truth, 1, Convention::kEvo).empty());
  EXPECT_TRUE(pair_poses(truth, {}, 1, Convention::kEvo).empty());
}

TEST(RelativeError, WithoutTwoPairsIsNothing) {
  const auto truth = winding_path(100);
  EXPECT_FALSE(relative_pose_error({}, truth));
  EXPECT_FALSE(relative_pose_error(truth, {}));
  EXPECT_FALSE(relative_pose_error(winding_path(20), truth, {1, RpeDelta::Unit::kSeconds}));
}

TEST(Coverage, CountsTimeWithoutTheGaps) {
  const auto truth = winding_path(101);
  EXPECT_NEAR(compute_coverage(truth, truth).time_fraction, 1, 1e-12);
  Trajectory half;
  for (size_t i = 0; i < truth.size(); ++i) {
    if (i <= 25 || i >= 75) half.push_back(truth[i]);
  }
  EXPECT_NEAR(compute_coverage(half, truth).time_fraction, 0.5, 1e-12);
  EXPECT_NEAR(compute_coverage(half, truth).matched_fraction, 1, 1e-12);
  EXPECT_NEAR(compute_coverage(truth, half).matched_fraction, 52.0 / 101, 1e-12);
  EXPECT_EQ(compute_coverage({}, truth).time_fraction, 0);
}

TEST(EvaluationJson, HoldsTheFigures) {
  const auto truth = winding_path(100);
  const auto evaluation = evaluate(moved(some_motion(), truth), truth);
  ASSERT_TRUE(evaluation);
  const auto json = to_json(*evaluation);
  EXPECT_EQ(json.at("ate").at("pairs"), 100);
  EXPECT_NEAR(json.at("ate").at("rmse_m").get<double>(), 0, 1e-9);
  EXPECT_NEAR(json.at("rpe_1s").at("rotation").at("rmse_deg").get<double>(), 0, 1e-6);
  EXPECT_EQ(json.at("coverage").at("matched"), 1.0);
  const auto brief = evaluate(winding_path(4), truth);
  ASSERT_TRUE(brief);
  EXPECT_TRUE(to_json(*brief).at("rpe_1s").is_null());
}

/// The output of the TUM tools for an estimate, with the digits they print.
struct KnownFigures {
  const char* estimate;
  const char* truth;
  const char* figures;
};

class KnownErrors : public testing::TestWithParam<KnownFigures> {};

TEST_P(KnownErrors, AreReproducedToTheLastDigit) {
  const auto folder = test::shared_data("trajectories");
  KINLOOP_SKIP_WITHOUT(folder);
  const auto& known = GetParam();
  const auto evaluation = evaluate(read_tum_trajectory(folder / "known_ate" / known.estimate),
                                   read_tum_trajectory(folder / "tum_groundtruth" / known.truth));
  ASSERT_TRUE(evaluation && evaluation->rpe_second);
  EXPECT_EQ(fmt::format("ATE {:.6f} m, {} pairs, RPE {:.6f} m, {:.6f} deg", evaluation->ate.error_m.rmse,
                        evaluation->ate.error_m.count, evaluation->rpe_second->translation_m.rmse,
                        evaluation->rpe_second->rotation_deg.rmse),
            known.figures);
}

INSTANTIATE_TEST_SUITE_P(
    Tum, KnownErrors,
    testing::Values(KnownFigures{"fr2_desk_orbslam2.txt", "fr2_desk.txt",
                                 "ATE 0.008144 m, 2223 pairs, RPE 0.007161 m, 0.455005 deg"},
                    KnownFigures{"fr1_xyz_rgbdslam.txt", "fr1_xyz.txt",
                                 "ATE 0.013473 m, 786 pairs, RPE 0.021217 m, 0.934480 deg"}));

}  // namespace
}  // namespace kinloop
