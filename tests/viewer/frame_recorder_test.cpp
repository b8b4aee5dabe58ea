#include "apps/run/frame_recorder.hpp"

#include <gtest/gtest.h>

#include "tests/support/synthetic_map.hpp"

namespace kinloop {
namespace {

TrackedFrame tracked(TrackingOutcome outcome, TrackingMethod method = TrackingMethod::kKeypoints) {
  TrackedFrame result;
  result.outcome = outcome;
  result.method = method;
  Frame frame;
  frame.features = std::make_shared<const Features>();
  result.frame = std::make_shared<const Frame>(frame);
  return result;
}

LoggedFrame logged(const TrackedFrame& frame) {
  constexpr int kHeight_px = 480;
  return log_entry(frame, kHeight_px);
}

/// The statuses of frames that are in doubt or not.
std::vector<std::string> statuses(bool doubtful) {
  std::vector<TrackedFrame> frames = {tracked(TrackingOutcome::kNewMap), tracked(TrackingOutcome::kTracked),
                                      tracked(TrackingOutcome::kTracked, TrackingMethod::kDense),
                                      tracked(TrackingOutcome::kLost)};
  FrameRecorder recorder;
  std::vector<LoggedFrame> log;
  for (TrackedFrame& frame : frames) {
    recorder.on_frame(frame);
    if (doubtful) doubt(frame, DoubtCause::kUnknown);
    log.push_back(logged(frame));
  }
  std::vector<std::string> all;
  for (const FrameRow& row : recorder.table(log, {})) all.push_back(row.status);
  return all;
}

TEST(FrameRecorder, DoubtReplacesEveryStatusButLost) {
  EXPECT_EQ(statuses(false), (std::vector<std::string>{"tracked", "tracked", "dense", "lost"}));
  EXPECT_EQ(statuses(true), (std::vector<std::string>{"doubtful", "doubtful", "doubtful", "lost"}));
}

TEST(FrameRecorder, SigmaIsThatOfTheLeastCertainDirection) {
  TrackedFrame frame = tracked(TrackingOutcome::kTracked), lost = tracked(TrackingOutcome::kLost);
  frame.world_covariance.diagonal() << 1e-6, 4e-6, 9e-6, 1, 1, 1;
  lost.world_covariance = frame.world_covariance;
  FrameRecorder recorder;
  recorder.on_frame(frame);
  recorder.on_frame(lost);
  const FrameTable table = recorder.table(std::vector{logged(frame), logged(lost)}, {});
  EXPECT_NEAR(table[0].sigma_m, 3e-3, 1e-9);
  EXPECT_EQ(table[1].sigma_m, 0);
}

TEST(FrameRecorder, LivePosesAreThoseThatTrackingGaveInTheMainComponent) {
  test::SyntheticMap built;
  const auto world = test::make_world(100, 1);
  for (int i = 0; i < 2; ++i)
    test::add_view(built, world, test::observe(world, test::pose_on_arc(i), {}, 1), test::pose_on_arc(i));
  FrameRecorder recorder;
  std::vector<LoggedFrame> log;
  for (int i = 0; i < 4; ++i) {
    TrackedFrame frame = tracked(TrackingOutcome::kTracked);
    frame.stamp_ns = i;
    frame.reference = KeyframeId{0};
    frame.T_world_camera.translation.x() = i;
    if (i == 1) doubt(frame, DoubtCause::kUnknown);
    recorder.record_pose(frame);
    recorder.on_frame(frame);
    recorder.on_map(built.map);
    frame.trust = {};  // trusted later
    log.push_back(logged(frame));
  }
  log[2].outcome = TrackingOutcome::kLost;
  const auto live = recorder.live_poses(log, built.map);
  ASSERT_EQ(live.size(), 2U);
  EXPECT_EQ(live[0].stamp_ns, 0);
  EXPECT_EQ(live[1].stamp_ns, 3);
  EXPECT_EQ(live[1].T_world_camera.translation.x(), 3);
}

/// A keyframe is tracked once more after its pose has been given.
TEST(FrameRecorder, LivePosesAreThoseBeforeTheFrameIsMapped) {
  test::SyntheticMap built;
  const auto world = test::make_world(100, 1);
  test::add_view(built, world, test::observe(world, test::pose_on_arc(0), {}, 1), test::pose_on_arc(0));
  FrameRecorder recorder;
  recorder.on_map(built.map);
  TrackedFrame frame = tracked(TrackingOutcome::kTracked);
  frame.reference = KeyframeId{0};
  frame.T_world_camera.translation.x() = 1;
  recorder.record_pose(frame);
  frame.T_world_camera.translation.x() = 2;
  recorder.on_frame(frame);
  const auto live = recorder.live_poses(std::vector{logged(frame)}, built.map);
  ASSERT_EQ(live.size(), 1U);
  EXPECT_EQ(live[0].T_world_camera.translation.x(), 1);
}

/// Its world frame was another one then.
TEST(FrameRecorder, LivePosesBeforeTheirComponentWasJoinedAreLeftOut) {
  Map map;
  const auto features = std::make_shared<const Features>();
  map.add_keyframe(FrameId{0}, 0, SE3{}, features, 0);
  FrameRecorder recorder;
  std::vector<LoggedFrame> log;
  const auto add = [&](KeyframeId reference, TrackingOutcome outcome) {
    TrackedFrame frame = tracked(outcome);
    frame.stamp_ns = static_cast<int64_t>(log.size());
    frame.reference = reference;
    frame.component = map.keyframe(reference).component;
    recorder.record_pose(frame);
    recorder.on_frame(frame);
    recorder.on_map(map);
    log.push_back(logged(frame));
  };
  add(KeyframeId{0}, TrackingOutcome::kNewMap);
  add(KeyframeId{0}, TrackingOutcome::kTracked);
  map.add_keyframe(FrameId{2}, 2, SE3{}, features, 1);
  add(KeyframeId{1}, TrackingOutcome::kNewMap);
  add(KeyframeId{1}, TrackingOutcome::kTracked);
  map.add_loop_closure(
      {.a = KeyframeId{0}, .b = KeyframeId{1}, .T_a_b = SE3{}, .stage = LoopStage::kVerified});
  add(KeyframeId{1}, TrackingOutcome::kTracked);
  std::vector<int64_t> stamps;
  for (const PoseWithCovariance& pose : recorder.live_poses(log, map)) stamps.push_back(pose.stamp_ns);
  EXPECT_EQ(stamps, (std::vector<int64_t>{0, 1, 4}));
}

}  // namespace
}  // namespace kinloop
