// Tests of saved maps: continuing, localization and merging.

#include <gtest/gtest.h>

#include "kinloop/core/files/text_file.hpp"
#include "kinloop/io/map_file/map_file.hpp"
#include "kinloop/slam/slam.hpp"
#include "tests/slam/recording.hpp"
#include "tests/support/temp_folder.hpp"
#include "tools/evaluation/evaluate.hpp"

namespace kinloop {
namespace {

using test::record_simulation;
using test::Recording;

constexpr size_t kFrames = 60, kHalf = 30;

/// A simulated walk, slow enough for its two halves to overlap.
const Recording& walk() {
  static const Recording kRecording = record_simulation("sim:room", kFrames);
  return kRecording;
}

/// Frames of another room.
const std::vector<Frame>& elsewhere() {
  static const Recording kRecording = record_simulation("sim:room:5", 8);
  return kRecording.frames;
}

Trajectory process(Slam& slam, size_t begin, size_t end) {
  for (size_t i = begin; i < end; ++i) slam.process(walk().frames[i]);
  return slam.finish();
}

/// The map of frames [begin, end).
SavedMap map_of(size_t begin, size_t end) {
  Slam slam(walk().camera);
  process(slam, begin, end);
  return slam.saved_map("frames");
}

const SavedMap& first_half() {
  static const SavedMap kMap = map_of(0, kHalf);
  return kMap;
}

std::string file_bytes(const SavedMap& saved) {
  const test::TempFolder folder;
  write_map(folder.path() / "map", saved, 0, {});
  return read_file(folder.path() / "map");
}

std::vector<std::array<double, 7>> numbers(const Trajectory& trajectory) {
  std::vector<std::array<double, 7>> all;
  for (const auto& [stamp_ns, T] : trajectory) {
    all.push_back({T.translation.x(), T.translation.y(), T.translation.z(), T.rotation.x(), T.rotation.y(),
                   T.rotation.z(), T.rotation.w()});
  }
  return all;
}

TEST(SavedMap, SavedAndLoadedMapsAreEqual) {
  Slam slam(walk().camera);
  const Trajectory trajectory = process(slam, 0, kHalf);
  const SavedMap saved = slam.saved_map("frames");

  Slam loaded(walk().camera);
  EXPECT_EQ(loaded.add_map(saved), 0U);
  EXPECT_EQ(numbers(trajectory_of(loaded.log(), loaded.map())), numbers(trajectory));
  EXPECT_TRUE(loaded.session_log().empty());
  loaded.map().check_invariants();
  EXPECT_TRUE(file_bytes(loaded.saved_map("nothing")) == file_bytes(saved));
}

TEST(SavedMap, LocalizationFindsPosesAndKeepsTheMapUnchanged) {
  SlamOptions options;
  options.localize_only = true;
  Slam slam(walk().camera, options);
  slam.add_map(first_half());
  const std::string before = file_bytes(slam.saved_map(""));
  const Trajectory found = process(slam, kHalf, kFrames);
  ASSERT_GT(found.size(), (kFrames - kHalf) * 8 / 10);

  // Poses in the frame of the map, which the first half aligns with the ground-truth world.
  Trajectory both;
  for (const FrameRecord& frame : first_half().frames) {
    const SE3& T_world_keyframe = first_half().map.keyframes[frame.reference.value].T_world_camera;
    both.push_back({frame.stamp_ns, T_world_keyframe * frame.T_reference_camera});
  }
  both.insert(both.end(), found.begin(), found.end());
  const auto ate = absolute_trajectory_error(both, walk().truth);
  ASSERT_TRUE(ate.has_value());
  EXPECT_LT(ate->error_m.max, 0.05);

  SavedMap after = slam.saved_map("");
  after.frames.resize(kHalf);
  after.sessions.resize(1);
  EXPECT_TRUE(file_bytes(after) == before);
}

TEST(SavedMap, LocalizationInAnUnknownPlaceFindsNothing) {
  SlamOptions options;
  options.localize_only = true;
  Slam slam(walk().camera, options);
  slam.add_map(first_half());
  for (const Frame& frame : elsewhere()) slam.process(frame);
  EXPECT_TRUE(slam.finish().empty());
}

TEST(SavedMap, ContinuedMappingKeepsWorldFrameAndFrames) {
  Slam slam(walk().camera);
  slam.add_map(first_half());
  const Trajectory second = process(slam, kHalf, kFrames);
  EXPECT_GE(second.size(), kFrames - kHalf - 2);
  EXPECT_EQ(slam.session_log().size(), kFrames - kHalf);
  const Map& map = slam.map();
  map.check_invariants();
  EXPECT_GT(map.keyframes().size(), first_half().map.keyframes.size());
  for (const Keyframe& keyframe : map.keyframes()) EXPECT_EQ(keyframe.component, 0U);
  for (size_t i = 1; i < slam.log().size(); ++i) EXPECT_LT(slam.log()[i - 1].id, slam.log()[i].id);

  const auto ate = absolute_trajectory_error(trajectory_of(slam.log(), map), walk().truth);
  ASSERT_TRUE(ate.has_value());
  EXPECT_LT(ate->error_m.rmse, 0.02);
  const SavedMap saved = slam.saved_map("more");
  ASSERT_EQ(saved.sessions.size(), 2U);
  EXPECT_LE(saved.sessions[1].first_frame, slam.session_log().front().id);
  EXPECT_GT(saved.sessions[1].first_frame, slam.log()[kHalf - 1].id);
}

TEST(SavedMap, TwoMapsAreMerged) {
  // Both contain the middle third.
  const SavedMap a = map_of(0, 40), b = map_of(20, 60);
  Slam slam(walk().camera);
  slam.add_map(a);
  EXPECT_GT(slam.add_map(b), 0U);
  EXPECT_FALSE(slam.map().loop_closures().empty());
  slam.finish();
  slam.map().check_invariants();
  for (const Keyframe& keyframe : slam.map().keyframes()) EXPECT_EQ(keyframe.component, 0U);
  const auto ate = absolute_trajectory_error(keyframe_trajectory(slam.map(), 0), walk().truth);
  ASSERT_TRUE(ate.has_value());
  EXPECT_LT(ate->error_m.rmse, 0.03);
  EXPECT_EQ(slam.saved_map("").sessions.size(), 2U);
}

/// The end of one piece and the beginning of the next see the same, one or two keyframes each.
TEST(SavedMap, AdjacentPiecesAreJoinedInBothOrders) {
  const SavedMap first = map_of(0, kHalf), second = map_of(kHalf, kFrames);
  for (const bool in_order : {true, false}) {
    Slam slam(walk().camera);
    slam.add_map(in_order ? first : second);
    slam.add_map(in_order ? second : first);
    slam.finish();
    slam.map().check_invariants();
    for (const Keyframe& keyframe : slam.map().keyframes()) EXPECT_EQ(keyframe.component, 0U) << in_order;
    const auto ate = absolute_trajectory_error(keyframe_trajectory(slam.map(), 0), walk().truth);
    ASSERT_TRUE(ate.has_value());
    EXPECT_LT(ate->error_m.rmse, 0.03);
    ASSERT_FALSE(slam.map().loop_closures().empty()) << in_order;
    for (const LoopClosure& loop : slam.map().loop_closures()) EXPECT_GE(loop.support, 2);
  }
}

TEST(SavedMap, KeyframesOfMergedMapsKeepTheirFrames) {
  SavedMap a = first_half();
  const SavedMap b = a;
  a.frames.clear();  // lost with a damaged part of the file
  Slam slam(walk().camera);
  slam.add_map(a);
  const uint32_t shift = slam.add_map(b);
  EXPECT_GT(shift, a.map.keyframes.back().frame.value);
  for (const Keyframe& keyframe : b.map.keyframes) {
    const Keyframe& added =
        slam.map().keyframe(KeyframeId{keyframe.id.value + static_cast<uint32_t>(a.map.keyframes.size())});
    EXPECT_EQ(added.frame.value, keyframe.frame.value + shift);
    EXPECT_EQ(added.stamp_ns, keyframe.stamp_ns);
  }
}

TEST(SavedMap, MapsOfDifferentPlacesStayApart) {
  const SavedMap a = first_half();
  Slam other(walk().camera);
  for (const Frame& frame : elsewhere()) other.process(frame);
  other.finish();
  Slam slam(walk().camera);
  slam.add_map(a);
  slam.add_map(other.saved_map("elsewhere"));
  slam.finish();
  EXPECT_EQ(slam.map().keyframes().front().component, 0U);
  EXPECT_EQ(slam.map().keyframes().back().component, 1U);
}

}  // namespace
}  // namespace kinloop
