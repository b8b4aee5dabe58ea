#include "session/plan/run_plan.hpp"

#include <gmock/gmock.h>

#include "tests/support/expect_error.hpp"

namespace kinloop {
namespace {

using testing::HasSubstr;

RunRequest small_room(std::vector<std::string> assignments = {}) {
  RunRequest request;
  request.source.sequence = "sim:room";
  request.settings.threads = 1;
  request.settings.assignments = {"sim.frames=2", "sim.width=64", "sim.height=48"};
  request.settings.assignments.insert(request.settings.assignments.end(), assignments.begin(),
                                      assignments.end());
  return request;
}

TEST(RunPlan, SettingsReachTheSourceAndTheOptions) {
  RunRequest request = small_room({"features.count=77"});
  request.settings.memory_mib = 40;
  const RunPlan plan = plan_run(request);
  EXPECT_EQ(plan.source->info().frames, 2U);
  EXPECT_EQ(plan.camera.color.width, 64);
  EXPECT_EQ(plan.options.slam.features.count, 77);
  EXPECT_EQ(plan.options.slam.global_ba.threads, 1);
  EXPECT_EQ(plan.options.slam.keyframe_memory_mib + plan.options.dense.image_memory_mib, 40);
  EXPECT_EQ(plan.options.slam.executor.mode, SlamOptions().executor.mode);
  EXPECT_FALSE(plan.start);
  EXPECT_EQ(plan.dropped(), 0U);
}

TEST(RunPlan, FlagsPrevailOverAssignments) {
  RunRequest request = small_room({"loop.enabled=true", "loop.pose_graph.solver=ceres"});
  EXPECT_TRUE(set_up_run(request.settings).options.slam.loop.enabled);
  request.settings.no_loop = true;
  request.settings.solver = "builtin";
  const RunOptions options = set_up_run(request.settings).options;
  EXPECT_FALSE(options.slam.loop.enabled);
  EXPECT_EQ(options.slam.loop.pose_graph.solver, PoseGraphSolver::kBuiltin);
}

TEST(RunPlan, AssignmentsPrevailOverTheBudget) {
  RunRequest request = small_room();
  request.settings.budget_percent = 1;
  EXPECT_LT(set_up_run(request.settings).options.slam.features.count, SlamOptions().features.count);
  request.settings.assignments.emplace_back("features.count=1234");
  EXPECT_EQ(set_up_run(request.settings).options.slam.features.count, 1234);
}

TEST(RunPlan, ResultsOfPacedFramesAreAppliedWhenReadyUnlessTheUserChoseOtherwise) {
  RunRequest request = small_room();
  request.pace_hz = 1000;
  const RunPlan live = plan_run(request);
  EXPECT_NE(live.paced, nullptr);
  EXPECT_TRUE(live.source->info().live);
  EXPECT_EQ(live.options.slam.executor.mode, ExecutorMode::kLive);
  request.settings.assignments.emplace_back("executor.mode=inline");
  EXPECT_EQ(plan_run(request).options.slam.executor.mode, ExecutorMode::kInline);
}

TEST(RunPlan, WrongSettingsAreRejectedBeforeTheSourceIsOpened) {
  RunRequest request = small_room({"features.count=1"});
  request.source.sequence = "no such folder";
  EXPECT_THAT(test::usage_error([&] { plan_run(request); }), HasSubstr("features.count"));
}

TEST(RunPlan, TheDepthRangeIsThatOfTheSensor) {
  const RunPlan plan = plan_run(small_room({"sim.sensor=kinect2", "dense.max_depth_m=12"}));
  EXPECT_EQ(plan.options.dense.limits.max_depth_m, plan.camera.sensor.max_depth_m);
  EXPECT_EQ(plan.options.mesh.limits.max_depth_m, plan.camera.sensor.max_depth_m);
}

}  // namespace
}  // namespace kinloop
