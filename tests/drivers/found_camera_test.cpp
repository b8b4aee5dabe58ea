// Folders whose camera lies beside the images, in a file of another program.

#include <fmt/format.h>
#include <gmock/gmock.h>

#include "drivers/datasets/camera_files/find_camera.hpp"
#include "drivers/datasets/open_sequence.hpp"
#include "kinloop/sensor/camera/camera_presets.hpp"
#include "tests/drivers/camera_file_samples.hpp"
#include "tests/drivers/depth_file_samples.hpp"
#include "tests/drivers/sequence_folder.hpp"
#include "tests/support/expect_error.hpp"
#include "tests/support/temp_folder.hpp"

namespace kinloop {
namespace {

using test::input_error;
using test::TempFolder;
using testing::AllOf;
using testing::HasSubstr;

const cv::Size kVga(640, 480);
constexpr const char* kMatrix = "525.5 0 318.25\n0 526.5 240.75\n0 0 1\n";

/// Depth in `units` with enough different values to tell its unit.
cv::Mat slanted_depth(int units, int step, cv::Size size = kVga) {
  cv::Mat depth(size, CV_16UC1);
  for (int y = 0; y < size.height; ++y) depth.row(y).setTo(cv::Scalar(units + step * (y % 200)));
  return depth;
}

/// rgb/ and depth/ with three frames in a folder "scene", without a camera.
class FoundCamera : public testing::Test {
 protected:
  explicit FoundCamera(const cv::Mat& depth = slanted_depth(1500, 1), cv::Size size = kVga) {
    write_images(depth, size);
  }

  void write_images(const cv::Mat& depth, cv::Size size = kVga) const {
    for (int i = 0; i < 3; ++i) {
      folder_.write(fmt::format("scene/rgb/{}.png", i),
                    test::encoded(test::make_color(i, CV_8UC3, size), ".png"));
      folder_.write(fmt::format("scene/depth/{}.png", i), test::encoded(depth, ".png"));
    }
  }

  [[nodiscard]] std::filesystem::path scene() const { return folder_.path() / "scene"; }
  [[nodiscard]] RgbdCamera camera(const std::optional<CameraArgument>& argument = {},
                                  std::optional<double> depth_scale = {}) const {
    return read_sequence(scene(), argument, depth_scale).camera;
  }
  [[nodiscard]] std::string error(const std::optional<CameraArgument>& argument = {}) const {
    return input_error([&] { static_cast<void>(camera(argument)); });
  }

  TempFolder folder_;
};

TEST_F(FoundCamera, IsTheSameInEveryFormat) {
  for (const test::CameraFileSample& sample : test::camera_file_samples()) {
    SCOPED_TRACE(sample.file);
    const auto file = folder_.write(std::string("scene/") + sample.file, sample.text);
    PinholeCamera expected = test::sample_camera();
    if (sample.distorted) expected.lens = test::sample_distortion();
    const double scale = sample.depth_scale == 0 ? 1000 : sample.depth_scale;
    for (const auto& argument :
         {std::optional<CameraArgument>(), std::optional<CameraArgument>(file.string())}) {
      EXPECT_EQ(camera(argument).color, expected);
      EXPECT_EQ(camera(argument).depth_scale, scale);
    }
    std::filesystem::remove(file);
  }
}

TEST_F(FoundCamera, MayLieAboveOrInAFolderForCalibration) {
  for (const char* name :
       {"K.txt", "scene/intrinsics.txt", "scene/calib/cam.txt", "scene/intrinsic/rgb-intrinsic.txt"}) {
    SCOPED_TRACE(name);
    const auto file = folder_.write(name, kMatrix);
    EXPECT_EQ(camera().color, test::sample_camera());
    std::filesystem::remove(file);
  }
  folder_.write("other.yaml", "Camera.fx: 5\nCamera.fy: 5\nCamera.cx: 3\nCamera.cy: 3\n");
  EXPECT_THAT(error(), HasSubstr("no camera"));  // any name above is not tried
}

TEST_F(FoundCamera, MayLieInTheFolderThatTheUserGives) {
  folder_.write("K.txt", "5 0 3\n0 5 3\n0 0 1\n");
  folder_.write("given/K.txt", kMatrix);
  std::filesystem::create_directories(folder_.path() / "given/a/b");
  std::filesystem::rename(scene(), folder_.path() / "given/a/b/c");
  EXPECT_EQ(read_sequence(folder_.path() / "given").camera.color, test::sample_camera());
  EXPECT_THAT(input_error([&] { read_sequence(folder_.path() / "given/a/b/c"); }), HasSubstr("no camera"));
}

TEST_F(FoundCamera, TheOneInTheFolderWinsOverThatAbove) {
  folder_.write("K.txt", "5 0 3\n0 5 3\n0 0 1\n");
  folder_.write("scene/K.txt", kMatrix);
  EXPECT_EQ(camera().color, test::sample_camera());
}

TEST_F(FoundCamera, TwoThatDifferAreAnErrorThatNamesBoth) {
  folder_.write("scene/K.txt", kMatrix);
  const auto more = folder_.write("scene/TUM.yaml",
                                  "Camera.fx: 525.5\nCamera.fy: 526.5\nCamera.cx: 318.25\nCamera.cy: 240.75\n"
                                  "DepthMapFactor: 2000\n");
  EXPECT_EQ(camera().depth_scale, 2000);  // the same lens: the one that states more
  folder_.write("scene/TUM.yaml", "Camera.fx: 500\nCamera.fy: 500\nCamera.cx: 318.25\nCamera.cy: 240.75\n");
  EXPECT_THAT(error(), AllOf(HasSubstr("K.txt and "), HasSubstr("TUM.yaml: cameras that differ"),
                             HasSubstr("--camera")));
  EXPECT_EQ(camera(more.string()).color.fx, 500);
}

TEST_F(FoundCamera, OfDepthIsUsedOnlyIfThereIsNoOther) {
  folder_.write("scene/depth-intrinsic.txt", "500 0 318.25\n0 500 240.75\n0 0 1\n");
  EXPECT_EQ(camera().color.fx, 500);
  folder_.write("scene/color-intrinsic.txt", kMatrix);
  EXPECT_EQ(camera().color, test::sample_camera());
}

TEST_F(FoundCamera, DamagedFileIsAnErrorOnlyIfItsNameIsThatOfACamera) {
  folder_.write("scene/notes.json", "{");
  folder_.write("scene/calibration.txt", "see the paper");
  EXPECT_THAT(error(), HasSubstr("no camera"));
  folder_.write("scene/K.txt", "525 0 318\n0 525\n");
  EXPECT_THAT(error(), HasSubstr("K.txt: no camera in a known format"));
}

TEST_F(FoundCamera, CameraYamlMayBeThatOfAnotherProgram) {
  folder_.write("scene/camera.yaml",
                "Camera.fx: 525.5\nCamera.fy: 526.5\nCamera.cx: 318.25\nCamera.cy: 240.75\n"
                "Camera.fps: 15\nDepthMapFactor: 1000\n");
  const OpenedSequence opened = read_sequence(scene());
  EXPECT_EQ(opened.camera.color, test::sample_camera());
  EXPECT_NEAR(1e-9 * static_cast<double>(opened.sequence.frames[1].stamp_ns), 1.0 / 15, 1e-6);
}

TEST_F(FoundCamera, OfAnotherSizeIsScaledIfTheAspectIsTheSame) {
  const auto file =
      folder_.write("large.json", R"({"w": 1280, "h": 960, "fx": 1051, "fy": 1053, "cx": 637, "cy": 482})");
  const PinholeCamera lens = camera(file.string()).color;
  EXPECT_EQ(lens.width, 640);
  EXPECT_EQ(lens.height, 480);
  EXPECT_EQ(lens.fx, 525.5);
  EXPECT_EQ(lens.cx, 318.25);  // pixels are counted from their centres
  const auto wide =
      folder_.write("wide.json", R"({"w": 1280, "h": 720, "fx": 900, "fy": 900, "cx": 640, "cy": 360})");
  EXPECT_THAT(error(wide.string()),
              AllOf(HasSubstr("wide.json: a camera of 1280 x 720"), HasSubstr("640 x 480")));
}

TEST_F(FoundCamera, SizeInTheOrderOfNumPyIsThatOfTheImages) {
  folder_.write("scene/camera_intrinsic.json",
                R"({"K": [[525.5, 0, 318.25], [0, 526.5, 240.75], [0, 0, 1]], "resolution": [480, 640]})");
  EXPECT_EQ(camera().color.width, 640);
  EXPECT_EQ(camera().color.cx, 318.25);
  folder_.write("scene/camera_intrinsic.json",  // of a camera held upright
                R"({"K": [[525.5, 0, 240.75], [0, 526.5, 318.25], [0, 0, 1]], "resolution": [480, 640]})");
  EXPECT_THAT(error(), HasSubstr("a camera of 480 x 640, but the images have 640 x 480"));
}

TEST_F(FoundCamera, MayBeAnArrayOfNumPy) {
  const cv::Mat matrix = (cv::Mat_<double>(3, 3) << 525.5, 0, 318.25, 0, 526.5, 240.75, 0, 0, 1);
  folder_.write("scene/camera-intrinsics.npy", test::numpy(matrix));
  EXPECT_EQ(camera().color.fx, 525.5);
  EXPECT_EQ(camera().color.cy, 240.75);
  folder_.write("scene/camera-intrinsics.npy", test::numpy(matrix).substr(0, 150));
  EXPECT_THAT(error(), HasSubstr("no camera: "));
  EXPECT_THAT(error((scene() / "camera-intrinsics.npy").string()),
              AllOf(HasSubstr("camera-intrinsics.npy: "), HasSubstr("truncated")));
  folder_.write("scene/large.npy", test::numpy(cv::Mat::zeros(100, 9, CV_64FC1)));
  EXPECT_THAT(error((scene() / "large.npy").string()), HasSubstr("an array of 100 x 9"));
}

TEST_F(FoundCamera, PicturesOfDepthAreNamedBeforeTheirUnitIsGuessed) {
  write_images(cv::Mat(kVga, CV_8UC3, cv::Scalar(90, 80, 70)));
  folder_.write("scene/K.txt", kMatrix);
  EXPECT_THAT(error(), HasSubstr("0.png: not a 16-bit grey PNG"));
}

TEST_F(FoundCamera, WithoutASizeMustBePlausibleForTheImages) {
  for (const char* text : {"1051 1053 637 482", "52 52 320 240", "525 525 20 240", "99000 99000 320 240"}) {
    SCOPED_TRACE(text);
    const auto file = folder_.write("K.txt", text);
    EXPECT_THAT(error(file.string()),
                AllOf(HasSubstr("K.txt: fx "), HasSubstr("not of images of 640 x 480")));
  }
}

TEST_F(FoundCamera, UnitOfDepthIsThatOfTheFileElseGuessedElseGiven) {
  folder_.write("scene/K.txt", kMatrix);
  EXPECT_EQ(camera().depth_scale, 1000);
  EXPECT_EQ(camera({}, 2000).depth_scale, 2000);
  write_images(slanted_depth(4000, 5));  // 0.8 m, in multiples of 5
  EXPECT_EQ(camera().depth_scale, 5000);
  write_images(slanted_depth(4000, 1));
  EXPECT_EQ(camera().depth_scale, 1000);
  write_images(slanted_depth(9001, 1));  // 9 m is not likely
  EXPECT_EQ(camera().depth_scale, 5000);
  write_images(slanted_depth(40000, 1));
  EXPECT_EQ(camera().depth_scale, 10000);
  write_images(cv::Mat(kVga, CV_16UC1, cv::Scalar(0)));
  EXPECT_THAT(error(), AllOf(HasSubstr("K.txt: states no unit of depth"), HasSubstr("--depth-scale")));
}

TEST_F(FoundCamera, TheCommonDivisorOfDepthTellsItsUnit) {
  folder_.write("scene/K.txt", kMatrix);
  for (const int divisor : {2, 4, 5, 8, 10}) {
    SCOPED_TRACE(divisor);
    write_images(slanted_depth(1500 * divisor, divisor));
    EXPECT_EQ(camera().depth_scale, 1000 * divisor);
  }
  cv::Mat interpolated = slanted_depth(15000, 10);
  for (int y = 0; y < interpolated.rows; y += 120) interpolated.row(y).setTo(cv::Scalar(15003));
  write_images(interpolated);
  EXPECT_EQ(camera().depth_scale, 10000);
}

TEST_F(FoundCamera, AGuessedUnitIsCalledAGuessWithTheAlternative) {
  folder_.write("scene/K.txt", kMatrix);
  const auto said = [&](const cv::Mat& depth) {
    write_images(depth);
    testing::internal::CaptureStdout();
    static_cast<void>(camera());
    return testing::internal::GetCapturedStdout();
  };
  EXPECT_THAT(said(slanted_depth(3001, 1)),
              AllOf(HasSubstr("in mm, a guess: by the median of 3.1 m; in 1/5000 m it would be 0.6 m"),
                    HasSubstr("--depth-scale")));
  EXPECT_THAT(said(slanted_depth(15000, 10)), HasSubstr("all values are multiples of 10"));
}

TEST_F(FoundCamera, APartOfACameraFileThatIsNotUnderstoodIsAnError) {
  folder_.write("scene/cam_left.json",
                R"({"fx": 525, "fy": 525, "cx": 318, "cy": 240, "lens_distortion": [0.1, 0.2]})");
  EXPECT_THAT(error(),
              AllOf(HasSubstr("cam_left.json:1: key 'lens_distortion'"), HasSubstr("not understood")));
}

TEST_F(FoundCamera, SmallerDepthOfTheSameAspectHasTheSameView) {
  write_images(slanted_depth(1500, 1, {320, 240}));
  folder_.write("scene/K.txt", kMatrix);
  const RgbdCamera found = camera();
  ASSERT_TRUE(found.depth);
  EXPECT_EQ(found.depth->width, 320);
  EXPECT_EQ(found.depth->fx, 525.5 / 2);
  EXPECT_TRUE(open_sequence(scene().string())->next());
}

TEST_F(FoundCamera, IntrinsicsMayBeGiven) {
  const RgbdCamera given = camera(parse_intrinsics("525.5,526.5,318.25,240.75"), 2500);
  EXPECT_EQ(given.color, test::sample_camera());
  EXPECT_EQ(given.depth_scale, 2500);
  EXPECT_THAT(error(parse_intrinsics("5,5,3,3")), HasSubstr("--intrinsics 5,5,3,3: fx 5"));
  EXPECT_THAT(input_error([] { static_cast<void>(given_camera(parse_intrinsics("5,5,3,3"))); }),
              HasSubstr("states no image size"));
}

TEST_F(FoundCamera, WithoutOneTheErrorHasATemplateThatFitsTheImages) {
  const auto template_of = [&] {
    try {
      static_cast<void>(camera());
    } catch (const InputErrorWithHint& error) {
      return error.hint().substr(error.hint().find("  width:"));
    }
    return std::string();
  };
  folder_.write("scene/camera.yaml", template_of());
  EXPECT_EQ(camera().color.fx, 525);
  EXPECT_EQ(camera().depth_scale, 1000);
  std::filesystem::remove(scene() / "camera.yaml");
  write_images(slanted_depth(4000, 5, {1280, 720}), {1280, 720});
  EXPECT_THAT(template_of(), HasSubstr("# a guess: that of a RealSense D435"));
  folder_.write("scene/camera.yaml", template_of());
  EXPECT_EQ(camera().color.width, 1280);
  EXPECT_EQ(camera().depth_scale, 5000);
}

/// Frame i of scene/, as a line of a list.
std::string list_of(const char* folder, const char* comment) {
  std::string list = fmt::format("# colour\n# file: '{}'\n# timestamp filename\n", comment);
  for (int i = 0; i < 3; ++i) list += fmt::format("{}.5 {}/{}.png\n", i, folder, i);
  return list;
}

TEST_F(FoundCamera, IsThatOfTheRecordingThatTheListsOfTheBenchmarkName) {
  folder_.write("scene/rgb.txt", list_of("rgb", "rgbd_dataset_freiburg2_desk.bag"));
  folder_.write("scene/depth.txt", list_of("depth", "rgbd_dataset_freiburg2_desk.bag"));
  EXPECT_EQ(camera().color, camera_preset("freiburg2")->color);
  EXPECT_EQ(camera().depth_scale, camera_preset("freiburg2")->depth_scale);
  folder_.write("scene/K.txt", kMatrix);  // beside the images: it wins
  EXPECT_EQ(camera().color.fx, 525.5);
}

TEST_F(FoundCamera, IsUnknownIfTheListsNameNoRecordingOfTheBenchmark) {
  folder_.write("scene/rgb.txt", list_of("rgb", "my desk in freiburg2"));
  folder_.write("scene/depth.txt", list_of("depth", "my desk"));
  EXPECT_THAT(error(), HasSubstr("no camera: "));
}

TEST_F(FoundCamera, InATumFolderToo) {
  test::SequenceFolder sequence(3);
  std::filesystem::remove(sequence.path() / "camera.yaml");
  sequence.folder.write("cam_K.txt", "25 0 15.5\n0 25 11.5\n0 0 1\n");
  const auto source = open_sequence(sequence.path().string());
  EXPECT_EQ(source->camera().color.fx, 25);
  EXPECT_EQ(source->camera().depth_scale, 1000);
  EXPECT_TRUE(source->next());
}

TEST(GivenIntrinsics, AreFourNumbersAndPerhapsDistortion) {
  EXPECT_EQ(parse_intrinsics("525.5,526.5,318.25,240.75").camera.color.cy, 240.75);
  EXPECT_EQ(parse_intrinsics("525,525,319,239,0.25,-0.5,0.001,-0.002,0").camera.color.lens,
            test::sample_distortion());
  for (const char* text : {"", "525", "525,525,319", "525,525,319,x", "525,525,319,239,", "nan,525,319,239",
                           "525,525,319,239,1", "-525,525,319,239", "525 525 319 239"})
    EXPECT_THAT(test::usage_error([&] { static_cast<void>(parse_intrinsics(text)); }),
                HasSubstr("--intrinsics"));
}

}  // namespace
}  // namespace kinloop
