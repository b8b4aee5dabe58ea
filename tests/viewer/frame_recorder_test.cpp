#include "apps/run/frame_recorder.hpp"

#include <gtest/gtest.h>

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

/// The statuses of frames that are in doubt or not.
std::vector<std::string> statuses(bool doubtful) {
  std::vector<TrackedFrame> frames = {tracked(TrackingOutcome::kNewMap), tracked(TrackingOutcome::kTracked),
                                      tracked(TrackingOutcome::kTracked, TrackingMethod::kDense),
                                      tracked(TrackingOutcome::kLost)};
  FrameRecorder recorder;
  for (TrackedFrame& frame : frames) {
    recorder.on_frame(frame);
    frame.doubtful = doubtful;
  }
  std::vector<std::string> all;
  for (const FrameRow& row : recorder.table(frames, {})) all.push_back(row.status);
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
  const FrameTable table = recorder.table(std::vector{frame, lost}, {});
  EXPECT_NEAR(table[0].sigma_m, 3e-3, 1e-9);
  EXPECT_EQ(table[1].sigma_m, 0);
}

}  // namespace
}  // namespace kinloop
