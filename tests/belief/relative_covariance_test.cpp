#include "kinloop/belief/relative_covariance.hpp"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "tests/support/random_map.hpp"
#include "tests/support/synthetic_map.hpp"

namespace kinloop {
namespace {

/// Keyframes on the x axis that look along z.
class RelativePosesTest : public testing::Test {
 protected:
  KeyframeId add(double x_m, uint32_t component = 0) {
    const auto number = static_cast<uint32_t>(map_.keyframes().size());
    return map_.add_keyframe(FrameId{number}, number, {Eigen::Quaterniond::Identity(), {x_m, 0, 0}},
                             std::make_shared<const Features>(), component);
  }

  void close_loop(uint32_t a, uint32_t b, double x_m) {
    LoopClosure loop;
    loop.stage = LoopStage::kVerified;
    loop.a = KeyframeId{a};
    loop.b = KeyframeId{b};
    loop.T_a_b.translation = {x_m, 0, 0};
    loop.information = 1e6 * Matrix6d::Identity();
    map_.add_loop_closure(loop);
  }

  Map map_;
};

TEST_F(RelativePosesTest, DistanceIsThatTravelledNotThatBetweenTheEnds) {
  for (const double x_m : {0.0, 1.0, 2.0, 1.0, 0.0}) add(x_m);
  const RelativePoses poses(map_, KeyframeId{4});
  EXPECT_DOUBLE_EQ(poses.path_length_m(KeyframeId{0}), 4);
  EXPECT_DOUBLE_EQ(poses.path_length_m(KeyframeId{3}), 1);
  EXPECT_DOUBLE_EQ(poses.path_length_m(KeyframeId{4}), 0);
}

TEST_F(RelativePosesTest, RotationCountsAsDistance) {
  add(0);
  map_.add_keyframe(FrameId{1}, 1, test::camera_at(0.5, {0, 0, 0}), std::make_shared<const Features>());
  EXPECT_NEAR(RelativePoses(map_, KeyframeId{1}).path_length_m(KeyframeId{0}), 0.5, 1e-9);
}

TEST_F(RelativePosesTest, LoopClosuresAreShortcutsForTheKeyframesAroundThem) {
  for (int i = 0; i <= 10; ++i) add(i);
  close_loop(1, 9, 0.25);
  const RelativePoses poses(map_, KeyframeId{10});
  EXPECT_DOUBLE_EQ(poses.path_length_m(KeyframeId{1}), 1.25);
  EXPECT_DOUBLE_EQ(poses.path_length_m(KeyframeId{0}), 2.25);
  EXPECT_DOUBLE_EQ(poses.path_length_m(KeyframeId{3}), 3.25);
  EXPECT_DOUBLE_EQ(poses.path_length_m(KeyframeId{8}), 2);
}

TEST_F(RelativePosesTest, ACameraAtRestHasPosesToo) {
  for (int i = 0; i < 5; ++i) map_.set_odometry(add(2), {KeyframeId{}, 1e-4 * Matrix6d::Identity()});
  for (const uint32_t from : {0U, 2U, 4U}) {
    const RelativePoses poses(map_, KeyframeId{from});
    for (uint32_t to = 0; to < 5; ++to) {
      const double steps = std::abs(static_cast<double>(from) - to);
      EXPECT_NEAR(poses.pose_of(KeyframeId{to})->covariance(0, 0), 1e-4 * steps, 1e-12);
    }
  }
}

TEST_F(RelativePosesTest, NoPredictionAcrossComponents) {
  add(0);
  const KeyframeId elsewhere = add(5, 1), next = add(6, 1);
  const RelativePoses poses(map_, next);
  EXPECT_EQ(poses.path_length_m(KeyframeId{0}), std::numeric_limits<double>::infinity());
  EXPECT_FALSE(poses.seen_from(KeyframeId{0}).has_value());
  EXPECT_FALSE(poses.pose_of(KeyframeId{0}).has_value());
  EXPECT_TRUE(poses.seen_from(elsewhere).has_value());
}

/// The covariance of poses whose steps are off at random, against that of many samples.
TEST_F(RelativePosesTest, CovarianceIsThatOfRandomSteps) {
  Random random(4);
  constexpr uint32_t kKeyframes = 6;
  constexpr double kSigma_m = 1e-3, kSigma_rad = 2e-3;
  Matrix6d of_step = Matrix6d::Zero();
  of_step.diagonal() << Eigen::Vector3d::Constant(kSigma_m * kSigma_m),
      Eigen::Vector3d::Constant(kSigma_rad * kSigma_rad);
  SE3 T_world_camera;
  for (uint32_t i = 0; i < kKeyframes; ++i) {
    const KeyframeId id =
        map_.add_keyframe(FrameId{i}, i, T_world_camera, std::make_shared<const Features>());
    if (i > 0) map_.set_odometry(id, {KeyframeId{i - 1}, of_step});
    T_world_camera = T_world_camera * test::random_step(random, 1, 0.5);
  }
  for (const auto& [from, to] : {std::pair{0U, kKeyframes - 1}, std::pair{kKeyframes - 1, 0U}}) {
    const RelativePoses poses(map_, KeyframeId{from});
    Matrix6d sampled = Matrix6d::Zero();
    constexpr int kSamples = 20'000;
    for (int n = 0; n < kSamples; ++n) {
      SE3 T_first_last;
      for (uint32_t i = 1; i < kKeyframes; ++i) {
        Vector6d x = test::gaussian_vector<6>(random);
        x.head<3>() *= kSigma_m;
        x.tail<3>() *= kSigma_rad;
        T_first_last = T_first_last * map_.relative_pose(KeyframeId{i - 1}, KeyframeId{i}) * SE3::exp(x);
      }
      const SE3 T_from_to = from < to ? T_first_last : T_first_last.inverse();
      const Vector6d x = (map_.relative_pose(KeyframeId{from}, KeyframeId{to}).inverse() * T_from_to).log();
      sampled += x * x.transpose() / kSamples;
    }
    const Matrix6d expected =
        poses.pose_of(KeyframeId{to})->covariance - drift_covariance(poses.path_length_m(KeyframeId{to}));
    EXPECT_LT((sampled - expected).norm(), 0.05 * expected.norm()) << from;
  }
}

TEST_F(RelativePosesTest, AStepThatNothingHoldsIsUncertain) {
  for (int i = 0; i <= 4; ++i) add(i);
  const auto sigma_m = [&](uint32_t to) {
    return expected_error(RelativePoses(map_, KeyframeId{0}).pose_of(KeyframeId{to})->covariance)
        .translation_m;
  };
  const double held_m = sigma_m(4);
  map_.set_odometry(KeyframeId{2}, {KeyframeId{1}, 0.25 * Matrix6d::Identity()});
  EXPECT_GT(sigma_m(4), 0.5);
  EXPECT_LT(sigma_m(1), held_m);
  close_loop(0, 4, 3.9);
  EXPECT_LT(sigma_m(4), 1.1 * held_m) << "the loop ties it";
  EXPECT_GT(sigma_m(2), 0.5) << "an upper bound: the shortest path leads over the step";
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

TEST(PathLengths, AreTheShortest) {
  Random random(5);
  int shortened = 0;
  for (int trial = 0; trial < 30; ++trial) {
    const int loops = trial % 4;
    const Map map = random_map(random, loops);
    const auto expected = all_distances(map);
    for (uint32_t from = 0; from < expected.size(); ++from) {
      const RelativePoses found(map, KeyframeId{from});
      for (uint32_t to = 0; to < expected.size(); ++to) {
        if (std::isinf(expected[from][to])) {
          EXPECT_EQ(found.path_length_m(KeyframeId{to}), expected[from][to]);
        } else {
          EXPECT_NEAR(found.path_length_m(KeyframeId{to}), expected[from][to], 1e-12);
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

TEST(Drift, GrowsWithTheLengthOfThePath) {
  const auto sigma_m = [](double length_m) { return std::sqrt(drift_covariance(length_m)(0, 0)); };
  EXPECT_EQ(sigma_m(0), 0);
  EXPECT_NEAR(sigma_m(10), 10 * sigma_m(1), 1e-12) << "systematic errors do not average out";
  EXPECT_NEAR(sigma_m(1), 0.01, 0.002) << "about 1 % of the path";
}

/// The direction of a point from the predicted camera and from any camera within the bound.
TEST(ErrorMagnitudeTest, DisplacesADirectionAtMostSoFar) {
  Random random(6);
  const auto unit = [&] { return test::gaussian_vector<3>(random).normalized().eval(); };
  const auto angle = [](const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
    return std::atan2(a.cross(b).norm(), a.dot(b));
  };
  for (int trial = 0; trial < 40; ++trial) {
    const ErrorMagnitude bound{random.uniform(0.02, 0.8), random.uniform(0.02, 0.5)};
    const double distance_m = random.uniform(1, 4);
    const Eigen::Vector3d p = distance_m * unit();
    const double limit_rad = displaced_rad(bound, p);
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
  EXPECT_NEAR(displaced_rad({2, 0.1}, {0, 0, 1}), 0.1 + std::acos(0.0), 1e-12)
      << "beyond the point: any direction";
}

/// Errors drawn from the covariance, with that of the measurement.
TEST(IsExplained, RefusesOneTruePoseInAMillion) {
  Random random(8);
  const Matrix6d covariance = drift_covariance(5);
  const ErrorMagnitude sigma = expected_error(covariance);
  double sum = 0;
  constexpr int kSamples = 20'000;
  for (int trial = 0; trial < kSamples; ++trial) {
    const PredictedView predicted{test::random_step(random, 2, 0.5), covariance};
    Vector6d x = test::gaussian_vector<6>(random);
    x.head<3>() *= sigma.translation_m;
    x.tail<3>() *= sigma.rotation_rad;
    const SE3 T = predicted.T_reference_camera * SE3::exp(x);
    sum += squared_distance(predicted, T) / kSamples;
    EXPECT_TRUE(is_explained(predicted, T));
    const SE3 far{Eigen::Quaterniond::Identity(), {0, 0, 1.01 * largest_error(covariance).translation_m}};
    EXPECT_FALSE(is_explained(predicted, predicted.T_reference_camera * far));
  }
  EXPECT_NEAR(sum, 6, 0.1) << "chi-square with six degrees of freedom";
}

/// Odometry with errors in every step, each in a direction of its own, of twice the size found in practice
/// (2 % of the path, a degree for each metre): on the way back the loop is never refused.
TEST(IsExplained, SimulatedOdometry) {
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
    const auto predicted = RelativePoses(map, last).seen_from(first);
    ASSERT_TRUE(predicted);
    EXPECT_TRUE(is_explained(*predicted, truth)) << seed;
    SE3 elsewhere = truth;
    elsewhere.translation.y() += 2 * largest_error(predicted->covariance).translation_m;
    EXPECT_FALSE(is_explained(*predicted, elsewhere)) << seed;
  }
}

/// The covariance whose largest error, with that of the measurement, has this size.
Matrix6d covariance_of(const ErrorMagnitude& largest) {
  const ErrorMagnitude least = expected_error(Matrix6d::Zero());
  const double sigmas = largest_error(Matrix6d::Zero()).translation_m / least.translation_m;
  Matrix6d covariance = Matrix6d::Zero();
  covariance.diagonal() << Eigen::Vector3d::Constant(std::pow(largest.translation_m / sigmas, 2) -
                                                     std::pow(least.translation_m, 2)),
      Eigen::Vector3d::Constant(std::pow(largest.rotation_rad / sigmas, 2) - std::pow(least.rotation_rad, 2));
  return covariance;
}

class DriftOverlap : public testing::Test {
 protected:
  [[nodiscard]] bool may_overlap_at(double yaw_rad, const ErrorMagnitude& largest) const {
    return may_overlap(*view_.features, {test::camera_at(yaw_rad, {0, 0, 0}), covariance_of(largest)},
                       world_.camera, 12);
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
  const ErrorMagnitude bound{0.3, 0.2};
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
    EXPECT_TRUE(may_overlap(*view_.features, {truth * error, covariance_of(bound)}, world_.camera, 12))
        << trial;
  }
  EXPECT_GT(overlapping, 100);
}

}  // namespace
}  // namespace kinloop
