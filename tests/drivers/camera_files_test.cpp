// Camera files of other programs: the same camera in every format, and what is damaged.

#include <fmt/format.h>
#include <gmock/gmock.h>

#include "drivers/datasets/camera_files/camera_formats.hpp"
#include "kinloop/sensor/camera/camera_file.hpp"
#include "tests/drivers/camera_file_samples.hpp"
#include "tests/drivers/mutation.hpp"
#include "tests/support/expect_error.hpp"
#include "tests/support/temp_folder.hpp"

namespace kinloop {
namespace {

using test::CameraFileSample;
using test::input_error;
using test::TempFolder;
using testing::AllOf;
using testing::HasSubstr;

TEST(CameraFiles, TheSameCameraInEveryFormat) {
  for (const CameraFileSample& sample : test::camera_file_samples()) {
    SCOPED_TRACE(sample.file);
    const TempFolder folder;
    const CameraDescription read = read_camera_description(folder.write(sample.file, sample.text));
    EXPECT_EQ(read.format, sample.format);
    EXPECT_EQ(read.has_size(), sample.has_size);
    EXPECT_EQ(read.has_depth_scale, sample.depth_scale != 0);
    if (read.has_depth_scale) {
      EXPECT_EQ(read.camera.depth_scale, sample.depth_scale);
    }
    PinholeCamera expected = test::sample_camera();
    if (sample.distorted) expected.lens = test::sample_distortion();
    if (!sample.has_size) expected.width = expected.height = 0;
    EXPECT_EQ(read.camera.color, expected);
    EXPECT_FALSE(read.is_complete);
  }
}

TEST(CameraFiles, EveryFormatHasASample) {
  ASSERT_FALSE(camera_formats().empty());
  for (const CameraFormat& format : camera_formats()) {
    const auto& samples = test::camera_file_samples();
    const auto is_of_format = [&](const auto& sample) { return std::string(sample.format) == format.name; };
    EXPECT_TRUE(std::string(format.name) == "camera.yaml" ||
                std::any_of(samples.begin(), samples.end(), is_of_format))
        << format.name;
  }
}

TEST(CameraFiles, OwnCameraFileIsReadAsItIs) {
  const TempFolder folder;
  RgbdCamera camera;
  camera.color = test::sample_camera();
  camera.color.lens = test::sample_distortion();
  camera.depth_delay_s = 0.01;
  write_camera_file(folder.path() / "camera.yaml", camera);
  const CameraDescription read = read_camera_description(folder.path() / "camera.yaml");
  EXPECT_TRUE(read.is_complete);
  EXPECT_EQ(read.camera.color, camera.color);
  EXPECT_EQ(read.camera.depth_delay_s, 0.01);
}

TEST(CameraFiles, ByteOrderMarkAndDosLineEndsDoNotMatter) {
  const TempFolder folder;
  for (const char* text : {"\xEF\xBB\xBF"
                           "fx: 525.5\r\nfy: 526.5\r\ncx: 318.25\r\ncy: 240.75\r\n",
                           "\xEF\xBB\xBF"
                           "525.5 526.5\r\n318.25 240.75\r\n"})
    EXPECT_EQ(read_camera_description(folder.write("camera.txt", text)).camera.color.cy, 240.75);
}

TEST(CameraFiles, FisheyeAndRationalLensesHaveTheirModels) {
  const TempFolder folder;
  const auto lens = [&](const char* name, const char* text) {
    return read_camera_description(folder.write(name, text)).camera.color.lens;
  };
  const LensDistortion fisheye =
      lens("cameras.txt", "1 OPENCV_FISHEYE 640 480 300 300 320 240 0.1 0.2 0.3 0.4\n");
  EXPECT_EQ(fisheye, lens_with(LensModel::kKannalaBrandt, std::vector{0.1, 0.2, 0.3, 0.4}));
  EXPECT_EQ(lens("orb.yaml",
                 "Camera.type: \"KannalaBrandt8\"\nCamera1.fx: 300\nCamera1.fy: 300\nCamera1.cx: 320\n"
                 "Camera1.cy: 240\nCamera1.k1: 0.1\nCamera1.k2: 0.2\nCamera1.k3: 0.3\nCamera1.k4: 0.4\n"),
            fisheye);
  EXPECT_EQ(
      lens("chain.yaml",
           "cam0: {camera_model: pinhole, distortion_model: equidistant, distortion_coeffs: [0.1, 0.2, 0.3, "
           "0.4], intrinsics: [300, 300, 320, 240], resolution: [640, 480]}"),
      fisheye);
  EXPECT_EQ(lens("cv.yaml",
                 "K: [300, 0, 320, 0, 300, 240, 0, 0, 1]\nD: [1, 2, 0.1, 0.2, 3, 4, 5, 6, 0, 0, 0, 0]\n"),
            lens_with(LensModel::kRational, std::vector{1., 2., 0.1, 0.2, 3., 4., 5., 6.}));
}

TEST(CameraFiles, FisheyeOfCamodocalBasaltAndOpenCv) {
  const TempFolder folder;
  const auto lens = [&](const char* name, const char* text) {
    return read_camera_description(folder.write(name, text)).camera.color;
  };
  const LensDistortion fisheye = lens_with(LensModel::kKannalaBrandt, std::vector{0.1, 0.2, 0.3, 0.4});
  const PinholeCamera camodocal = lens(
      "cam.yaml",
      "%YAML:1.0\nmodel_type: KANNALA_BRANDT\nimage_width: 640\nimage_height: 480\nprojection_parameters:\n"
      "  k2: 0.1\n  k3: 0.2\n  k4: 0.3\n  k5: 0.4\n  mu: 300\n  mv: 301\n  u0: 320\n  v0: 240\n");
  EXPECT_EQ(camodocal.lens, fisheye);
  EXPECT_EQ(camodocal.fy, 301);
  EXPECT_EQ(lens("b.json",
                 R"({"value0": {"intrinsics": [{"camera_type": "kb4", "intrinsics": {"fx": 300, "fy": 300,
 "cx": 320, "cy": 240, "k1": 0.1, "k2": 0.2, "k3": 0.3, "k4": 0.4}}]}})")
                .lens,
            fisheye);
  EXPECT_EQ(
      lens("cv.yaml",
           "%YAML:1.0\nfisheye_model: 1\nK: [300, 0, 320, 0, 300, 240, 0, 0, 1]\nD: [0.1, 0.2, 0.3, 0.4]\n")
          .lens,
      fisheye);
}

TEST(CameraFiles, APartThatIsNotUnderstoodIsNamed) {
  struct Part {
    const char* key;
    const char* text;  ///< beside fx, fy, cx and cy
  };
  const std::vector<Part> parts = {
      {"lens_distortion", R"("lens_distortion": [0.1, 0.2])"},
      {"distortionModelCoeffs", R"("distortionModelCoeffs": {"a": 0.1})"},
      {"s1", R"("s1": 0.02)"},
      {"extrinsics", R"("extrinsics": {"R": [0.9, 0.1], "t": [0.02, 0, 0]})"},
      {"depth_to_color", R"("depth_to_color": [0.02, 0, 0])"},
      {"rotation", R"("rotation": [0.99, 0.01, 0])"},
      {"depth_unit", R"("depth_unit": "cm")"},
      {"DepthScaling", R"("DepthScaling": 4000)"},
      {"depthShift", R"("depthShift": 1090)"},
      {"resolution", R"("resolution": "640x480")"},
      {"binning_x", R"("binning_x": 2)"},
      {"roi", R"("roi": {"x_offset": 16, "y_offset": 0, "width": 640, "height": 480})"},
  };
  const TempFolder folder;
  for (const Part& part : parts) {
    SCOPED_TRACE(part.key);
    const auto file = folder.write(
        "a.json", fmt::format("{{\"fx\": 300, \"fy\": 300, \"cx\": 320, \"cy\": 240,\n{}}}", part.text));
    EXPECT_THAT(input_error([&] { static_cast<void>(read_camera_description(file)); }),
                AllOf(HasSubstr(fmt::format("a.json:2: key '{}'", part.key)), HasSubstr("not understood")));
  }
  for (const char* harmless :
       {R"("lens_distortion": [0, 0])", R"("extrinsics": {"R": [1, 0, 0, 1], "t": [0, 0]})",
        R"("T_imu_cam": [0.5, 0.1])", R"("rectification_matrix": [0.9, 0.1])", R"("board_width": 9)",
        R"("roi": {"x_offset": 0, "width": 0})", R"("binning_x": 1)", R"("max_distance": 3.5)"}) {
    SCOPED_TRACE(harmless);
    const auto file = folder.write(
        "b.json", fmt::format("{{\"fx\": 300, \"fy\": 300, \"cx\": 320, \"cy\": 240, {}}}", harmless));
    EXPECT_EQ(read_camera_description(file).camera.color.fx, 300);
  }
}

TEST(CameraFiles, WhatIsWrongIsNamedWithTheRemedy) {
  struct Bad {
    const char* file;
    std::string text;
    std::vector<const char*> said;
  };
  const std::vector<Bad> inputs = {
      {"K.txt", "525 0 319\n0 525 x\n0 0 1\n", {"K.txt:2: 'x'", "correct"}},
      {"K.txt", "525 0 319\n0 nan 239\n0 0 1\n", {"K.txt:2: 'nan'"}},
      {"K.txt", "525 0 319\n0 525\n", {"K.txt: no camera in a known format", "--intrinsics"}},
      {"K.txt", "-525 0 319\n0 525 239\n0 0 1\n", {"K.txt: fx -525", "correct it"}},
      {"K.txt", "", {"K.txt: no camera"}},
      {"K.txt",
       std::string("\xFF\xFE"
                   "5\0",
                   4),
       {"K.txt: text in UTF-16", "save it as UTF-8"}},
      {"K.txt", std::string("525\0", 4), {"K.txt: not a text file"}},
      {"a.json", "{\"fx\": 525", {"a.json: not JSON", "byte 11"}},
      {"a.json", "{\n\"fx\": \"wide\",\n\"cx\": 3}", {"a.json:2: key 'fx': not a finite number"}},
      {"a.json", R"({"fx": 525, "cx": 319})", {"a.json:1: key 'fy' is missing", "add it"}},
      {"a.json", R"({"K": [525, 0, 319]})", {"a.json:1: key 'K': not a matrix"}},
      {"a.json", R"({"K": [525, 0, "x", 0, 525, 3, 0, 0, 1]})", {"key 'K': not a list of finite numbers"}},
      {"a.json", R"({"fx": 5, "fy": 5, "cx": 3, "cy": 2, "w": 1e9, "h": 1e9})", {"a.json: images of"}},
      {"a.json",
       R"({"a": {"fx": 5, "fy": 5, "cx": 3, "cy": 2}, "b": {"fx": 6, "fy": 6, "cx": 3, "cy": 2}})",
       {"a.json:1: cameras that differ"}},
      {"a.json",
       R"({"fx": 5, "fy": 5, "cx": 3, "cy": 2, "D": [1, 2, 3, 4, 5, 6, 7, 8, 9, 1, 2, 3]})",
       {"a.json: the thin prism"}},
      {"a.json", R"({"fx": 5, "fy": 5, "cx": 3, "cy": 2, "D": [1e9]})", {"a.json: a distortion coefficient"}},
      {"transforms.json",
       R"({"frames": [{"fl_x": 5, "cx": 3, "cy": 2}, {"fl_x": 6, "cx": 3, "cy": 2}]})",
       {"the lens differs from frame to frame"}},
      {"a.yaml", "%YAML:1.0\nCamera.fx: 525\nCamera.fy: wide\n", {"a.yaml:3: key 'Camera.fy'"}},
      {"a.yaml", "Camera.fx: 525\nCamera.fy: 525\nCamera.cx: 3\n", {"a.yaml:1: key 'Camera.cy' is missing"}},
      {"a.yaml",
       "Camera.type: Omni\nCamera.fx: 5\nCamera.fy: 5\nCamera.cx: 3\nCamera.cy: 3\n",
       {"model 'omni'"}},
      {"a.yaml", "a: [\n", {"a.yaml:", "not YAML"}},
      {"a.yaml", "fx: .inf\nfy: 5\ncx: 3\ncy: 2\n", {"a.yaml:1: key 'fx'"}},
      {"a.yaml",
       "cam0: {camera_model: omni, intrinsics: [1, 2, 3, 4, 5]}\n",
       {"a.yaml:1: cam0", "pinhole-radtan"}},
      {"a.yaml", "focal: 525\n", {"a.yaml:1", "unknown key 'focal'"}},
      {"a.yaml",
       "%YAML:1.0\nmodel_type: MEI\nmirror_parameters: {xi: 1.9}\nprojection_parameters: {gamma1: 300}\n",
       {"a.yaml: model_type 'mei'", "undistort"}},
      {"a.json",
       R"({"value0": {"intrinsics": [{"camera_type": "ds", "intrinsics": {"fx": 3}}]}})",
       {"camera_type 'ds'"}},
      {"a.yaml",
       "K: [300, 0, 320, 0, 300, 240, 0, 0, 1]\nD: [0.1, 0.2, 0.3, 0.4]\ndistortion_model: double_sphere\n",
       {"double_sphere"}},
      {"SN1234.conf", "[LEFT_CAM_HD]\nfx=700\nfy=700\n", {"factory calibration of a ZED", "--intrinsics"}},
      {"cameras.txt", "1 PINHOLE 640 480 525 525 320\n", {"cameras.txt:1: 7 fields", "has 8"}},
      {"cameras.txt", "1 FOV 640 480 525 525 320 240 1\n", {"cameras.txt:1: the camera model FOV"}},
      {"cameras.txt",
       "1 PINHOLE 640 480 5 5 320 240\n2 PINHOLE 640 480 6 6 320 240\n",
       {"cameras.txt:2: another camera"}},
  };
  for (const Bad& bad : inputs) {
    SCOPED_TRACE(bad.text);
    const TempFolder folder;
    const auto file = folder.write(bad.file, bad.text);
    const std::string message = input_error([&] { static_cast<void>(read_camera_description(file)); });
    for (const char* piece : bad.said) EXPECT_THAT(message, HasSubstr(piece));
  }
}

TEST(CameraFiles, HugeAndNestedFilesAreErrorsNotCrashes) {
  constexpr size_t kBrackets = 100'000;
  std::string keys, aliases = "a0: &a0 [1, 1, 1, 1, 1, 1, 1, 1]\n";
  for (size_t i = 0; i < kBrackets; ++i) keys += "{\"a\":";
  for (int i = 1; i < 12; ++i)
    aliases +=
        fmt::format("a{0}: &a{0} [*a{1}, *a{1}, *a{1}, *a{1}, *a{1}, *a{1}, *a{1}, *a{1}]\n", i, i - 1);
  for (const char* name : {"a.json", "a.yaml", "K.txt"}) {
    for (const std::string& text : {std::string(kBrackets, '['), std::string(kBrackets, '{'), keys, aliases,
                                    std::string(2'000'000, '1'), std::string(300'000, ' ') + "1 2 3 4 5"}) {
      const TempFolder folder;
      const auto file = folder.write(name, text);
      EXPECT_THAT(input_error([&] { static_cast<void>(read_camera_description(file)); }), HasSubstr(name));
    }
  }
}

TEST(CameraFiles, MutatedFilesAreReadOrRefused) {
  Random random(5);
  const int count = test::mutations(40);
  int refused = 0;
  const TempFolder folder;
  for (const CameraFileSample& sample : test::camera_file_samples()) {
    for (int i = 0; i < count; ++i) {
      const auto file = folder.write(sample.file, test::mutated(sample.text, random));
      try {
        const CameraDescription read = read_camera_description(file);
        EXPECT_TRUE(read.camera.color.fx > 0 && std::isfinite(read.camera.color.cy));
      } catch (const InputError& error) {
        EXPECT_THAT(std::string(error.what()), testing::Not(HasSubstr("\n")));
        ++refused;
      }
    }
  }
  EXPECT_GT(refused, 0);
}

}  // namespace
}  // namespace kinloop
