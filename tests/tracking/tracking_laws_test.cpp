// Laws of tracking: what its results may not depend on, and how large their errors are.

#include <algorithm>
#include <numeric>

#include <gtest/gtest.h>

#include "kinloop/tracking/keypoint_tracking.hpp"
#include "kinloop/tracking/motion/motion_compensation.hpp"
#include "kinloop/tracking/motion/motion_model.hpp"
#include "tests/support/random_map.hpp"
#include "tests/support/synthetic_map.hpp"

namespace kinloop {
namespace {

using test::difference;

/// Observations with exactly the noise that the solvers assume.
test::ObservationNoise modelled_noise() {
  return {1.0, kKeypointInverseDepthSigmaPerM, 12, 0.2};
}

/// A map of exact landmarks seen from three keyframes, each in a true pose.
class TrackingLaws : public testing::Test {
 protected:
  TrackingLaws() {
    for (int i = 0; i < 3; ++i) {
      const auto view =
          test::observe(world_, test::pose_on_arc(i), {0, 0, 12, 0}, 10 + static_cast<uint64_t>(i));
      test::add_view(built_, world_, view, test::pose_on_arc(i));
    }
    MapUpdate exact;
    for (const auto& [point, landmark] : built_.landmark_of_point)
      exact.p_world.emplace_back(landmark, world_.p_world[point]);
    built_.map.apply(exact);
  }

  /// The pose of a camera near the reference, relative to it.
  static SE3 near_reference(Random& random) { return test::random_step(random, 0.04, 0.03); }

  [[nodiscard]] LocalMap local_map() const { return make_local_map(built_.map, kReference, {}); }

  [[nodiscard]] test::SyntheticView view_from(const SE3& T_reference_camera,
                                              const test::ObservationNoise& noise, uint64_t seed) const {
    return test::observe(world_, test::pose_on_arc(1) * T_reference_camera, noise, seed);
  }

  [[nodiscard]] TrackedFrame track(const test::SyntheticView& view, const LocalMap& local,
                                   const SE3& guess) const {
    const Frame frame = test::make_frame(1, view);
    return track_local_map({frame, local, sensor_, {}}, guess, 8);
  }

  static constexpr KeyframeId kReference{1};
  test::SyntheticWorld world_ = test::make_world(3000, 1);
  Sensor sensor_{world_.camera};
  test::SyntheticMap built_;
};

TEST_F(TrackingLaws, WithoutNoiseThePoseIsExact) {
  Random random(2);
  for (uint64_t seed = 0; seed < 10; ++seed) {
    const SE3 truth = near_reference(random);
    const SE3 guess = truth * test::random_step(random, 0.002, 0.002);
    const auto result = track(view_from(truth, {0, 0, 12, 0.2}, seed), local_map(), guess);
    ASSERT_TRUE(result.is_located());
    EXPECT_LT(difference(result.T_reference_camera, truth), 2e-6) << "pixels are floats";
  }
}

TEST_F(TrackingLaws, TheWorldFrameDoesNotMatter) {
  Random random(3);
  for (uint64_t seed = 0; seed < 5; ++seed) {
    const SE3 truth = near_reference(random);
    const SE3 guess = truth * test::random_step(random, 0.002, 0.002);
    const auto view = view_from(truth, modelled_noise(), seed);
    const auto before = track(view, local_map(), guess);
    test::move_world(built_.map, test::random_step(random, 3, 1));
    const auto after = track(view, local_map(), guess);
    ASSERT_TRUE(before.is_located());
    EXPECT_LT(difference(before.T_reference_camera, after.T_reference_camera), 1e-9);
    EXPECT_EQ(before.matches.size(), after.matches.size());
  }
}

/// The local map with its landmarks in another order.
LocalMap permuted(const LocalMap& local, const std::vector<uint32_t>& order) {
  LocalMap result = local;
  for (uint32_t i = 0; i < order.size(); ++i) {
    const uint32_t from = order[i];
    result.ids[i] = local.ids[from];
    result.index_of[local.ids[from]] = i;
    result.p_reference[i] = local.p_reference[from];
    result.viewing_directions[i] = local.viewing_directions[from];
    result.observed_distances_m[i] = local.observed_distances_m[from];
    result.observed_levels[i] = local.observed_levels[from];
    result.view_of[i] = local.view_of[from];
    result.feature_of[i] = local.feature_of[from];
  }
  result.descriptors = cv::Mat();
  for (const uint32_t from : order)
    result.descriptors.push_back(local.descriptors.row(static_cast<int>(from)));
  return result;
}

/// The view with its keypoints in another order.
test::SyntheticView permuted(const test::SyntheticView& view, const std::vector<uint32_t>& order) {
  Features features = *view.features;
  test::SyntheticView result;
  features.descriptors = cv::Mat();
  for (uint32_t i = 0; i < order.size(); ++i) {
    const uint32_t from = order[i];
    features.pixels[i] = view.features->pixels[from];
    features.depths_m[i] = view.features->depths_m[from];
    features.descriptors.push_back(view.features->descriptors.row(static_cast<int>(from)));
    result.point_of.push_back(view.point_of[from]);
  }
  result.features = std::make_shared<const Features>(std::move(features));
  return result;
}

TEST_F(TrackingLaws, TheOrderOfLandmarksAndKeypointsDoesNotMatter) {
  Random random(4);
  for (uint64_t seed = 0; seed < 5; ++seed) {
    const SE3 truth = near_reference(random), guess = truth * test::random_step(random, 0.002, 0.002);
    const auto view = view_from(truth, modelled_noise(), seed);
    const LocalMap local = local_map();
    const auto shuffled = [&](size_t count) {
      return sample_without_replacement(random, static_cast<uint32_t>(count), static_cast<uint32_t>(count));
    };
    const auto one = track(view, local, guess);
    const auto other = track(permuted(view, shuffled(view.features->size())),
                             permuted(local, shuffled(local.size())), guess);
    ASSERT_TRUE(one.is_located());
    EXPECT_LT(difference(one.T_reference_camera, other.T_reference_camera), 1e-9);
    EXPECT_EQ(one.matches.size(), other.matches.size());
  }
}

/// The squared error in units of the reported covariance is chi2 with 6 degrees of freedom: mean 6,
/// deviation sqrt(12).
TEST_F(TrackingLaws, TheCovarianceIsThatOfTheErrors) {
  constexpr int kTrials = 200;
  Random random(5);
  const LocalMap local = local_map();
  double sum = 0;
  Vector6d whitened_sum = Vector6d::Zero(), squares = Vector6d::Zero();
  for (uint64_t trial = 0; trial < kTrials; ++trial) {
    const SE3 truth = near_reference(random);
    const auto result = track(view_from(truth, modelled_noise(), 100 + trial), local, truth);
    ASSERT_TRUE(result.is_located());
    const Vector6d error = (result.T_reference_camera.inverse() * truth).log();
    const Matrix6d information = result.covariance.inverse();
    sum += error.dot(information * error);
    const Vector6d whitened = information.llt().matrixU() * error;
    whitened_sum += whitened;
    squares += whitened.cwiseAbs2();
  }
  const double nees = sum / kTrials;
  RecordProperty("nees", std::to_string(nees));
  EXPECT_NEAR(nees, 6.6, 0.75) << "three standard errors; the robust loss is a little too confident";
  for (int k = 0; k < 6; ++k) {
    EXPECT_LT(std::abs(whitened_sum[k]) / kTrials, 4 / std::sqrt(kTrials)) << "biased: " << k;
    EXPECT_NEAR(squares[k] / kTrials, 1.1, 0.35) << k;
  }
}

TEST(MotionModelLaws, ConstantVelocityIsPredictedExactly) {
  Random random(6);
  for (int trial = 0; trial < 20; ++trial) {
    const Vector6d per_second = 0.8 * test::gaussian_vector<6>(random);
    MotionModel motion;
    PredictedPose before = motion.predict(30'000'000);
    for (const int64_t ms : {33, 17, 50, 33, 100}) {  // frames of any distance
      motion.update(
          motion.velocity_of(SE3::exp(per_second * (1e-3 * static_cast<double>(ms))), ms * 1'000'000),
          ms * 1'000'000);
      for (const int64_t ahead_ms : {1, 33, 240}) {
        const SE3 truth = SE3::exp(per_second * (1e-3 * static_cast<double>(ahead_ms)));
        EXPECT_LT((motion.predict(ahead_ms * 1'000'000).T.inverse() * truth).log().norm(), 1e-12);
      }
      EXPECT_LT((motion.velocity().vector() - velocity_of_twist(per_second, 1).vector()).norm(), 1e-12);
      const PredictedPose now = motion.predict(30'000'000);
      EXPECT_LT(now.sigma_m, before.sigma_m) << "a steady camera becomes more certain";
      EXPECT_LT(now.sigma_rad, before.sigma_rad);
      before = now;
    }
  }
}

/// Keypoints of a moving rolling-shutter camera with a lens, exactly where it sees the points.
struct Moving {
  Features features;
  std::vector<Eigen::Vector3d> p_camera;  // at the stamp
};

Moving seen_in_motion(const Sensor& sensor, const Velocity& velocity, Random& random) {
  const PinholeCamera& camera = sensor.camera;
  Moving moving;
  for (int i = 0; i < 200; ++i) {
    const Eigen::Vector2d pixel =
        test::uniform_vector<2>(random, {40, 40}, {camera.width - 41.0, camera.height - 41.0});
    const Eigen::Vector3d p = camera.unproject(pixel, random.uniform(0.8, 4));
    // Newton would need two steps: the row changes little during the readout.
    double row = pixel.y() / camera.height - 0.5;
    Eigen::Vector2d raw;
    for (int round = 0; round < 20; ++round) {
      const Eigen::Vector3d at_row =
          point_in_later_camera(p, velocity, sensor.corrections(kRollingShutter) * row);
      raw = camera.distort(corrected_pixel(sensor, at_row.hnormalized()));
      row = raw.y() / camera.height - 0.5;
    }
    const double depth_time_s = sensor.corrections(kDepthDelay) + sensor.corrections(kDepthShutter) * row;
    moving.features.raw_pixels.push_back(raw.cast<float>());
    moving.features.measured_pixels.push_back(camera.undistort(raw).cast<float>());
    moving.features.measured_depths_m.push_back(
        static_cast<float>(point_in_later_camera(p, velocity, depth_time_s).z()));
    moving.p_camera.push_back(p);
  }
  Features& features = moving.features;
  features.pixels = features.measured_pixels;
  features.depths_m = features.measured_depths_m;
  features.levels.assign(features.size(), 0);
  features.sigmas_px.assign(features.size(), 1);
  return moving;
}

TEST(DeskewLaws, DeskewingAndItsInverseReturnTheRawPixel) {
  PinholeCamera camera = test::make_world(0, 1).camera;
  camera.lens.k1 = 0.08;
  camera.lens.k2 = -0.03;
  Random random(7);
  double largest_motion_px = 0;
  for (int trial = 0; trial < 10; ++trial) {
    Sensor sensor{camera};
    sensor.corrections(kRollingShutter) = random.uniform(-0.03, 0.03);
    sensor.corrections(kDepthDelay) = random.uniform(-0.02, 0.02);
    sensor.corrections(kDepthShutter) = random.uniform(-0.03, 0.03);
    sensor.corrections(kFocalX) = random.uniform(-4, 4);
    sensor.corrections(kCenterY) = random.uniform(-4, 4);
    const Velocity velocity = Velocity::from_vector(0.5 * test::gaussian_vector<6>(random));
    const Moving moving = seen_in_motion(sensor, velocity, random);
    const Features still = deskew_features(moving.features, sensor, velocity);
    for (size_t i = 0; i < still.size(); ++i) {
      const Eigen::Vector3d& p = moving.p_camera[i];
      EXPECT_LT((still.pixels[i].cast<double>() - camera.project(p)).norm(), 1e-3);
      EXPECT_NEAR(static_cast<double>(still.depths_m[i]), p.z(), 1e-5);
      const Eigen::Vector3d found =
          camera.unproject(still.pixels[i].cast<double>(), static_cast<double>(still.depths_m[i]));
      const auto raw = raw_pixel_of(sensor, found, velocity);
      ASSERT_TRUE(raw);
      EXPECT_LT((*raw - moving.features.raw_pixels[i].cast<double>()).norm(), 0.05)
          << "raw_pixel_of stops after two rounds";
      const double moved_px = (still.pixels[i] - moving.features.measured_pixels[i]).cast<double>().norm();
      largest_motion_px = std::max(largest_motion_px, moved_px);
    }
  }
  EXPECT_GT(largest_motion_px, 5) << "nothing moved";
}

}  // namespace
}  // namespace kinloop
