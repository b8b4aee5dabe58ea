#include "kinloop/loop/drift.hpp"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "tests/support/random_vectors.hpp"
#include "tests/support/synthetic_map.hpp"

namespace kinloop {
namespace {

/// Keyframes on the x axis that look along z.
class Drift : public testing::Test {
 protected:
  KeyframeId add(double x_m, uint32_t component = 0) {
    const auto number = static_cast<uint32_t>(map_.keyframes().size());
    return map_.add_keyframe(FrameId{number}, number, {Eigen::Quaterniond::Identity(), {x_m, 0, 0}},
                             std::make_shared<const Features>(), component);
  }

  Map map_;
};

TEST_F(Drift, DistanceIsThatTravelledNotThatBetweenTheEnds) {
  for (const double x_m : {0.0, 1.0, 2.0, 1.0, 0.0}) add(x_m);
  const auto distances = travelled_distances(map_, KeyframeId{4});
  EXPECT_DOUBLE_EQ(distances[0], 4);
  EXPECT_DOUBLE_EQ(distances[3], 1);
  EXPECT_DOUBLE_EQ(distances[4], 0);
}

TEST_F(Drift, RotationCountsAsDistance) {
  add(0);
  map_.add_keyframe(FrameId{1}, 1, test::camera_at(0.5, {0, 0, 0}), std::make_shared<const Features>());
  EXPECT_NEAR(travelled_distances(map_, KeyframeId{1})[0], 0.5, 1e-9);
}

TEST_F(Drift, LoopClosuresAreShortcutsForTheKeyframesAroundThem) {
  for (int i = 0; i <= 10; ++i) add(i);
  LoopClosure loop;
  loop.stage = LoopStage::kVerified;
  loop.a = KeyframeId{1};
  loop.b = KeyframeId{9};
  loop.T_a_b.translation = {0.25, 0, 0};
  map_.add_loop_closure(loop);
  const auto distances = travelled_distances(map_, KeyframeId{10});
  EXPECT_DOUBLE_EQ(distances[1], 1.25);
  EXPECT_DOUBLE_EQ(distances[0], 2.25);
  EXPECT_DOUBLE_EQ(distances[3], 3.25);
  EXPECT_DOUBLE_EQ(distances[8], 2);
}

TEST_F(Drift, NoPredictionAcrossComponents) {
  add(0);
  const KeyframeId elsewhere = add(5, 1), next = add(6, 1);
  const auto distances = travelled_distances(map_, next);
  EXPECT_EQ(distances[0], std::numeric_limits<double>::infinity());
  EXPECT_FALSE(predict_view(map_, KeyframeId{0}, next, distances[0]).has_value());
  EXPECT_TRUE(predict_view(map_, elsewhere, next, distances[1]).has_value());
}

TEST(DriftBoundTest, GrowsWithTheDistance) {
  const DriftBound near = drift_bound(1), far = drift_bound(10);
  EXPECT_GT(near.translation_m, 0);
  EXPECT_GT(near.rotation_rad, 0);
  EXPECT_GT(far.translation_m, near.translation_m);
  EXPECT_GT(far.rotation_rad, near.rotation_rad);
}

TEST(DriftBoundTest, ErrorsWithinTheBoundAreExplained) {
  const PredictedView predicted{test::camera_at(0.3, {1, 0, 2}), {0.2, 0.1}};
  Vector6d small, far, turned;
  small << 0.1, 0, 0.1, 0, 0.05, 0;
  far << 3.61, 0, 0, 0, 0, 0;
  turned << 0, 0, 0, 0, 1.5, 0;
  EXPECT_TRUE(is_explained_by_drift(predicted, predicted.T_reference_camera * SE3::exp(small)));
  EXPECT_FALSE(is_explained_by_drift(predicted, predicted.T_reference_camera * SE3::exp(far)));
  EXPECT_FALSE(is_explained_by_drift(predicted, predicted.T_reference_camera * SE3::exp(turned)));
}

class DriftOverlap : public testing::Test {
 protected:
  [[nodiscard]] bool may_overlap_at(double yaw_rad, const DriftBound& bound) const {
    return may_overlap(*view_.features, {test::camera_at(yaw_rad, {0, 0, 0}), bound}, world_.camera, 12);
  }

  test::SyntheticWorld world_ = test::make_world(4000, 1);
  test::SyntheticView view_ = test::observe(world_, {}, {}, 2);
};

TEST_F(DriftOverlap, ViewsInOppositeDirectionsDoNotOverlap) {
  EXPECT_TRUE(may_overlap_at(0, {0.1, 0.1}));
  EXPECT_FALSE(may_overlap_at(3.1, {0.1, 0.1}));
}

TEST_F(DriftOverlap, UncertaintyWidensTheView) {
  EXPECT_FALSE(may_overlap_at(2, {0.1, 0.1}));
  EXPECT_TRUE(may_overlap_at(2, {0.1, 1.0}));
  EXPECT_TRUE(may_overlap_at(2, {5, 0.1})) << "the camera may be anywhere among the points";
}

/// Whatever error lies within the bound: points in view of the true pose are never ruled out.
TEST_F(DriftOverlap, TrueOverlapIsNeverRefused) {
  const DriftBound bound{0.3, 0.2};
  Random random(7);
  const auto unit = [&] { return test::gaussian_vector<3>(random).normalized().eval(); };
  int overlapping = 0;
  for (int trial = 0; trial < 300; ++trial) {
    const Eigen::Vector3d direction = unit();
    const SE3 truth = test::camera_at(random.uniform(-2, 2), 0.8 * direction);
    int visible = 0;
    for (uint32_t i = 0; i < view_.features->size(); ++i) {
      const auto depth_m = static_cast<double>(view_.features->depths_m[i]);
      if (!(depth_m > 0)) continue;
      const Eigen::Vector3d p =
          truth.inverse() * world_.camera.unproject(view_.features->pixels[i].cast<double>(), depth_m);
      if (p.z() > 0 && world_.camera.contains(world_.camera.project(p))) ++visible;
    }
    if (visible < 12) continue;
    ++overlapping;
    const SE3 error{exp_so3(bound.rotation_rad * unit()), bound.translation_m * unit()};
    EXPECT_TRUE(may_overlap(*view_.features, {truth * error, bound}, world_.camera, 12)) << trial;
  }
  EXPECT_GT(overlapping, 100);
}

}  // namespace
}  // namespace kinloop
