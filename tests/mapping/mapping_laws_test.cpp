// Laws of mapping: triangulation, local adjustment, culling and completion of tracks.

#include <algorithm>
#include <map>
#include <set>

#include <gtest/gtest.h>

#include "kinloop/mapping/bundle_adjustment.hpp"
#include "kinloop/mapping/landmark_creation.hpp"
#include "tests/support/random_map.hpp"
#include "tests/support/synthetic_map.hpp"

namespace kinloop {
namespace {

using test::pose_on_arc;

constexpr double kMinParallax_rad = 0.03;

TEST(TriangulationLaws, WithoutNoiseThePointIsExactForAnyTwoCameras) {
  Random random(1);
  int found = 0, refused = 0;
  for (int trial = 0; trial < 2000; ++trial) {
    const SE3 T_a_b = test::random_step(random, 0.3, 0.3);
    const Eigen::Vector3d p_a = test::uniform_vector<3>(random, {-2, -2, 0.5}, {2, 2, 6});
    const Eigen::Vector3d p_b = T_a_b.inverse() * p_a;
    const double parallax_rad =
        std::acos(std::clamp(p_a.normalized().dot(T_a_b.rotation * p_b.normalized()), -1.0, 1.0));
    const Bearing a{p_a.normalized(), 1e-3}, b{p_b.normalized(), random.uniform(1e-3, 4e-3)};
    const auto point = triangulate(a, b, T_a_b, kMinParallax_rad);
    ASSERT_EQ(point.has_value(), parallax_rad > kMinParallax_rad && parallax_rad < 1.5707) << parallax_rad;
    (point ? found : refused) += 1;
    if (!point) continue;
    EXPECT_LT((*point - p_a).norm(), 1e-10);
    const auto swapped = triangulate(b, a, T_a_b.inverse(), kMinParallax_rad);
    ASSERT_TRUE(swapped);
    EXPECT_LT((T_a_b * *swapped - *point).norm(), 1e-10) << "the order of the cameras matters";
  }
  EXPECT_GT(found, 1000);
  EXPECT_GT(refused, 50);
}

/// With noise of the stated size, 95 % of pairs of rays are near enough to each other.
TEST(TriangulationLaws, NoiseOfTheStatedSizeIsAcceptedAsOftenAsStated) {
  constexpr int kTrials = 4000;
  constexpr double kSigma_rad = 1e-3;
  Random random(2);
  const SE3 T_a_b = test::camera_at(-0.1, {0.4, 0.05, 0.02});
  const Eigen::Vector3d p_a(0.4, -0.2, 3);
  int found = 0;
  const auto noisy = [&](const Eigen::Vector3d& p) {
    const Eigen::Vector3d turn = kSigma_rad * test::gaussian_vector<3>(random);
    return Bearing{exp_so3(turn) * p.normalized(), kSigma_rad};
  };
  for (int trial = 0; trial < kTrials; ++trial) {
    const Bearing a = noisy(p_a), b = noisy(T_a_b.inverse() * p_a);
    const auto point = triangulate(a, b, T_a_b, kMinParallax_rad);
    if (!point) continue;
    ++found;
    EXPECT_LT((*point - p_a).norm(), 0.2);
    const auto swapped = triangulate(b, a, T_a_b.inverse(), kMinParallax_rad);
    ASSERT_TRUE(swapped);
    EXPECT_LT((T_a_b * *swapped - *point).norm(), 1e-10);
  }
  EXPECT_NEAR(found / static_cast<double>(kTrials), 0.95, 0.015);
}

/// Of two rays that miss each other, the more precise one is nearer to the point.
TEST(TriangulationLaws, ThePointDividesTheGapByTheUncertainties) {
  Random random(3);
  int compared = 0;
  for (int trial = 0; trial < 200; ++trial) {
    const SE3 T_a_b = test::camera_at(-0.1, {0.4, 0.05, 0.02});
    const Eigen::Vector3d p_a = test::uniform_vector<3>(random, {-0.5, -0.5, 1.5}, {0.5, 0.5, 3});
    const double sigma_a = random.uniform(1e-3, 4e-3), sigma_b = random.uniform(1e-3, 4e-3);
    const Eigen::Vector3d raised = exp_so3({1e-3, 0, 0}) * Eigen::Vector3d(T_a_b.inverse() * p_a);
    const auto point =
        triangulate({p_a.normalized(), sigma_a}, {raised.normalized(), sigma_b}, T_a_b, kMinParallax_rad);
    if (!point) continue;
    ++compared;
    const Eigen::Vector3d p_b = T_a_b.inverse() * *point;
    const double off_a_m = point->cross(p_a.normalized()).norm();
    const double off_b_m = p_b.cross(raised.normalized()).norm();
    const double expected = std::pow(point->norm() * sigma_a / (p_b.norm() * sigma_b), 2);
    EXPECT_NEAR(off_a_m / off_b_m / expected, 1, 0.01);
  }
  EXPECT_GT(compared, 100);
}

/// Keyframes along the arc: true, or off by some `error` in each direction of their poses but the first.
test::SyntheticMap arc(const test::SyntheticWorld& world, const test::ObservationNoise& noise, double error,
                       uint64_t seed) {
  test::SyntheticMap built;
  Random random(seed);
  for (int i = 0; i < 8; ++i) {
    const Vector6d twist = error * test::gaussian_vector<6>(random);
    const SE3 pose = i == 0 ? pose_on_arc(0) : pose_on_arc(i) * SE3::exp(twist);
    test::add_view(built, world,
                   test::observe(world, pose_on_arc(i), noise, hash(seed, static_cast<uint64_t>(i))), pose);
  }
  return built;
}

double rms_pose_error_m(const Map& map) {
  double squares = 0;
  for (const Keyframe& keyframe : map.keyframes()) {
    const double error_m =
        test::distance_m(keyframe.T_world_camera, pose_on_arc(static_cast<int>(keyframe.id.value)));
    squares += error_m * error_m;
  }
  return std::sqrt(squares / static_cast<double>(map.keyframes().size()));
}

double rms_landmark_error_m(const test::SyntheticMap& built, const test::SyntheticWorld& world) {
  double squares = 0;
  for (const auto& [point, landmark] : built.landmark_of_point)
    if (built.map.contains(landmark))
      squares += (built.map.p_world(landmark) - world.p_world[point]).squaredNorm();
  return std::sqrt(squares / static_cast<double>(built.landmark_of_point.size()));
}

MappingOptions four_free_keyframes() {
  MappingOptions options;
  options.local_ba_keyframes = 4;
  options.local_ba = {};  // to convergence
  return options;
}

TEST(LocalAdjustmentLaws, APerfectMapStaysAsItIs) {
  const auto world = test::make_world(1500, 1);
  for (uint64_t seed = 0; seed < 3; ++seed) {
    auto built = arc(world, {0, 0, 12, 0.2}, 0, seed);
    const MappingOptions options = four_free_keyframes();
    const auto problem = make_local_ba_problem(built.map, KeyframeId{7}, {world.camera}, options);
    const MapUpdate update = run_bundle_adjustment(problem, options.local_ba);
    EXPECT_TRUE(update.outliers.empty());
    ASSERT_TRUE(built.map.apply(update));
    EXPECT_LT(rms_pose_error_m(built.map), 1e-6) << "pixels are floats";
    for (const auto& [point, landmark] : built.landmark_of_point)
      EXPECT_LT((built.map.p_world(landmark) - world.p_world[point]).norm(), 1e-5);
  }
}

TEST(LocalAdjustmentLaws, ErrorsShrinkAndFixedKeyframesStay) {
  const auto world = test::make_world(1500, 1);
  const MappingOptions options = four_free_keyframes();
  for (uint64_t seed = 0; seed < 5; ++seed) {
    auto built = arc(world, {0.3, 1e-3, 12, 0.2}, 0, seed);
    const double landmarks_before_m = rms_landmark_error_m(built, world);
    MapUpdate disturbed;  // the window of local adjustment, with the landmarks anchored there
    Random random(seed);
    const auto problem_of = [&] {
      return make_local_ba_problem(built.map, KeyframeId{7}, {world.camera}, options);
    };
    const auto free_keyframes = [&] {
      std::set<KeyframeId> ids;
      const auto problem = problem_of();
      for (size_t i = 0; i < problem.keyframes.size(); ++i) {
        if (problem.bundle.fixed[i] == 0) ids.insert(problem.keyframes[i]);
      }
      return ids;
    }();
    ASSERT_EQ(free_keyframes.size(), 4U);
    for (const KeyframeId id : free_keyframes) {
      disturbed.T_world_camera.emplace_back(
          id, built.map.keyframe(id).T_world_camera * test::random_step(random, 0.01, 0.01));
    }
    ASSERT_TRUE(built.map.apply(disturbed));
    const double before_m = rms_pose_error_m(built.map);
    const std::vector<Keyframe> keyframes = built.map.keyframes();
    ASSERT_TRUE(built.map.apply(run_bundle_adjustment(problem_of(), options.local_ba)));
    built.map.check_invariants();
    EXPECT_LT(rms_pose_error_m(built.map), before_m / 5) << seed;
    EXPECT_LT(rms_landmark_error_m(built, world), 0.8 * landmarks_before_m)
        << "several views know more of a landmark than the first, even with disturbed poses";
    for (const Keyframe& was : keyframes) {
      if (free_keyframes.contains(was.id)) continue;
      EXPECT_EQ(built.map.keyframe(was.id).T_world_camera.matrix(), was.T_world_camera.matrix());
    }
  }
}

TEST(CullingLaws, ErasesExactlyTheUnconfirmedLandmarksOfOneKeyframe) {
  for (uint64_t seed = 0; seed < 20; ++seed) {
    test::RandomMap random(seed);
    Map& map = random.grow(500).map();
    MappingOptions options;
    options.cull_after_keyframes = 1 + static_cast<int>(seed % 4);
    options.cull_min_observations = 2 + static_cast<int>(seed % 2);
    const auto born =
        static_cast<uint32_t>(static_cast<int>(map.keyframes().size()) - 1 - options.cull_after_keyframes);
    std::vector<LandmarkId> expected;
    for (const LandmarkId id : map.landmark_ids()) {
      const Landmark& landmark = map.landmark(id);
      const bool confirmed = static_cast<int>(landmark.observations.size()) >= options.cull_min_observations;
      if (confirmed || landmark.anchor != KeyframeId{born}) expected.push_back(id);
    }
    const auto erased = map.landmark_count() - expected.size();
    EXPECT_EQ(static_cast<size_t>(cull_landmarks(map, options)), erased);
    EXPECT_EQ(map.landmark_ids(), expected);
    map.check_invariants();
    EXPECT_EQ(cull_landmarks(map, options), 0) << "twice";
  }
}

/// Observations of all keyframes, by landmark.
std::map<LandmarkId, std::vector<Observation>> observations_of(const Map& map) {
  std::map<LandmarkId, std::vector<Observation>> all;
  for (const LandmarkId id : map.landmark_ids()) all[id] = map.landmark(id).observations;
  return all;
}

TEST(TrackCompletionLaws, ACompleteMapStaysAsItIs) {
  const auto world = test::make_world(1500, 1);
  for (uint64_t seed = 0; seed < 3; ++seed) {
    auto built = arc(world, {0.1, 1e-4, 5, 0.1}, 0, seed);
    // A quarter of the observations are missing.
    Random random(seed);
    size_t removed = 0;
    for (const LandmarkId id : built.map.landmark_ids()) {
      const auto seen = built.map.landmark(id).observations;
      for (size_t i = 1; i < seen.size(); ++i) {
        if (random.uniform() >= 0.25) continue;
        built.map.remove_observation(id, seen[i]);
        ++removed;
      }
    }
    const auto count = [&] {
      size_t observations = 0;
      for (const auto& [id, seen] : observations_of(built.map)) observations += seen.size();
      return observations;
    };
    const size_t before = count();
    complete_tracks(built.map, world.camera, {}, {});
    built.map.check_invariants();
    EXPECT_GT(count() - before, removed * 9 / 10);
    complete_tracks(built.map, world.camera, {}, {});  // what the first pass merged may be matched now
    const auto complete = observations_of(built.map);
    complete_tracks(built.map, world.camera, {}, {});
    EXPECT_EQ(observations_of(built.map), complete);
  }
}

}  // namespace
}  // namespace kinloop
