// A lost camera comes back to its room, or to a place that looks alike.

#include <algorithm>

#include <gtest/gtest.h>

#include "kinloop/core/time.hpp"
#include "kinloop/geometry/trajectory.hpp"
#include "kinloop/loop/recognition/place_recognition.hpp"
#include "kinloop/place/vocabulary/default_vocabulary.hpp"
#include "kinloop/slam/slam.hpp"
#include "simulator/camera_path.hpp"
#include "simulator/simulated_source.hpp"

namespace kinloop {
namespace {

constexpr uint64_t kLookAlikeRoom = 100;
constexpr int kFirst = 30, kSecond = 25;  // frames of both visits, at 10 Hz

/// What the camera sees in its second visit.
enum class Second { kSameRoom, kSmallerDouble, kScaledDepth };

struct Visits {
  RgbdCamera camera;
  std::vector<Frame> frames;
  Trajectory truth;
};

/// Renders the room around the built-in path, whose positions are scaled: the same furniture in a room of
/// another size.
Visits visit(double scale, int frames) {
  SimulationOptions options;
  options.fps = 10;
  options.frames = frames;
  options.width = 320;
  options.height = 240;
  Trajectory path = sim::handheld_path(kLookAlikeRoom);
  for (StampedPose& pose : path) pose.T_world_camera.translation *= scale;
  SimulatedSource source("visit", kLookAlikeRoom, options, 2, path);
  Visits visit{source.camera(), {}, source.info().ground_truth};
  while (auto frame = source.next()) visit.frames.push_back(*frame);
  return visit;
}

/// The first visit and, after a gap of three seconds, the first frames of the second.
Visits both_visits(Second second) {
  Visits visits = visit(1, kFirst);
  Visits later = second == Second::kSmallerDouble ? visit(0.9, kSecond) : visits;
  const int64_t begin_ns = visits.frames.back().stamp_ns + 3 * kNsPerSecond;
  for (int i = 0; i < kSecond; ++i) {
    Frame frame = later.frames[static_cast<size_t>(i)];
    if (second == Second::kScaledDepth) frame.depth_m = cv::Mat(frame.depth_m * 0.9);  // not in place
    frame.id = FrameId{static_cast<uint32_t>(kFirst + i)};
    frame.stamp_ns = begin_ns + i * kNsPerSecond / 10;
    frame.depth_stamp_ns = frame.stamp_ns;
    visits.frames.push_back(frame);
    visits.truth.push_back(later.truth[static_cast<size_t>(i)]);
  }
  return visits;
}

/// Frames of the second visit that are said to be in the first one's room.
struct Found {
  int trusted = 0;
  double worst_m = 0;  ///< error of their position relative to the first frame
};

Found found_in_first(const Slam& slam, const Visits& visits) {
  Found found;
  for (size_t i = kFirst; i < slam.log().size(); ++i) {
    const LoggedFrame& entry = slam.log()[i];
    if (entry.is_lost() || entry.is_doubtful() || slam.map().keyframe(entry.reference).component != 0)
      continue;
    const SE3 T_world_truth = visits.truth.front().T_world_camera.inverse() * visits.truth[i].T_world_camera;
    ++found.trusted;
    found.worst_m =
        std::max(found.worst_m, (entry.world(slam.map()).translation - T_world_truth.translation).norm());
  }
  return found;
}

/// Both visits are mapped in one run.
Found found_by_mapping(const Visits& visits) {
  Slam slam(visits.camera);
  for (const Frame& frame : visits.frames) slam.process(frame);
  slam.finish();
  return found_in_first(slam, visits);
}

/// The second visit is located in the map of the first.
Found found_by_localization(const Visits& visits) {
  Slam mapping(visits.camera);
  for (size_t i = 0; i < kFirst; ++i) mapping.process(visits.frames[i]);
  mapping.finish();
  SlamOptions options;
  options.localize_only = true;
  Slam slam(visits.camera, options);
  slam.add_map(mapping.saved_map("first"));
  for (size_t i = kFirst; i < visits.frames.size(); ++i) slam.process(visits.frames[i]);
  slam.finish();
  return found_in_first(slam, visits);
}

TEST(LookAlike, ALostCameraIsFoundInItsRoom) {
  const Visits visits = both_visits(Second::kSameRoom);
  for (const Found& found : {found_by_mapping(visits), found_by_localization(visits)}) {
    EXPECT_GE(found.trusted, kSecond - 1);  // the first one has yet to be confirmed
    EXPECT_LT(found.worst_m, 0.05);
  }
}

TEST(LookAlike, ALostCameraIsNotFoundInASmallerRoomFurnishedAlike) {
  const Visits visits = both_visits(Second::kSmallerDouble);
  EXPECT_EQ(found_by_mapping(visits).trusted, 0);
  EXPECT_EQ(found_by_localization(visits).trusted, 0);
}

TEST(LookAlike, ALostCameraIsNotFoundInItsRoomIfDepthIsScaled) {
  const Visits visits = both_visits(Second::kScaledDepth);
  EXPECT_EQ(found_by_mapping(visits).trusted, 0);
  EXPECT_EQ(found_by_localization(visits).trusted, 0);
}

/// The same doors every 4 m. After 16 s the camera turns round before a blank wall.
SimulatedSource corridor(int frames) {
  SimulationOptions options;
  options.frames = frames;
  options.corridor = true;
  options.fps = 10;
  options.width = 320;
  options.height = 240;
  return {"corridor", kLookAlikeRoom, options, 2};
}

TEST(LookAlike, WhereTheSameDoorsRepeatTheCameraIsNotFoundAtTheWrongOne) {
  SimulatedSource source = corridor(250);
  Slam slam(source.camera());
  while (auto frame = source.next()) slam.process(*frame);
  const Trajectory& truth = source.info().ground_truth;
  slam.finish();
  int trusted = 0;
  for (const LoggedFrame& entry : slam.log()) {
    if (entry.is_lost() || entry.is_doubtful() || slam.map().keyframe(entry.reference).component != 0)
      continue;
    const auto true_pose = pose_at(truth, entry.stamp_ns, kNsPerSecond);
    ASSERT_TRUE(true_pose);
    const SE3 T_world_truth = truth.front().T_world_camera.inverse() * *true_pose;
    EXPECT_LT((entry.world(slam.map()).translation - T_world_truth.translation).norm(), 0.5)
        << to_seconds(entry.stamp_ns - truth.front().stamp_ns) << " s";
    ++trusted;
  }
  EXPECT_GT(trusted, 100) << "the way there is tracked";
}

/// Whether the places of all keyframes of a map have doubles, by keyframe.
std::vector<bool> doubles(const Slam& slam, const RgbdCamera& camera) {
  const Map& map = slam.map();
  PlaceRecognition places({camera.color}, {}, load_default_vocabulary());
  for (const Keyframe& keyframe : map.keyframes()) places.add(keyframe);
  std::vector<bool> found;
  for (const Keyframe& keyframe : map.keyframes()) found.push_back(places.is_aliased(keyframe.id, map));
  return found;
}

TEST(LookAlike, PlacesAlongACorridorHaveDoublesButNotThoseOfARoom) {
  SimulatedSource source = corridor(80);
  Slam in_corridor(source.camera());
  while (auto frame = source.next()) in_corridor.process(*frame);
  const auto of_corridor = doubles(in_corridor, source.camera());
  EXPECT_GT(2 * std::count(of_corridor.begin(), of_corridor.end(), true), std::ssize(of_corridor));

  const Visits room = visit(1, kFirst);
  Slam in_room(room.camera);
  for (const Frame& frame : room.frames) in_room.process(frame);
  const auto of_room = doubles(in_room, room.camera);
  EXPECT_EQ(std::count(of_room.begin(), of_room.end(), true), 0);
}

}  // namespace
}  // namespace kinloop
