#include <fmt/format.h>
#include <gmock/gmock.h>

#include "drivers/datasets/camera_selection.hpp"
#include "kinloop/sensor/camera/camera_presets.hpp"
#include "tests/support/expect_error.hpp"
#include "tests/support/temp_folder.hpp"

namespace kinloop {
namespace {

using test::input_error;
using test::TempFolder;
using testing::AllOf;
using testing::HasSubstr;

std::string camera_with_focal_length(double focal_px) {
  return fmt::format(
      "{{width: 640, height: 480, fx: {0}, fy: {0}, cx: 318.6, cy: 255.3, distortion: [0, 0, 0, 0, 0], "
      "depth_scale: 5000, fps: 30}}",
      focal_px);
}

TEST(CameraPreset, HoldsThePublishedValues) {
  const auto fr1 = camera_preset("freiburg1");
  ASSERT_TRUE(fr1);
  EXPECT_EQ(fr1->color.fx, 517.306408);
  EXPECT_EQ(fr1->color.lens.k3, 1.163314);
  EXPECT_EQ(fr1->depth_scale, 5000);
  EXPECT_EQ(camera_preset("freiburg2")->depth_scale, 5208);
  EXPECT_EQ(camera_preset("freiburg2")->color.lens.p2, -0.000105);
  EXPECT_FALSE(camera_preset("freiburg3")->color.has_distortion());
  EXPECT_EQ(camera_preset("icl")->color.fy, 480);
  for (const char* name : {"freiburg1", "freiburg2", "freiburg3", "icl"}) {
    EXPECT_EQ(camera_preset(name)->color.width, 640);
    EXPECT_EQ(camera_preset(name)->color.height, 480);
  }
  EXPECT_FALSE(camera_preset("freiburg4"));
  EXPECT_FALSE(camera_preset(""));
}

class CameraChoice : public testing::Test {
 protected:
  /// A folder with the lists of a sequence.
  std::filesystem::path make_folder(const std::string& name) const {
    folder_.write(name + "/associations.txt", "");
    return folder_.path() / name;
  }

  TempFolder folder_;
};

TEST_F(CameraChoice, FolderNameTellsThePreset) {
  EXPECT_EQ(choose_camera(make_folder("rgbd_dataset_freiburg1_desk")).color.fx, 517.306408);
  EXPECT_EQ(choose_camera(make_folder("rgbd_dataset_freiburg2_xyz/")).depth_scale, 5208);
  EXPECT_EQ(choose_camera(make_folder("freiburg3")).color.fx, 535.4);
}

TEST_F(CameraChoice, OnlyTheFoldersOwnNameCounts) {
  EXPECT_THAT(input_error([&] { choose_camera(make_folder("freiburg1/mine")); }), HasSubstr("no camera"));
}

TEST_F(CameraChoice, FileInTheFolderWinsOverTheName) {
  const auto folder = make_folder("freiburg1");
  folder_.write("freiburg1/camera.yaml", camera_with_focal_length(517.3));
  EXPECT_EQ(choose_camera(folder).color.fx, 517.3);
}

TEST_F(CameraChoice, ArgumentWinsOverAll) {
  const auto folder = make_folder("freiburg1");
  folder_.write("freiburg1/camera.yaml", camera_with_focal_length(517.3));
  EXPECT_EQ(choose_camera(folder, "freiburg3").color.fx, 535.4);
  const auto file = folder_.write("other.yaml", camera_with_focal_length(444));
  EXPECT_EQ(choose_camera(folder, file.string()).color.fx, 444);
}

TEST_F(CameraChoice, NeverGuesses) {
  for (const char* name : {"mine", "freiburg", "freiburg1_and_freiburg2"}) {
    const auto folder = make_folder(name);
    EXPECT_THAT(input_error([&] { choose_camera(folder); }),
                AllOf(HasSubstr(folder.string()), HasSubstr("camera.yaml"), HasSubstr("--camera")));
  }
  EXPECT_THAT(input_error([&] { choose_camera(make_folder("freiburg1"), "kinect"); }),
              AllOf(HasSubstr("kinect"), HasSubstr("freiburg1")));
}

TEST_F(CameraChoice, BadFileInTheFolderIsAnErrorNotAReasonToGuess) {
  const auto folder = make_folder("freiburg1");
  folder_.write("freiburg1/camera.yaml", "width: 640\n");
  EXPECT_THAT(input_error([&] { choose_camera(folder); }), HasSubstr("missing"));
}

}  // namespace
}  // namespace kinloop
