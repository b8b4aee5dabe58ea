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
