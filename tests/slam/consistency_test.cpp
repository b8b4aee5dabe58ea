// Whole short sequences: the covariances are those of the errors.

#include "tools/evaluation/consistency.hpp"

#include <gtest/gtest.h>

#include "kinloop/map/frames/frame_log.hpp"
#include "kinloop/slam/slam.hpp"
#include "tests/slam/recording.hpp"

namespace kinloop {
namespace {

/// Mean consistency of the poses of several rooms: keyframes, all frames, and poses as they were tracked.
struct RunConsistency {
  Consistency keyframes, frames, online;
};

void add(Consistency& sum, const std::vector<PoseWithCovariance>& poses, const Trajectory& truth,
         double share) {
  const auto found = evaluate_consistency(poses, truth);
  ASSERT_TRUE(found);
  sum.poses += found->poses;
  sum.nees_translation += share * found->nees_translation;
  sum.nees_rotation += share * found->nees_rotation;
  sum.within_4_sigma += share * found->within_4_sigma;
}

void add_room(RunConsistency& sum, const std::string& scene, double share) {
  const test::Recording room = test::record_simulation(scene, 110);
  Slam slam(room.camera);
  std::vector<PoseWithCovariance> keyframes, frames, online;
  for (const Frame& frame : room.frames) {
    const TrackedFrame tracked = slam.process(frame);
    online.push_back({tracked.stamp_ns, tracked.T_world_camera, tracked.world_covariance});
  }
  slam.finish();
  for (const LoggedFrame& frame : slam.session_log()) {
    frames.push_back({frame.stamp_ns, frame.world(slam.map()), frame.world_covariance});
    if (frame.keyframe.valid()) keyframes.push_back(frames.back());
  }
  add(sum.keyframes, keyframes, room.truth, share);
  add(sum.frames, frames, room.truth, share);
  add(sum.online, online, room.truth, share);
}

TEST(PoseCovariances, AreThoseOfTheErrors) {
  RunConsistency mean;
  for (const char* scene : {"sim:room:21", "sim:room:22", "sim:room:24"}) add_room(mean, scene, 1.0 / 3);
  EXPECT_GT(mean.keyframes.poses, 15U);
  for (const Consistency& found : {mean.keyframes, mean.frames}) {
    for (const double nees : {found.nees_translation, found.nees_rotation}) {
      EXPECT_GT(nees, 0.5);
      EXPECT_LT(nees, 6);
    }
    EXPECT_GT(found.within_4_sigma, 0.99);
  }
  EXPECT_LT(mean.online.nees_translation, 6);
  EXPECT_LT(mean.online.nees_rotation, 6);
  EXPECT_GT(mean.online.within_4_sigma, 0.95);
}

}  // namespace
}  // namespace kinloop
