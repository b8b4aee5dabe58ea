// Images of simulated rooms in which something moves.

#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <opencv2/core.hpp>

#include "kinloop/core/errors.hpp"
#include "simulator/camera_path.hpp"
#include "simulator/simulated_source.hpp"

namespace kinloop {
namespace {

constexpr uint8_t kMoving = 255, kAtRest = 128;

SimulationOptions options_with(const MoverOptions& movers) {
  SimulationOptions options;
  options.width = 160;
  options.height = 120;
  options.fps = 4;
  options.seconds = 14;
  options.spacious = true;
  options.movers = movers;
  options.noise = KinectNoise::none();
  return options;
}

MoverOptions two_people() {
  MoverOptions movers;
  movers.people = 2;
  return movers;
}

/// The same room without and with people, built once for all tests.
const SimulatedSource& empty_room() {
  static const SimulatedSource source("empty", 1, options_with({}), 2);
  return source;
}
const SimulatedSource& room_with_people() {
  static const SimulatedSource source("people", 1, options_with(two_people()), 2);
  return source;
}

bool identical(const cv::Mat& a, const cv::Mat& b) {
  return a.size() == b.size() && a.type() == b.type() && cv::norm(a, b, cv::NORM_INF) == 0;
}

TEST(MoverImages, DifferFromTheEmptyRoomWhereTheMaskSays) {
  const SimulatedSource& with = room_with_people();
  const SimulatedSource& without = empty_room();
  ASSERT_TRUE(with.has_movers());
  ASSERT_EQ(with.info().frames, without.info().frames);
  int marked = 0, changed = 0, nearer = 0, frames_with_people = 0;
  for (size_t i = 0; i < with.info().frames; ++i) {
    const Frame a = with.frame(i), b = without.frame(i);
    const cv::Mat mask = with.mover_mask(i), color_a = a.color.bgr(), color_b = b.color.bgr();
    ASSERT_EQ(mask.size(), color_a.size());
    ASSERT_EQ(cv::countNonZero(mask == kAtRest), 0);
    frames_with_people += cv::countNonZero(mask) > 100 ? 1 : 0;
    for (int y = 0; y < mask.rows; ++y) {
      for (int x = 0; x < mask.cols; ++x) {
        const float with_m = a.depth_m.at<float>(y, x), without_m = b.depth_m.at<float>(y, x);
        const bool alike = color_a.at<cv::Vec3b>(y, x) == color_b.at<cv::Vec3b>(y, x);
        if (mask.at<uint8_t>(y, x) == 0) {
          ASSERT_TRUE(alike) << "frame " << i << ", pixel " << x << " " << y;
          continue;
        }
        ++marked;
        changed += alike ? 0 : 1;
        nearer += with_m > 0 && (with_m < without_m || without_m == 0) ? 1 : 0;
        if (with_m > 0 && without_m > 0) {
          ASSERT_LE(with_m, without_m);
        }
      }
    }
  }
  EXPECT_GT(frames_with_people, static_cast<int>(with.info().frames) / 4);
  EXPECT_GT(changed, 0.97 * marked);
  EXPECT_GT(nearer, 0.9 * marked);
}

TEST(MoverImages, DepthDiffersFromTheEmptyRoomOnlyNearTheMask) {
  int all_changed = 0;
  for (size_t i = 0; i < room_with_people().info().frames; i += 3) {
    const cv::Mat changed = room_with_people().frame(i).depth_m != empty_room().frame(i).depth_m;
    all_changed += cv::countNonZero(changed);
    // A ray through the middle of a pixel may miss what none of its four sub-exposures misses, or hit it.
    const int outside = cv::countNonZero(changed & (room_with_people().mover_mask(i) == 0));
    EXPECT_LE(outside, 0.02 * cv::countNonZero(changed)) << "frame " << i;
  }
  EXPECT_GT(all_changed, 1000);
}

TEST(MoverImages, AreTheSameForAnyNumberOfThreadsAndInAnyOrder) {
  SimulationOptions noisy = options_with(two_people());
  noisy.noise = {};
  const SimulatedSource two("two", 1, noisy, 2);
  SimulatedSource one("one", 1, noisy, 1);
  const Frame late = two.frame(3);
  for (size_t i = 0; i < 4; ++i) {
    const Frame a = one.next().value(), b = two.frame(i);
    EXPECT_TRUE(identical(a.color.bgr(), b.color.bgr()));
    EXPECT_TRUE(identical(a.depth_m, b.depth_m));
    EXPECT_TRUE(identical(one.mover_mask(i), two.mover_mask(i)));
    if (i == 3) {
      EXPECT_TRUE(identical(a.color.bgr(), late.color.bgr()));
    }
  }
}

TEST(MoverImages, TheGroundTruthIsTheCamerasAsWithoutMovers) {
  const Trajectory &a = room_with_people().info().ground_truth, &b = empty_room().info().ground_truth;
  ASSERT_EQ(a.size(), b.size());
  for (size_t i = 0; i < a.size(); ++i) {
    EXPECT_EQ(a[i].stamp_ns, b[i].stamp_ns);
    EXPECT_EQ(a[i].T_world_camera.translation, b[i].T_world_camera.translation);
  }
}

TEST(MoverImages, ChairsAndDoorsAreMarkedAtRestAndWhileTheyMove) {
  MoverOptions movers;
  movers.door = true;
  movers.chairs = 3;
  const SimulatedSource source("room", 1, options_with(movers), 2);
  int at_rest = 0, moving = 0;
  for (size_t i = 0; i < source.info().frames; ++i) {
    const cv::Mat mask = source.mover_mask(i);
    at_rest += cv::countNonZero(mask == kAtRest);
    moving += cv::countNonZero(mask == kMoving);
    ASSERT_EQ(cv::countNonZero(mask), cv::countNonZero(mask == kAtRest) + cv::countNonZero(mask == kMoving));
  }
  EXPECT_GT(at_rest, 1000);
  EXPECT_GT(moving, 0);
  EXPECT_LT(moving, at_rest);
}

TEST(MoverImages, ADepthCameraOfItsOwnSeesPeopleToo) {
  SimulationOptions options = options_with(two_people());
  options.sensor = SimulatedSensor::kKinect2;
  options.width = 240;
  options.height = 135;
  options.remove_noise();
  const SimulatedSource with("people", 1, options, 2);
  options.movers = {};
  const SimulatedSource without("empty", 1, options, 2);
  int changed = 0, marked = 0;
  for (size_t i = 0; i < with.info().frames; i += 4) {
    const cv::Mat nearer = with.device_frame(i).depth_m < without.device_frame(i).depth_m - 0.05;
    changed += cv::countNonZero(nearer);
    marked += cv::countNonZero(with.mover_mask(i));
  }
  ASSERT_GT(marked, 1000);
  EXPECT_GT(changed, marked / 4);  // its image has 42 % of the pixels, and a wider view
}

TEST(MoverImages, TheShutterActsOnWhatMoves) {
  Trajectory standing = sim::handheld_path(1, 14);
  for (StampedPose& pose : standing) pose.T_world_camera = standing.front().T_world_camera;
  SimulationOptions rolling = options_with(two_people());
  const SimulatedSource global("global", 1, rolling, 2, standing);
  rolling.noise.rolling_shutter_s = 0.1;
  const SimulatedSource source("rolling", 1, rolling, 2, standing);
  // The middle rows of both are taken at the same time, the first and last 50 ms before and after.
  int middle = 0, ends = 0;
  for (size_t i = 0; i < source.info().frames; ++i) {
    const cv::Mat differs = source.mover_mask(i) != global.mover_mask(i);
    middle += cv::countNonZero(differs.rowRange(56, 64));
    ends += cv::countNonZero(differs.rowRange(104, 120)) + cv::countNonZero(differs.rowRange(0, 16));
  }
  EXPECT_GT(ends, 50);
  EXPECT_LT(3 * middle, ends);
}

TEST(MoverOptions, UnknownNamesAndNumbersAreErrors) {
  for (const std::string setting : {"movers.people=5", "movers.people=-1", "movers.dogs=1",
                                    "movers.door=ajar", "movers.chairs=many", "seconds=-1"}) {
    EXPECT_THROW(with_assignments(SimulationOptions{}, std::vector{setting}), UsageError) << setting;
  }
  const SimulationOptions options =
      with_assignments(SimulationOptions{},
                       std::vector<std::string>{"movers.people=2", "movers.door=true", "movers.chairs=1"});
  EXPECT_EQ(options.movers.people, 2);
  EXPECT_TRUE(options.movers.door);
  EXPECT_EQ(options.movers.chairs, 1);
  EXPECT_FALSE(SimulationOptions{}.movers.any());
}

}  // namespace
}  // namespace kinloop
