#include <algorithm>
#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "kinloop/belief/relative_covariance.hpp"
#include "kinloop/loop/correction/correct_loop.hpp"
#include "kinloop/loop/recognition/candidates.hpp"
#include "kinloop/loop/recognition/place_recognition.hpp"
#include "kinloop/loop/verification/verify_loop.hpp"
#include "tests/support/synthetic_map.hpp"
#include "tools/vocabulary_training/trainer.hpp"

namespace kinloop {
namespace {

using test::camera_at;

constexpr int kKeyframes = 32;

/// One turn around the room, a keyframe every 360 / 30 degrees: the last ones revisit the views of the first.
SE3 true_pose(int i) {
  return camera_at(2 * std::numbers::pi / 30 * i, {0.1 * std::sin(0.2 * i), 0, 0.1 * std::cos(0.2 * i)});
}

/// Poses as from odometry: each step slightly off in the same direction.
SE3 drifted_pose(int i) {
  SE3 T_world_camera = true_pose(0);
  Vector6d error;
  error << 0.003, 0.001, -0.002, 0.0, 0.001, 0.0;
  for (int k = 1; k <= i; ++k) {
    T_world_camera = T_world_camera * (true_pose(k - 1).inverse() * true_pose(k)) * SE3::exp(error);
  }
  return T_world_camera;
}

class Loop : public testing::Test {
 protected:
  Loop() : vocabulary_(train_vocabulary(slices(world_.descriptors), train_options())) {
    for (int i = 0; i < kKeyframes; ++i) {
      // Odometry does not recognise the revisit: the last keyframes create new landmarks.
      if (i == kKeyframes - 4) built_.landmark_of_point.clear();
      const auto view = test::observe(world_, true_pose(i), {}, 10 + static_cast<uint64_t>(i));
      const KeyframeId id = test::add_view(built_, world_, view, drifted_pose(i));
      const auto quantized = vocabulary_.quantize(view.features->descriptors);
      places_.add(id, vocabulary_.bow_of(quantized.words));
      nodes_.push_back(quantized.nodes);
    }
  }

  static TrainOptions train_options() {
    TrainOptions options;
    options.depth = 3;
    return options;
  }

  /// The vocabulary weights words by the number of images that contain them: as many "images" as walls have
  /// patches.
  static std::vector<cv::Mat> slices(const cv::Mat& descriptors) {
    std::vector<cv::Mat> images;
    for (int row = 0; row < descriptors.rows; row += 40)
      images.push_back(descriptors.rowRange(row, row + 40));
    return images;
  }

  [[nodiscard]] IndexedView view_of(KeyframeId id) const {
    return {*built_.map.keyframe(id).features, nodes_[id.value]};
  }

  [[nodiscard]] std::optional<SE3> propose(KeyframeId keyframe, KeyframeId candidate,
                                           const std::optional<PredictedView>& predicted) const {
    return propose_pose({view_of(candidate), view_of(keyframe), predicted}, context_, 3);
  }

  [[nodiscard]] std::optional<PredictedView> predict(KeyframeId keyframe, KeyframeId candidate) const {
    return RelativePoses(built_.map, keyframe).seen_from(candidate);
  }

  [[nodiscard]] LoopVerificationProblem question(KeyframeId keyframe,
                                                 const std::vector<KeyframeId>& candidates) const {
    LoopVerificationProblem problem = make_loop_verification_problem(built_.map.keyframe(keyframe));
    for (const KeyframeId candidate : candidates) {
      const auto predicted = predict(keyframe, candidate);
      const auto pose = propose(keyframe, candidate, predicted);
      if (!pose) continue;
      const LoopClosure hypothesis{.a = candidate, .b = keyframe, .T_a_b = *pose};
      problem.candidates.push_back({hypothesis, predicted, make_local_map(built_.map, candidate, {})});
    }
    return problem;
  }

  /// The first loop that is verified.
  [[nodiscard]] std::optional<LoopVerificationResult> verify(const LoopVerificationProblem& problem) const {
    auto verified = verify_loops(problem, context_);
    if (verified.empty()) return std::nullopt;
    return std::move(verified.front());
  }

  [[nodiscard]] std::optional<LoopVerificationResult> verify(
      KeyframeId keyframe, const std::vector<KeyframeId>& candidates) const {
    return verify(question(keyframe, candidates));
  }

  /// Place recognition that knows all keyframes.
  [[nodiscard]] PlaceRecognition recognition() const {
    PlaceRecognition places(context_.sensor, {}, vocabulary_);
    for (const Keyframe& keyframe : built_.map.keyframes()) places.add(keyframe);
    return places;
  }

  test::SyntheticWorld world_ = test::make_world(4000, 1);
  const PlaceContext context_{world_.camera};
  Vocabulary vocabulary_;
  test::SyntheticMap built_;
  PlaceIndex places_;
  std::vector<std::vector<NodeId>> nodes_;  // by keyframe
  const KeyframeId last_{kKeyframes - 1};
};

TEST_F(Loop, CandidatesAreFromTheStartOfTheLoop) {
  std::vector<KeyframeId> found;
  for (uint32_t i = 0; i < kKeyframes; ++i) {
    found = find_loop_candidates(built_.map, places_, KeyframeId{i}, {});
    if (i > 20) continue;  // no revisit yet: random similarities must fail verification
    EXPECT_FALSE(verify(KeyframeId{i}, found).has_value());
  }
  ASSERT_FALSE(found.empty());
  EXPECT_LT(found.front().value, 6U);
}

TEST_F(Loop, PlacesThatShareLandmarksAreNoCandidates) {
  const auto found = find_loop_candidates(built_.map, places_, last_, {});
  ASSERT_FALSE(found.empty());
  LoopClosure loop;
  loop.stage = LoopStage::kVerified;
  loop.a = found.front();
  loop.b = KeyframeId{kKeyframes - 2};  // a neighbour of the query
  loop.evidence.inliers = 10000;
  built_.map.add_loop_closure(loop);
  const auto again = find_loop_candidates(built_.map, places_, last_, {});
  EXPECT_EQ(std::count(again.begin(), again.end(), loop.a), 0);
}

TEST_F(Loop, VerificationFindsTheTrueMotion) {
  const auto verified = verify(last_, {KeyframeId{1}});
  ASSERT_TRUE(verified.has_value());
  const LoopClosure& loop = verified->loop;
  EXPECT_EQ(loop.stage, LoopStage::kVerified);
  EXPECT_EQ(loop.a, KeyframeId{1});
  EXPECT_EQ(loop.b, last_);
  EXPECT_LT(test::distance_m(loop.T_a_b, true_pose(1).inverse() * true_pose(kKeyframes - 1)), 0.02);
  EXPECT_GE(loop.evidence.inliers, 150);
  EXPECT_GE(loop.evidence.visible_landmarks, loop.evidence.inliers);
  EXPECT_EQ(loop.information, edge_information(loop.evidence.inliers, {}));
  EXPECT_FALSE(landmark_merges(built_.map, *verified).empty());
  EXPECT_NEAR(loop.evidence.scale.factor, 1, 0.01);
  EXPECT_LT(loop.evidence.scale.sigma, 0.01);
}

TEST_F(Loop, AllPlacesThatPassAreReturned) {
  const auto verified =
      verify_loops(question(last_, {KeyframeId{1}, KeyframeId{15}, KeyframeId{2}}), context_);
  ASSERT_EQ(verified.size(), 2U);
  EXPECT_EQ(verified[0].loop.a, KeyframeId{1});
  EXPECT_EQ(verified[1].loop.a, KeyframeId{2});
}

/// Depth that is scaled gives the same image but another size.
TEST_F(Loop, ScaledDepthShowsInTheScale) {
  LoopVerificationProblem loop = question(last_, {KeyframeId{1}});
  ASSERT_EQ(loop.candidates.size(), 1U);
  Features scaled = *loop.frame.features;
  for (float& depth_m : scaled.depths_m) depth_m *= 0.95F;
  for (float& depth_m : scaled.measured_depths_m) depth_m *= 0.95F;
  loop.frame.features = std::make_shared<const Features>(std::move(scaled));
  const auto verified = verify(loop);
  ASSERT_TRUE(verified.has_value());
  EXPECT_NEAR(verified->loop.evidence.scale.factor, 1 / 0.95, 0.015);
}

TEST_F(Loop, AnotherPlaceIsRejected) {
  EXPECT_FALSE(verify(last_, {KeyframeId{15}}).has_value());
}

/// The same keypoints at depths scaled by `scale`, each on a plane that faces the camera.
std::shared_ptr<const Features> facing(const Features& features, float scale) {
  Features planes = features;
  for (float& depth_m : planes.depths_m) depth_m *= scale;
  planes.inverse_depth_gradients.assign(planes.size(), Eigen::Vector2f::Zero());
  return std::make_shared<const Features>(std::move(planes));
}

TEST_F(Loop, InliersAreNotEnoughIfFreeSpaceIsViolated) {
  LoopVerificationProblem loop = question(last_, {KeyframeId{1}});
  ASSERT_EQ(loop.candidates.size(), 1U);
  loop.frame.features = facing(*loop.frame.features, 1);
  LocalMap& local_map = loop.candidates[0].local_map;
  const auto features = local_map.features;
  local_map.features = facing(*features, 1);
  EXPECT_TRUE(verify(loop).has_value());
  local_map.features = facing(*features, 1.3F);
  EXPECT_FALSE(verify(loop).has_value());
}

/// A repeated structure can pass every other check.
TEST_F(Loop, PoseThatDriftCannotExplainIsRejected) {
  LoopVerificationProblem loop = question(last_, {KeyframeId{1}});
  ASSERT_EQ(loop.candidates.size(), 1U);
  auto& predicted = loop.candidates[0].predicted;
  ASSERT_TRUE(predicted.has_value());
  EXPECT_TRUE(verify(loop).has_value());
  predicted->T_reference_camera.translation.x() += 3.61;
  EXPECT_FALSE(verify(loop).has_value());
  predicted = std::nullopt;  // another component: nothing is known
  EXPECT_TRUE(verify(loop).has_value());
}

TEST_F(Loop, ProposedPoseIsNearTheTruth) {
  const SE3 truth = true_pose(1).inverse() * true_pose(kKeyframes - 1);
  for (const auto& predicted : {std::optional<PredictedView>(), predict(last_, KeyframeId{1})}) {
    const auto pose = propose(last_, KeyframeId{1}, predicted);
    ASSERT_TRUE(pose.has_value());
    EXPECT_LT(test::distance_m(*pose, truth), 0.004);
    EXPECT_LT(test::angle_rad(*pose, truth), 0.0018);
  }
}

TEST_F(Loop, MatchesAgainstThePredictionAreDropped) {
  auto predicted = predict(last_, KeyframeId{1});
  ASSERT_TRUE(predicted.has_value());
  predicted->covariance.setZero();
  predicted->T_reference_camera = predicted->T_reference_camera * test::camera_at(0.6, {0, 0, 0});
  EXPECT_FALSE(propose(last_, KeyframeId{1}, predicted).has_value());
}

TEST_F(Loop, CorrectionDistributesTheDrift) {
  const auto verified = verify(last_, {KeyframeId{1}});
  ASSERT_TRUE(verified.has_value());
  const LoopEnds ends{verified->loop.a, verified->loop.b};
  const LandmarkMerges merges = landmark_merges(built_.map, *verified);
  const double before_m =
      test::distance_m(built_.map.keyframe(last_).T_world_camera, true_pose(kKeyframes - 1));
  built_.map.add_loop_closure(verified->loop);
  OdometryBeforeLoops odometry;
  odometry.observe(built_.map, {});
  const auto correction =
      correct_loop(make_loop_correction_problem(built_.map, {{ends, merges}}, odometry, {}), {});
  EXPECT_TRUE(correction.withdrawn.empty());
  EXPECT_EQ(correction.loops, std::vector{ends});
  ASSERT_TRUE(built_.map.apply(correction.update));
  const double after_m =
      test::distance_m(built_.map.keyframe(last_).T_world_camera, true_pose(kKeyframes - 1));
  EXPECT_GT(before_m, 0.03);
  EXPECT_LT(after_m, before_m / 3);
  const auto neighbours = built_.map.covisible_keyframes(last_, 15);
  EXPECT_TRUE(std::any_of(neighbours.begin(), neighbours.end(), [](const auto& near) {
    return near.first.value < 6;
  })) << "landmarks of the first and last views were merged";
  built_.map.check_invariants();
}

TEST_F(Loop, CorrectedLoopsEnterThePoseGraphAsTheMapHasThem) {
  const SE3 T_a_b = test::camera_at(0.1, {0.2, 0, 0});
  for (const uint32_t a : {0U, 1U}) {
    built_.map.add_loop_closure(
        {KeyframeId{a}, last_, T_a_b, 7 * Matrix6d::Identity(), {30}, LoopStage::kVerified});
  }
  built_.map.mark_corrected(std::vector<LoopEnds>{{KeyframeId{0}, last_}});
  const PoseGraph graph = make_pose_graph(built_.map, {}, LoopEdges::kAsCorrected);
  const auto& corrected = graph.edges[graph.edges.size() - 2];
  const SE3 of_map =
      built_.map.keyframe(KeyframeId{0}).T_world_camera.inverse() * built_.map.keyframe(last_).T_world_camera;
  EXPECT_EQ(corrected.T_a_b.matrix(), of_map.matrix());
  EXPECT_EQ(graph.edges.back().T_a_b.matrix(), T_a_b.matrix());
  EXPECT_EQ(corrected.information, graph.edges.back().information);
  EXPECT_FALSE(corrected.is_odometry);
  const PoseGraph measured = make_pose_graph(built_.map, {}, LoopEdges::kAsMeasured);
  EXPECT_EQ(measured.edges[measured.edges.size() - 2].T_a_b.matrix(), T_a_b.matrix());
}

TEST_F(Loop, ALostFrameIsRelocalized) {
  const SE3 pose = true_pose(10) * camera_at(0.04, {0.05, 0.02, 0.03});
  const auto view = test::observe(world_, pose, {}, 99);
  const auto found = recognition().relocalize(test::make_frame(500, view), built_.map);
  ASSERT_TRUE(found.has_value());
  const SE3 truth = true_pose(static_cast<int>(found->reference.value)).inverse() * pose;
  // The surrounding map is itself distorted by a few millimetres between keyframes.
  EXPECT_LT(test::distance_m(found->T_reference_camera, truth), 0.05);
  EXPECT_EQ(found->evidence.with_depth, static_cast<int>(found->matches.size()));
}

TEST_F(Loop, AFrameFromAnotherPlaceIsNotRelocalized) {
  const auto elsewhere = test::make_world(4000, 77);
  const auto view = test::observe(elsewhere, true_pose(10), {}, 99);
  EXPECT_FALSE(recognition().relocalize(test::make_frame(500, view), built_.map).has_value());
}

}  // namespace
}  // namespace kinloop
