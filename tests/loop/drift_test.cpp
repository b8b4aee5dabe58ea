#include "kinloop/loop/correction/drift.hpp"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "tests/support/random_map.hpp"
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

/// A map of random keyframes of two components, with loop edges among them.
Map random_map(Random& random, int loops) {
  Map map;
  constexpr uint32_t kKeyframes = 16;
  for (uint32_t i = 0; i < kKeyframes; ++i) {
    map.add_keyframe(FrameId{i}, i, test::random_step(random, 1, 0.4), std::make_shared<const Features>(),
                     i < kKeyframes - 3 ? 0 : 1);
  }
  for (int i = 0; i < loops; ++i) {
    LoopClosure loop;
    loop.stage = LoopStage::kVerified;
    loop.a = KeyframeId{random.index(kKeyframes - 3)};
    loop.b = KeyframeId{random.index(kKeyframes - 3)};
    loop.T_a_b = test::random_step(random, 0.3, 0.1);
    if (loop.a != loop.b) map.add_loop_closure(loop);
  }
  return map;
}

double length_m(const SE3& T) {
  return T.translation.norm() + T.angle_rad();
}

/// Shortest paths between all pairs (Floyd and Warshall).
std::vector<std::vector<double>> all_distances(const Map& map) {
  const size_t count = map.keyframes().size();
  std::vector<std::vector<double>> d(count,
                                     std::vector<double>(count, std::numeric_limits<double>::infinity()));
  const auto connect = [&](size_t a, size_t b, double length) {
    d[a][b] = d[b][a] = std::min(d[a][b], length);
  };
  for (size_t i = 0; i < count; ++i) d[i][i] = 0;
  for (size_t i = 1; i < count; ++i) {
    const Keyframe &a = map.keyframes()[i - 1], &b = map.keyframes()[i];
    if (a.component == b.component)
      connect(i - 1, i, length_m(a.T_world_camera.inverse() * b.T_world_camera));
  }
  for (const LoopClosure& loop : map.loop_closures())
    connect(loop.a.value, loop.b.value, length_m(loop.T_a_b));
  for (size_t k = 0; k < count; ++k) {
    for (size_t i = 0; i < count; ++i) {
      for (size_t j = 0; j < count; ++j) d[i][j] = std::min(d[i][j], d[i][k] + d[k][j]);
    }
  }
  return d;
}

TEST(TravelledDistances, AreTheShortestPaths) {
  Random random(5);
  int shortened = 0;
  for (int trial = 0; trial < 30; ++trial) {
    const int loops = trial % 4;
    const Map map = random_map(random, loops);
    const auto expected = all_distances(map);
    for (uint32_t from = 0; from < expected.size(); ++from) {
      const auto found = travelled_distances(map, KeyframeId{from});
      ASSERT_EQ(found.size(), expected.size());
      for (size_t to = 0; to < found.size(); ++to) {
        if (std::isinf(expected[from][to])) {
          EXPECT_EQ(found[to], expected[from][to]);
        } else {
          EXPECT_NEAR(found[to], expected[from][to], 1e-12);
        }
      }
    }
    // Without loops, the parts of a path add up; with them, they may be longer than the whole.
    shortened += expected[0][6] + expected[6][12] > expected[0][12] + 1e-9 ? 1 : 0;
    if (loops == 0) {
      EXPECT_NEAR(expected[0][6] + expected[6][12], expected[0][12], 1e-12);
    }
  }
  EXPECT_GT(shortened, 5);
}

/// 10 cm and 6 degrees before the first step, then 5 cm and 1.7 degrees for each metre travelled.
TEST(DriftBoundTest, IsABasePlusAShareOfTheDistance) {
  for (const double distance_m : {0.0, 1.0, 7.5, 100.0}) {
    EXPECT_DOUBLE_EQ(drift_bound(distance_m).translation_m, 0.1 + 0.05 * distance_m);
    EXPECT_DOUBLE_EQ(drift_bound(distance_m).rotation_rad, 0.1 + 0.03 * distance_m);
  }
}

/// The direction of a point from the predicted camera and from any camera within the bound.
TEST(DriftBoundTest, TheDirectionBoundIsTheLargestDeviation) {
  Random random(6);
  const auto unit = [&] { return test::gaussian_vector<3>(random).normalized().eval(); };
  const auto angle = [](const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
    return std::atan2(a.cross(b).norm(), a.dot(b));
  };
  for (int trial = 0; trial < 40; ++trial) {
    const DriftBound bound{random.uniform(0.02, 0.8), random.uniform(0.02, 0.5)};
    const double distance_m = random.uniform(1, 4);
    const Eigen::Vector3d p = distance_m * unit();
    const double limit_rad = direction_bound_rad(bound, p);
    double largest_rad = 0;
    for (int sample = 0; sample < 2000; ++sample) {
      const double turn_rad = bound.rotation_rad * std::cbrt(random.uniform());
      const double shift_m = bound.translation_m * std::cbrt(random.uniform());
      const SE3 error{exp_so3(turn_rad * unit()), shift_m * unit()};
      largest_rad = std::max(largest_rad, angle(p, error.inverse() * p));
    }
    EXPECT_LE(largest_rad, limit_rad);
    EXPECT_GT(largest_rad, 0.8 * limit_rad);
    // The worst case: a step perpendicular to the new direction, and a turn in the same plane.
    const Eigen::Vector3d axis = p.cross(unit()).normalized();
    const double by_step_rad = std::asin(bound.translation_m / distance_m);
    const Eigen::Vector3d seen_after = exp_so3(by_step_rad * axis) * p.normalized();
    const SE3 worst{exp_so3(-bound.rotation_rad * axis), bound.translation_m * seen_after.cross(axis)};
    const Eigen::Vector3d step = bound.translation_m * axis.cross(seen_after);
    const SE3 other{worst.rotation, step};
    const double reached = std::max(angle(p, worst.inverse() * p), angle(p, other.inverse() * p));
    EXPECT_NEAR(reached, limit_rad, 1e-9);
  }
  EXPECT_NEAR(direction_bound_rad({2, 0.1}, {0, 0, 1}), 0.1 + std::acos(0.0), 1e-12)
      << "beyond the point: any direction";
}

/// A turn at either end of the path, and a shift, up to the bound: the turn at the reference moves the camera
/// by its lever.
TEST(DriftBoundTest, ErrorsUpToTheBoundAreExplainedAndLargerOnesAreNot) {
  Random random(8);
  const auto unit = [&] { return test::gaussian_vector<3>(random).normalized().eval(); };
  for (int trial = 0; trial < 500; ++trial) {
    const PredictedView predicted{test::random_step(random, 2, 0.5), drift_bound(random.uniform(0, 30))};
    const DriftBound& bound = predicted.bound;
    const double share = random.uniform();
    const SE3 at_reference{exp_so3(share * 0.999 * bound.rotation_rad * unit()), Eigen::Vector3d::Zero()};
    const SE3 at_camera{exp_so3((1 - share) * 0.999 * bound.rotation_rad * unit()),
                        0.999 * bound.translation_m * unit()};
    const SE3& T = predicted.T_reference_camera;
    EXPECT_TRUE(is_explained_by_drift(predicted, at_reference * T * at_camera));
    const double reach_m = bound.translation_m + bound.rotation_rad * T.translation.norm();
    const SE3 too_far{Eigen::Quaterniond::Identity(), 1.001 * reach_m * unit()};
    const SE3 turned{exp_so3(1.001 * bound.rotation_rad * unit()), Eigen::Vector3d::Zero()};
    EXPECT_FALSE(is_explained_by_drift(predicted, T * too_far));
    EXPECT_FALSE(is_explained_by_drift(predicted, T * turned));
  }
}

/// Odometry with errors in every step, each in a direction of its own, of twice the size found in practice
/// (2 % of the path, a degree for each metre): on the way back the loop is never refused.
TEST(DriftBoundTest, SimulatedOdometryStaysWithinTheBound) {
  constexpr double kStep_m = 0.2, kPerMetre_m = 0.04, kPerMetre_rad = 0.035;
  for (uint64_t seed = 0; seed < 50; ++seed) {
    Random random(seed);
    const auto unit = [&] { return test::gaussian_vector<3>(random).normalized().eval(); };
    Map map;
    SE3 truth, estimate;
    const int steps = 20 + static_cast<int>(random.index(150));
    for (int i = 0; i <= steps; ++i) {
      map.add_keyframe(FrameId{static_cast<uint32_t>(i)}, i, estimate, std::make_shared<const Features>());
      const SE3 step{exp_so3({0, 6.28 / steps, 0}), {kStep_m, 0, 0}};  // one round
      const double travelled_m = length_m(step);
      const SE3 error{exp_so3(kPerMetre_rad * travelled_m * unit()), kPerMetre_m * travelled_m * unit()};
      if (i == steps) break;
      truth = truth * step;
      estimate = estimate * step * error;
    }
    const KeyframeId first{0}, last{static_cast<uint32_t>(steps)};
    const auto predicted = predict_view(map, first, last, travelled_distances(map, last)[0]);
    ASSERT_TRUE(predicted);
    EXPECT_TRUE(is_explained_by_drift(*predicted, truth)) << seed;
    SE3 elsewhere = truth;
    elsewhere.translation.y() +=
        2 * predicted->bound.translation_m +
        predicted->bound.rotation_rad * predicted->T_reference_camera.translation.norm();
    EXPECT_FALSE(is_explained_by_drift(*predicted, elsewhere)) << seed;
  }
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
