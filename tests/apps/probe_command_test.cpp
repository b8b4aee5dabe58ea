#include <gmock/gmock.h>

#include "tests/apps/program_test.hpp"

namespace kinloop {
namespace {

using test::kBadInput;
using test::kDone;
using test::kWrongUse;
using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

class ProbeCommand : public test::ProgramTest {
 protected:
  void SetUp() override { test::write_room(at("seq"), "--frames 6"); }

  /// Replaces the camera's depth_scale, 5000.
  void set_depth_scale(const std::string& scale) const {
    const std::string file = at("seq/camera.yaml");
    ASSERT_EQ(shell("sed -i 's/^depth_scale:.*/depth_scale: " + scale + "/' '" + file + "'").exit_code,
              kDone);
  }
};

TEST_F(ProbeCommand, TellsLayoutCameraRateAndDepth) {
  const auto probed = run("probe '" + at("seq") + "'");
  EXPECT_EQ(probed.exit_code, kDone);
  EXPECT_THAT(probed.out,
              AllOf(HasSubstr("seq: TUM folder: 6 frames, 160 x 120, registered depth in 1/5000 m"),
                    HasSubstr("rate       30.00 Hz"), HasSubstr("ms after colour (median)"),
                    HasSubstr("truth      6 poses"), HasSubstr("decoded    6 frames, 0 damaged")));
  EXPECT_THAT(probed.err, Not(HasSubstr("warning")));
}

TEST_F(ProbeCommand, WarnsOfImpossibleDepth) {
  set_depth_scale("100000");
  const auto probed = run("probe '" + at("seq") + "'");
  EXPECT_EQ(probed.exit_code, kDone);
  EXPECT_THAT(probed.err, AllOf(HasSubstr("hardly possible"), HasSubstr("with depth_scale: ")));
}

TEST_F(ProbeCommand, OtherSourcesAreProbedOrRefused) {
  EXPECT_THAT(run("probe sim:room").out, HasSubstr("554 frames"));
  EXPECT_EQ(run("probe kinect1").exit_code, kWrongUse);
  const auto absent = run("probe '" + at("nowhere") + "'");
  EXPECT_EQ(absent.exit_code, kBadInput);
  EXPECT_THAT(absent.err, HasSubstr("no such folder"));
}

TEST_F(ProbeCommand, PipesInPlaceOfFilesAreRefused) {
  const auto expect_refused = [&](const std::string& recording, const std::string& file) {
    const auto probed = shell("timeout 30 '" KINLOOP_PROGRAM "' probe '" + at(recording) + "'");
    EXPECT_EQ(probed.exit_code, kBadInput) << recording;
    EXPECT_THAT(probed.err, HasSubstr(file + ": a pipe, not a regular file")) << recording;
  };
  for (const char* file : {"a.mcap", "a.bag", "a.db3", "a.mkv", "a.oni"}) {
    ASSERT_EQ(shell("mkfifo '" + at(file) + "'").exit_code, kDone);
    expect_refused(file, file);
  }
  for (const char* file : {"rgb.txt", "camera.yaml"}) {
    std::filesystem::remove(at("seq") + "/" + file);
    ASSERT_EQ(shell("mkfifo '" + at("seq") + "/" + file + "'").exit_code, kDone);
  }
  std::filesystem::remove(at("seq/associations.txt"));
  expect_refused("seq", "seq/rgb.txt");
  folder_.write("phone/odometry.csv", "timestamp, frame, x, y, z, qx, qy, qz, qw\n0.0,0,0,0,0,0,0,0,1\n");
  folder_.write("phone/camera_matrix.csv", "100,0,80\n0,100,60\n0,0,1\n");
  std::filesystem::create_directory(at("phone/depth"));
  for (const auto& depth : std::filesystem::directory_iterator(at("seq/depth")))
    std::filesystem::copy_file(depth.path(), at("phone/depth/000000.png"),
                               std::filesystem::copy_options::skip_existing);
  ASSERT_EQ(shell("mkfifo '" + at("phone/rgb.mp4") + "'").exit_code, kDone);
  expect_refused("phone", "phone/rgb.mp4");
  ASSERT_EQ(shell("mkdir '" + at("scan") + "'; mkfifo '" + at("scan/a.sens") + "'").exit_code, kDone);
  expect_refused("scan", "scan/a.sens");
}

TEST_F(ProbeCommand, LargeListsAreRefusedEarly) {
  std::filesystem::remove(at("seq/associations.txt"));
  std::filesystem::resize_file(at("seq/rgb.txt"), 200 << 20);
  const auto listed = run("probe '" + at("seq") + "'");
  EXPECT_EQ(listed.exit_code, kBadInput);
  EXPECT_THAT(listed.err, HasSubstr("seq/rgb.txt: 209715200 bytes"));
  folder_.write("nerf/transforms.json", "{}");
  std::filesystem::resize_file(at("nerf/transforms.json"), 200 << 20);
  for (const char* images : {"nerf/images/0.png", "nerf/depth/0.png"}) folder_.write(images, "");
  const auto transforms = run("probe '" + at("nerf") + "'");
  EXPECT_EQ(transforms.exit_code, kBadInput);
  EXPECT_THAT(transforms.err, HasSubstr("transforms.json: 209715200 bytes"));
}

TEST_F(ProbeCommand, PrintsTheCameraThatARunWouldUse) {
  const std::string file = at("seq/camera.yaml"), camera = read_file(file);
  EXPECT_EQ(run("probe --print-camera '" + at("seq") + "'").out, camera);
  ASSERT_EQ(shell("mv '" + file + "' '" + at("camera.yaml") + "'").exit_code, kDone);  // above the folder
  EXPECT_EQ(run("probe --print-camera '" + at("seq") + "'").out, camera);
  EXPECT_THAT(run("probe --print-camera sim:room").out, HasSubstr("depth_scale: "));
  const auto none = run("probe --print-camera '" + at("nowhere") + "'");
  EXPECT_EQ(none.exit_code, kBadInput);
  EXPECT_EQ(none.out, "");
}

TEST_F(ProbeCommand, RunNamesWhatItTookTheFolderFor) {
  const auto mapped = run("run '" + at("seq") + "' -o '" + at("out") + "'");
  EXPECT_THAT(mapped.err, HasSubstr("seq: TUM folder: 6 frames, 160 x 120"));
}

}  // namespace
}  // namespace kinloop
