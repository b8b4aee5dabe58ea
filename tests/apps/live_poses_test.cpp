// The poses that kinloop run --poses-to sends while it runs.

#include <sstream>

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include "apps/live_poses/pose_sender.hpp"
#include "kinloop/geometry/trajectory.hpp"
#include "tests/apps/program_test.hpp"
#include "tests/support/synthetic_world.hpp"
#include "viewer/report/frame_table.hpp"

namespace kinloop {
namespace {

using nlohmann::json;
using test::kBadInput;
using test::kDone;
using test::kWrongUse;
using testing::HasSubstr;

std::vector<json> parsed_lines(const std::string& text) {
  std::vector<json> lines;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);) lines.push_back(json::parse(line));
  return lines;
}

SE3 transform_of(const json& T) {
  const auto& t = T["translation"];
  const auto& q = T["quaternion"];
  return {Eigen::Quaterniond(q[3], q[0], q[1], q[2]), Eigen::Vector3d(t[0], t[1], t[2])};
}

class PosesTo : public test::ProgramTest {
 protected:
  [[nodiscard]] std::string sequence(int frames = 12) const {
    test::write_room(at("seq"), "--frames " + std::to_string(frames));
    return "'" + at("seq") + "'";
  }
};

TEST_F(PosesTo, AFileHasALineForEachFrameAndTheRunIsTheSame) {
  const std::string folder = sequence();
  ASSERT_EQ(run("run " + folder + " -q -o '" + at("without") + "'").exit_code, kDone);
  const Run done =
      run("run " + folder + " -q -o '" + at("out") + "' --poses-to '" + at("out/poses.jsonl") + "'");
  ASSERT_EQ(done.exit_code, kDone) << done.err;
  EXPECT_EQ(done.err, "");
  EXPECT_EQ(read_file(at("out/trajectory.txt")), read_file(at("without/trajectory.txt")));
  const auto lines = parsed_lines(read_file(at("out/poses.jsonl")));
  const FrameTable rows = read_frame_table(at("out/frames.txt"));
  const Trajectory trajectory = read_tum_trajectory(at("out/trajectory.txt"));
  ASSERT_EQ(lines.size(), rows.size());
  ASSERT_EQ(lines.size(), trajectory.size());
  for (size_t i = 0; i < lines.size(); ++i) {
    EXPECT_EQ(lines[i]["stamp_ns"], rows[i].stamp_ns);
    EXPECT_EQ(lines[i]["status"], rows[i].status);
    EXPECT_EQ(lines[i]["component"], 0);
    const SE3 error = trajectory[i].T_world_camera.inverse() * transform_of(lines[i]["T_map_camera"]);
    EXPECT_LT(error.translation.norm(), 0.03) << i;
    if (i == 0) continue;  // defines the frame of the map
    EXPECT_GT(lines[i]["sigma_m"].get<double>(), 0);
    EXPECT_EQ(lines[i]["covariance"].size(), 21U);
  }
}

TEST_F(PosesTo, StandardOutputHasTheLinesAlone) {
  const Run done = run("run " + sequence() + " --profile -o '" + at("out") + "' --poses-to -");
  ASSERT_EQ(done.exit_code, kDone) << done.err;
  EXPECT_EQ(parsed_lines(done.out).size(), 12U);
  EXPECT_THAT(done.err, AllOf(HasSubstr("quality: good"), HasSubstr("CPU s of the process")));
}

TEST_F(PosesTo, AReaderThatLeavesEndsNothing) {
  const Run done = shell("{ '" KINLOOP_PROGRAM "' run " + sequence() + " -q -o '" + at("out") +
                         "' --poses-to -; echo $? >'" + at("code") + "'; } | true");
  EXPECT_EQ(read_file(at("code")), "0\n");
  EXPECT_THAT(done.err, HasSubstr("of 12 lines dropped"));
  EXPECT_EQ(read_tum_trajectory(at("out/trajectory.txt")).size(), 12U);
}

TEST_F(PosesTo, AbsentReadersAreCountedAndEndNothing) {
  const Run done =
      run("run " + sequence() + " -q -o '" + at("out") + "' --poses-to 'unix:" + at("socket") + "'");
  EXPECT_EQ(done.exit_code, kDone);
  EXPECT_THAT(done.err, HasSubstr("12 of 12 lines dropped"));
  EXPECT_FALSE(std::filesystem::exists(at("socket")));
}

TEST_F(PosesTo, WrongTargetsAreRefusedBeforeTheRun) {
  for (const char* target : {"udp:5005", "''"}) {
    const Run wrong = run("run sim:room -o '" + at("out") + "' --poses-to " + target);
    EXPECT_EQ(wrong.exit_code, kWrongUse) << target;
    EXPECT_THAT(wrong.err, HasSubstr("udp:HOST:PORT"));
    EXPECT_FALSE(std::filesystem::exists(at("out")));
  }
}

TEST_F(PosesTo, AClosedStandardOutputIsAnError) {
  const Run closed = run("run " + sequence() + " -q -o '" + at("out") + "' --poses-to - >&-");
  EXPECT_EQ(closed.exit_code, kBadInput);
  EXPECT_THAT(closed.err, HasSubstr("--poses-to -: is closed"));
}

TEST_F(PosesTo, AFullDiskIsSaidWithItsCauseAndLeavesWholeLines) {
  const Run full = run("run " + sequence() + " -q -o '" + at("out") + "' --poses-to /dev/full");
  EXPECT_EQ(full.exit_code, kBadInput);
  EXPECT_THAT(full.err, HasSubstr("12 of 12 lines could not be written (No space left on device)"));
  EXPECT_EQ(read_tum_trajectory(at("out/trajectory.txt")).size(), 12U);
}

/// A map of one keyframe, and a frame that was tracked relative to it.
struct SmallMap {
  Map map;
  KeyframeId keyframe = map.add_keyframe(FrameId{0}, 0, {}, std::make_shared<const Features>());

  [[nodiscard]] TrackedFrame tracked_at(const SE3& T_reference_camera) const {
    TrackedFrame tracked;
    tracked.outcome = TrackingOutcome::kTracked;
    tracked.reference = keyframe;
    tracked.T_reference_camera = T_reference_camera;
    tracked.T_world_camera = map.keyframe(keyframe).T_world_camera * T_reference_camera;
    return tracked;
  }
};

TEST(PoseLine, SaysWhatIsNotKnown) {
  const SmallMap world;
  TrackedFrame frame = world.tracked_at({});
  frame.stamp_ns = 1305031910765238000;
  const auto line = [&] { return json::parse(pose_line(frame, world.map)); };
  EXPECT_EQ(line()["stamp_ns"], 1305031910765238000);
  EXPECT_EQ(line()["status"], "tracked");
  EXPECT_TRUE(line()["sigma_m"].is_null());
  EXPECT_TRUE(line()["covariance"].is_null());
  frame.world_covariance = 4e-6 * Matrix6d::Identity();
  doubt(frame, DoubtCause::kUnknown);
  EXPECT_EQ(line()["status"], "doubtful");
  EXPECT_NEAR(line()["sigma_m"].get<double>(), 2e-3, 1e-12);
  EXPECT_EQ(line()["T_map_camera"]["quaternion"], json({0.0, 0.0, 0.0, 1.0}));
  frame.trust = {};
  frame.method = TrackingMethod::kDense;
  EXPECT_EQ(line()["status"], "dense");
  frame.outcome = TrackingOutcome::kLost;
  EXPECT_EQ(line()["status"], "lost");
  for (const char* key : {"component", "T_map_camera", "sigma_m", "covariance"})
    EXPECT_TRUE(line()[key].is_null());
}

}  // namespace
}  // namespace kinloop
