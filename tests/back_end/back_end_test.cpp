// BackEnd with stale results: every kind of stale job is repeated at once, except local bundle adjustment.

#include "kinloop/back_end/back_end.hpp"

#include <cmath>
#include <numbers>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/synthetic_map.hpp"

namespace kinloop {
namespace {

using testing::Contains;
using testing::ElementsAre;
using testing::IsEmpty;
using testing::Not;

constexpr int kRingKeyframes = 32;

/// A full turn in the room with 30 keyframes: the last two revisit the views of the first two.
SE3 ring_pose(int i) {
  return test::camera_at(2 * std::numbers::pi / 30 * i,
                         {0.1 * std::sin(0.2 * i), 0, 0.1 * std::cos(0.2 * i)});
}

/// Poses as from odometry: each step slightly off in the same direction.
SE3 drifted_ring_pose(int i) {
  SE3 T_world_camera = ring_pose(0);
  Vector6d error;
  error << 0.003, 0.001, -0.002, 0.0, 0.001, 0.0;
  for (int k = 1; k <= i; ++k) {
    T_world_camera = T_world_camera * (ring_pose(k - 1).inverse() * ring_pose(k)) * SE3::exp(error);
  }
  return T_world_camera;
}

BackEndOptions ring_options() {
  BackEndOptions options;
  options.executor.mode = ExecutorMode::kInline;  // jobs submitted at frame n are applied at n + 1
  options.self_calibration.min_keyframes = 20;
  return options;
}

bool no_doubles(const Map& /*map*/, KeyframeId /*keyframe*/) {
  return false;
}

class BackEndTest : public testing::Test {
 protected:
  BackEndTest() {
    for (int i = 0; i < kRingKeyframes; ++i) {
      if (i == kRingKeyframes - 4)
        built_.landmark_of_point.clear();  // odometry does not recognise the revisit
      const auto view = test::observe(world_, ring_pose(i), {}, 10 + static_cast<uint64_t>(i));
      test::add_view(built_, world_, view, drifted_ring_pose(i));
    }
  }

  Map& map() { return built_.map; }

  void see_the_start_again() { back_end_.add(revisit()); }

  LoopVerificationProblem revisit() {
    const LoopClosure loop{
        .a = KeyframeId{1}, .b = last_, .T_a_b = ring_pose(1).inverse() * ring_pose(kRingKeyframes - 1)};
    LoopVerificationProblem problem = make_loop_verification_problem(map().keyframe(last_));
    problem.candidates.push_back({loop, {}, make_local_map(map(), loop.a, {})});
    return problem;
  }

  /// Processes a frame; `added` is its keyframe, if valid.
  AppliedResults next_frame(KeyframeId added = {}) {
    AppliedResults results = back_end_.apply_due(now_);
    back_end_.submit(now_, {map(), log_, sensor_, added});
    ++now_.value;
    return results;
  }

  static std::vector<std::string> jobs(const AppliedResults& results) {
    std::vector<std::string> kinds;
    for (const auto& [kind, elapsed] : results.elapsed) kinds.emplace_back(kind);
    return kinds;
  }

  double drift_m() { return test::distance_m(map().keyframe(last_).T_world_camera, ring_pose(31)); }

  test::SyntheticWorld world_ = test::make_world(4000, 1);
  test::SyntheticMap built_;
  const KeyframeId last_{kRingKeyframes - 1};
  FrameLog log_;
  Sensor sensor_{world_.camera};
  FrameId now_{0};
  BackEnd back_end_{built_.map, nominal_estimate(sensor_), ring_options(), no_doubles};
};

TEST_F(BackEndTest, NoJobIsDueInitially) {
  next_frame();
  EXPECT_THAT(jobs(next_frame()), IsEmpty());
}

TEST_F(BackEndTest, VerifiedLoopIsCorrectedThenAdjusted) {
  const double before_m = drift_m();
  see_the_start_again();
  next_frame();
  EXPECT_THAT(jobs(next_frame()), ElementsAre("loop verification"));
  EXPECT_EQ(map().loop_closures().size(), 1U);
  EXPECT_THAT(jobs(next_frame()), ElementsAre("loop correction"));
  EXPECT_LT(drift_m(), 0.3 * before_m);
  EXPECT_THAT(jobs(next_frame()), ElementsAre("global bundle adjustment"));
  EXPECT_THAT(jobs(next_frame()), IsEmpty());
  map().check_invariants();
}

TEST_F(BackEndTest, StaleLoopCorrectionIsRepeatedWithItsMerges) {
  const double before_m = drift_m();
  see_the_start_again();
  next_frame();
  next_frame();           // verified; the correction is now in flight
  map().advance_epoch();  // as another correction would
  const size_t landmarks = map().landmark_count();
  const AppliedResults stale = next_frame();
  EXPECT_THAT(stale.stale, ElementsAre("loop correction"));
  EXPECT_FALSE(stale.map_changed);
  EXPECT_EQ(drift_m(), before_m);
  const AppliedResults repeated = next_frame();
  EXPECT_THAT(jobs(repeated), ElementsAre("loop correction"));
  EXPECT_TRUE(repeated.map_changed);
  EXPECT_LT(drift_m(), 0.3 * before_m);
  EXPECT_LT(map().landmark_count(), landmarks);
}

TEST_F(BackEndTest, StaleGlobalBundleAdjustmentIsRepeatedBeforeTheMapGrows) {
  see_the_start_again();
  for (int i = 0; i < 3; ++i) next_frame();  // verified and corrected; the adjustment is now in flight
  map().advance_epoch();
  EXPECT_THAT(next_frame().stale, ElementsAre("global bundle adjustment"));
  const AppliedResults repeated = next_frame();
  EXPECT_THAT(jobs(repeated), ElementsAre("global bundle adjustment"));
  EXPECT_TRUE(repeated.map_changed);
  EXPECT_THAT(jobs(next_frame()), IsEmpty());
}

TEST_F(BackEndTest, StaleSelfCalibrationIsRepeatedBeforeTheMapGrows) {
  next_frame(last_);  // starts self-calibration and local bundle adjustment
  map().advance_epoch();
  const AppliedResults stale = next_frame();
  EXPECT_THAT(stale.stale, Contains("self-calibration"));
  EXPECT_FALSE(stale.sensor);
  const AppliedResults repeated = next_frame();
  EXPECT_THAT(jobs(repeated), Contains("self-calibration"));
  EXPECT_TRUE(repeated.sensor);
  // After one was applied, the next waits until the number of keyframes has doubled.
  next_frame(last_);
  EXPECT_THAT(jobs(next_frame()), Not(Contains("self-calibration")));
}

TEST_F(BackEndTest, StaleLocalBundleAdjustmentIsNotRepeated) {
  next_frame(last_);
  map().advance_epoch();
  EXPECT_THAT(next_frame().stale, Contains("local bundle adjustment"));
  EXPECT_THAT(jobs(next_frame()), Not(Contains("local bundle adjustment")));
  next_frame(last_);
  const AppliedResults next = next_frame();
  EXPECT_THAT(jobs(next), Contains("local bundle adjustment"));
  EXPECT_THAT(next.stale, IsEmpty());
}

TEST_F(BackEndTest, SelfCalibrationWaitsForCorrections) {
  see_the_start_again();
  next_frame();
  next_frame(last_);  // the correction runs first
  const AppliedResults corrected = next_frame(last_);
  EXPECT_THAT(jobs(corrected), Contains("loop correction"));
  EXPECT_THAT(jobs(corrected), Not(Contains("self-calibration")));
}

/// Each would make the others stale.
TEST_F(BackEndTest, JobsThatMoveTheWholeMapWaitForEachOther) {
  BackEndOptions options = ring_options();
  options.executor.mode = ExecutorMode::kLagged;
  BackEnd back_end(map(), nominal_estimate(sensor_), options, no_doubles);
  back_end.add(revisit());
  std::vector<std::string> done;
  for (uint32_t now = 0; now < 80; ++now) {
    const AppliedResults results = back_end.apply_due(FrameId{now});
    EXPECT_THAT(results.stale, IsEmpty()) << now;
    for (const std::string& kind : jobs(results)) done.push_back(kind);
    back_end.submit(FrameId{now}, {map(), log_, sensor_, now == 0 ? last_ : KeyframeId{}});
  }
  EXPECT_THAT(done, ElementsAre("loop verification", "local bundle adjustment", "self-calibration",
                                "loop correction", "global bundle adjustment"));
}

/// Their copies would delay the frame at which they start.
TEST_F(BackEndTest, ALargeMapIsNotAdjustedAsAWholeDuringTheRun) {
  const auto jobs_in_a_map_of_at_most = [&](int keyframes) {
    BackEndOptions options = ring_options();
    options.global_ba_max_keyframes = options.self_calibration.max_keyframes = keyframes;
    test::SyntheticMap built = built_;
    BackEnd back_end(built.map, nominal_estimate(sensor_), options, no_doubles);
    back_end.add(revisit());
    std::vector<std::string> done;
    for (uint32_t now = 0; now < 8; ++now) {
      for (const std::string& kind : jobs(back_end.apply_due(FrameId{now}))) done.push_back(kind);
      back_end.submit(FrameId{now}, {built.map, log_, sensor_, now == 0 ? last_ : KeyframeId{}});
    }
    return done;
  };
  const std::vector<std::string> all = jobs_in_a_map_of_at_most(kRingKeyframes),
                                 without = jobs_in_a_map_of_at_most(kRingKeyframes - 1);
  for (const char* of_the_whole_map : {"global bundle adjustment", "self-calibration"}) {
    EXPECT_THAT(all, Contains(of_the_whole_map));
    EXPECT_THAT(without, Not(Contains(of_the_whole_map)));
  }
  EXPECT_THAT(without, Contains("loop correction"));
}

TEST_F(BackEndTest, ApplyRemainingRepeatsAStaleLoopCorrection) {
  const double before_m = drift_m();
  see_the_start_again();
  next_frame();
  next_frame();
  map().advance_epoch();
  const AppliedResults rest = back_end_.apply_remaining({map(), log_, sensor_, {}});
  EXPECT_THAT(rest.stale, ElementsAre("loop correction"));
  EXPECT_LT(drift_m(), 0.3 * before_m);
}

}  // namespace
}  // namespace kinloop
