#include "kinloop/sensor/camera/camera_file.hpp"

#include <array>
#include <string>

#include <fmt/format.h>
#include <gmock/gmock.h>

#include "kinloop/core/files/text_file.hpp"
#include "kinloop/sensor/camera/camera_presets.hpp"
#include "tests/support/expect_error.hpp"
#include "tests/support/temp_folder.hpp"

namespace kinloop {
namespace {

using test::input_error;
using test::TempFolder;
using testing::AllOf;
using testing::HasSubstr;

constexpr const char* kGood =
    "width: 640\n"
    "height: 480\n"
    "fx: 517.3\n"
    "fy: 516.5\n"
    "cx: 318.6\n"
    "cy: 255.3\n"
    "distortion: [0.2624, -0.9531, -0.0054, 0.0026, 1.1633]\n"
    "depth_scale: 5000\n"
    "fps: 30\n";

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  return text.replace(text.find(from), from.size(), to);
}

class CameraFile : public testing::Test {
 protected:
  RgbdCamera read(const std::string& text) { return read_camera_file(folder_.write("camera.yaml", text)); }
  std::string error(const std::string& text) {
    return input_error([&] { read(text); });
  }

  TempFolder folder_;
};

TEST_F(CameraFile, ADepthScaleInMetresAUnitIsTold) {
  EXPECT_THAT(
      error(replaced(kGood, "depth_scale: 5000", "depth_scale: 0.001")),
      AllOf(HasSubstr("camera.yaml:8"), HasSubstr("units per metre"), HasSubstr("depth_scale: 1000")));
  EXPECT_THAT(error(replaced(kGood, "depth_scale: 5000", "depth_scale: 0")), HasSubstr("from 1 to"));
}

TEST_F(CameraFile, ReadsWhatIsThere) {
  const RgbdCamera camera = read(kGood);
  EXPECT_EQ(camera.color.width, 640);
  EXPECT_EQ(camera.color.height, 480);
  EXPECT_EQ(camera.color.fx, 517.3);
  EXPECT_EQ(camera.color.fy, 516.5);
  EXPECT_EQ(camera.color.cx, 318.6);
  EXPECT_EQ(camera.color.cy, 255.3);
  EXPECT_EQ(camera.color.lens.k1, 0.2624);
  EXPECT_EQ(camera.color.lens.k2, -0.9531);
  EXPECT_EQ(camera.color.lens.p1, -0.0054);
  EXPECT_EQ(camera.color.lens.p2, 0.0026);
  EXPECT_EQ(camera.color.lens.k3, 1.1633);
  EXPECT_EQ(camera.depth_scale, 5000);
  EXPECT_EQ(camera.fps, 30);
  EXPECT_FALSE(camera.rolling_shutter_s);
  EXPECT_EQ(camera.depth_delay_s, 0);
  EXPECT_FALSE(camera.depth);
}

TEST_F(CameraFile, AGlobalShutterMayBeKnown) {
  const RgbdCamera camera = read(std::string(kGood) + "rolling_shutter_s: 0\nsensor: kinect1\n");
  EXPECT_EQ(camera.rolling_shutter_s, 0);
  EXPECT_EQ(nominal_readout_s(camera), 0);
  EXPECT_EQ(nominal_readout_s(read_camera_text(camera_file_text(camera), "again.yaml")), 0);
}

TEST_F(CameraFile, ReadsTheOptionalKeys) {
  const RgbdCamera camera = read(
      std::string(kGood) +
      "rolling_shutter_s: 0.03\n"
      "depth_offset_s: -0.015\n"
      "depth: {width: 512, height: 424, fx: 365, fy: 366, cx: 256, cy: 212, distortion: [1, 2, 3, 4, 5]}\n"
      "T_color_depth: {translation: [-0.05, 0.01, 0.02], rotation_vector: [0, 0, 1.5707963267948966]}\n");
  EXPECT_EQ(camera.rolling_shutter_s, 0.03);
  EXPECT_EQ(camera.depth_delay_s, -0.015);
  ASSERT_TRUE(camera.depth);
  EXPECT_EQ(camera.depth->width, 512);
  EXPECT_EQ(camera.depth->height, 424);
  EXPECT_EQ(camera.depth->fy, 366);
  EXPECT_EQ(camera.depth->lens.k3, 5);
  const Eigen::Vector3d p = camera.T_color_depth * Eigen::Vector3d(1, 0, 0);
  EXPECT_LT((p - Eigen::Vector3d(-0.05, 1.01, 0.02)).norm(), 1e-12);
}

TEST_F(CameraFile, DepthCameraWithoutSizeHasThatOfColour) {
  const RgbdCamera camera =
      read(std::string(kGood) + "depth: {fx: 365, fy: 366, cx: 256, cy: 212, distortion: [0, 0, 0, 0, 0]}\n" +
           "T_color_depth: {translation: [0, 0, 0], rotation_vector: [0, 0, 0]}\n");
  EXPECT_EQ(camera.depth->width, 640);
  EXPECT_EQ(camera.depth->height, 480);
}

TEST_F(CameraFile, WritingAndReadingGivesTheSameCamera) {
  RgbdCamera camera = *camera_preset("freiburg1");
  camera.color.fx = 517.30640812345678;
  camera.rolling_shutter_s = 0.0301;
  camera.depth_delay_s = -1.0 / 3;
  camera.depth = camera_preset("freiburg2")->color;
  camera.depth->width = 512;
  camera.T_color_depth = {exp_so3({0.1, -0.2, 0.3}), {0.025, -1e-17, 1e-3}};
  const auto path = folder_.path() / "written.yaml";
  write_camera_file(path, camera);
  const RgbdCamera again = read_camera_file(path);
  for (const auto& [a, b] : {std::pair(camera.color, again.color), std::pair(*camera.depth, *again.depth)}) {
    EXPECT_EQ(a.width, b.width);
    EXPECT_EQ(a.height, b.height);
    EXPECT_EQ(a.fx, b.fx);
    EXPECT_EQ(a.fy, b.fy);
    EXPECT_EQ(a.cx, b.cx);
    EXPECT_EQ(a.cy, b.cy);
    EXPECT_EQ(a.lens.k1, b.lens.k1);
    EXPECT_EQ(a.lens.k2, b.lens.k2);
    EXPECT_EQ(a.lens.p1, b.lens.p1);
    EXPECT_EQ(a.lens.p2, b.lens.p2);
    EXPECT_EQ(a.lens.k3, b.lens.k3);
  }
  EXPECT_EQ(camera.depth_scale, again.depth_scale);
  EXPECT_EQ(camera.fps, again.fps);
  EXPECT_EQ(camera.rolling_shutter_s, again.rolling_shutter_s);
  EXPECT_EQ(camera.depth_delay_s, again.depth_delay_s);
  EXPECT_EQ(camera.T_color_depth.translation, again.T_color_depth.translation);
  EXPECT_LT((camera.T_color_depth.inverse() * again.T_color_depth).log().norm(), 1e-15);
}

TEST_F(CameraFile, EverySensorIsReadAndWritten) {
  ASSERT_GE(option_names(DepthSensorModel{}).size(), 3U);
  for (const auto& [model, name] : option_names(DepthSensorModel{})) {
    const RgbdCamera camera = read(fmt::format("{}sensor: {}\n", kGood, name));
    EXPECT_EQ(camera.sensor.model, model);
    EXPECT_EQ(camera.sensor.origin, SensorOrigin::kCameraFile);
    const DepthSensor preset = depth_sensor(model, SensorOrigin::kCameraFile);
    EXPECT_EQ(camera.sensor.noise.sigma_m(2), preset.noise.sigma_m(2));
    const auto path = folder_.path() / "written.yaml";
    write_camera_file(path, camera);
    EXPECT_EQ(read_camera_file(path).sensor.model, model);
  }
}

TEST_F(CameraFile, AnAssumedSensorIsNotWritten) {
  const auto path = folder_.path() / "written.yaml";
  write_camera_file(path, read(kGood));
  EXPECT_EQ(read_camera_file(path).sensor.origin, SensorOrigin::kAssumed);
  RgbdCamera known = read(kGood);
  known.sensor.set_by_source(DepthSensorModel::kKinect2);
  write_camera_file(path, known);
  EXPECT_EQ(read_camera_file(path).sensor.model, DepthSensorModel::kKinect2);
}

TEST_F(CameraFile, AnUnknownSensorIsRejectedWithItsLineAndThoseThereAre) {
  for (const char* wrong : {"sonar", "Kinect1", "[kinect1]", "", "3"}) {
    EXPECT_THAT(error(fmt::format("{}sensor: {}\n", kGood, wrong)),
                AllOf(HasSubstr("camera.yaml:10: key 'sensor'"), HasSubstr("structured_light"),
                      HasSubstr("time_of_flight"), HasSubstr("hololens")))
        << wrong;
  }
}

TEST_F(CameraFile, EveryLensModelIsReadAndWritten) {
  using enum LensModel;
  for (const LensDistortion& lens :
       {LensDistortion{kBrownConrady}, LensDistortion{kBrownConrady, 1, 2, 3, 4, 5},
        LensDistortion{kRational, 3.1305770, 2, 3e-5, -4e-5, 1.0 / 3, 6, 7, 8},
        lens_with(kKannalaBrandt, std::array{-0.01, 0.04, -1.0 / 30, 0.007})}) {
    RgbdCamera camera = *camera_preset("freiburg3");
    camera.color.lens = lens;
    camera.depth = camera.color;
    const auto path = folder_.path() / "written.yaml";
    write_camera_file(path, camera);
    const RgbdCamera again = read_camera_file(path);
    EXPECT_EQ(again.color, camera.color) << read_file(path);
    EXPECT_EQ(again.depth, camera.depth) << read_file(path);
  }
}

TEST_F(CameraFile, TheNumberOfCoefficientsTellsTheModel) {
  const std::string five = "distortion: [0.2624, -0.9531, -0.0054, 0.0026, 1.1633]";
  const auto lens = [&](const std::string& lines) { return read(replaced(kGood, five, lines)).color.lens; };
  EXPECT_EQ(lens("distortion: [1, 2, 3, 4, 5, 6, 7, 8]"),
            (LensDistortion{LensModel::kRational, 1, 2, 3, 4, 5, 6, 7, 8}));
  EXPECT_EQ(lens("model: kannala_brandt\ndistortion: [1, 2, 3, 4]").k4, 4);
  EXPECT_TRUE(lens("model: none").is_identity());
  EXPECT_EQ(lens("model: brown_conrady\n" + five).k3, 1.1633);
}

TEST_F(CameraFile, ALensThatContradictsItselfIsRejectedWithItsLine) {
  const std::string five = "distortion: [0.2624, -0.9531, -0.0054, 0.0026, 1.1633]";
  const auto lens = [&](const std::string& lines) { return error(replaced(kGood, five, lines)); };
  EXPECT_THAT(lens("model: fisheye\n" + five), AllOf(HasSubstr("camera.yaml:7:"), HasSubstr("'model'"),
                                                     HasSubstr("'fisheye'"), HasSubstr("kannala_brandt")));
  EXPECT_THAT(
      lens("model: kannala_brandt\n" + five),
      AllOf(HasSubstr("camera.yaml:8:"), HasSubstr("'distortion'"), HasSubstr("a list of 4 numbers")));
  EXPECT_THAT(lens("model: rational\n" + five),
              AllOf(HasSubstr("camera.yaml:8:"), HasSubstr("a list of 8 numbers")));
  EXPECT_THAT(lens("model: none\n" + five), AllOf(HasSubstr("camera.yaml:8:"), HasSubstr("none")));
  EXPECT_THAT(lens("model: [1]\n" + five), AllOf(HasSubstr("camera.yaml:7:"), HasSubstr("'model'")));
  EXPECT_THAT(lens("distortion: [1, 2, 3, 4]"),
              AllOf(HasSubstr("camera.yaml:7:"), HasSubstr("a list of 5 or 8 numbers")));
  EXPECT_THAT(lens("distortion: [1, 2, 3, 4, 5, .nan, 7, 8]"), HasSubstr("camera.yaml:7:"));
  EXPECT_THAT(lens("model: kannala_brandt"), AllOf(HasSubstr("'distortion'"), HasSubstr("missing")));
}

TEST_F(CameraFile, UnknownKeyNamesFileLineAndTheKeysThereAre) {
  EXPECT_THAT(error(replaced(kGood, "fps", "frames_per_second")),
              AllOf(HasSubstr("camera.yaml:9:"), HasSubstr("'frames_per_second'"), HasSubstr("fps")));
}

TEST_F(CameraFile, EveryMissingKeyIsNamed) {
  for (const char* key : {"width", "height", "fx", "fy", "cx", "cy", "distortion", "depth_scale", "fps"}) {
    const std::string line_start = std::string("\n") + key + ":";
    std::string text = std::string("\n") + kGood;
    const size_t begin = text.find(line_start) + 1;
    text.erase(begin, text.find('\n', begin) - begin);
    EXPECT_THAT(error(text), AllOf(HasSubstr("camera.yaml"), HasSubstr(std::string("'") + key + "'"),
                                   HasSubstr("missing"), HasSubstr("add it")));
  }
}

TEST_F(CameraFile, ValuesNoCameraHasAreRejectedWithLineAndKey) {
  struct Case {
    const char *good, *bad, *line, *key;
  };
  for (const auto& [good, bad, line, key] : {
           Case{"width: 640", "width: 0", ":1:", "'width'"},
           Case{"width: 640", "width: 640.5", ":1:", "'width'"},
           Case{"height: 480", "height: -480", ":2:", "'height'"},
           Case{"height: 480", "height: 99999999999", ":2:", "'height'"},
           Case{"fx: 517.3", "fx: 0", ":3:", "'fx'"},
           Case{"fx: 517.3", "fx: many", ":3:", "'fx'"},
           Case{"fx: 517.3", "fx:", ":3:", "'fx'"},
           Case{"fy: 516.5", "fy: -480", ":4:", "'fy'"},
           Case{"fx: 517.3", "fx: 1e300", ":3:", "'fx'"},
           Case{"fx: 517.3", "fx: 1e-6", ":3:", "'1e-6' is not a number from 112 to 11200"},
           Case{"cx: 318.6", "cx: -4000", ":5:", "'cx'"},
           Case{"cx: 318.6", "cx: .nan", ":5:", "'cx'"},
           Case{"cy: 255.3", "cy: .inf", ":6:", "'cy'"},
           Case{"cy: 255.3", "cy: [255]", ":6:", "'cy'"},
           Case{"1.1633]", "]", ":7:", "'distortion'"},
           Case{"1.1633]", "1, 2]", ":7:", "'distortion'"},
           Case{"1.1633]", "x]", ":7:", "'distortion'"},
           Case{"1.1633]", "1e9]", ":7:", "'distortion'"},
           Case{"depth_scale: 5000", "depth_scale: 0", ":8:", "'depth_scale'"},
           Case{"fps: 30", "fps: -1", ":9:", "'fps'"},
           Case{"fps: 30", "fps: 30\nrolling_shutter_s: -0.1", ":10:", "'rolling_shutter_s'"},
           Case{"fps: 30", "fps: 30\nrolling_shutter_s: 1e10", ":10:", "from 0 to 1, in seconds"},
           Case{"fps: 30", "fps: 30\ndepth_offset_s: -5", ":10:", "'depth_offset_s'"},
           Case{"fps: 30", "fps: 30\ndepth_shift_m: 1000", ":10:", "'depth_shift_m'"},
           Case{"fps: 30", "fps: 30\ndepth_offset_s: late", ":10:", "'depth_offset_s'"},
           Case{"fps: 30", "fps: 30\nfx: 500", ":10:", "'fx' is given twice"},
       }) {
    EXPECT_THAT(error(replaced(kGood, good, bad)),
                AllOf(HasSubstr(std::string("camera.yaml") + line), HasSubstr(key)));
  }
}

TEST_F(CameraFile, DepthBlockIsCheckedAsWell) {
  const std::string motion = "T_color_depth: {translation: [0, 0, 0], rotation_vector: [0, 0, 0]}\n";
  const std::string depth = "depth: {fx: 365, fy: 366, cx: 256, cy: 212, distortion: [0, 0, 0, 0, 0]}\n";
  EXPECT_THAT(error(kGood + depth), AllOf(HasSubstr("'T_color_depth'"), HasSubstr("missing")));
  EXPECT_THAT(error(kGood + motion), AllOf(HasSubstr(":10:"), HasSubstr("'depth'")));
  EXPECT_THAT(error(kGood + replaced(depth, "fy: 366, ", "") + motion), HasSubstr("'depth.fy'"));
  EXPECT_THAT(error(kGood + replaced(depth, "fy", "gy") + motion), HasSubstr("'depth.gy'"));
  EXPECT_THAT(error(kGood + replaced(depth, "365", "-365") + motion), HasSubstr("'depth.fx'"));
  EXPECT_THAT(error(kGood + depth + replaced(motion, "[0, 0, 0]", "[0, 0]")),
              HasSubstr("'T_color_depth.translation'"));
  EXPECT_THAT(error(kGood + std::string("depth: 5\n") + motion), HasSubstr("expected keys"));
}

TEST_F(CameraFile, WhatIsNotYamlAtAllIsRejected) {
  EXPECT_THAT(error("width: 640\nheight: [480\n"), AllOf(HasSubstr("camera.yaml:"), HasSubstr("not YAML")));
  EXPECT_THAT(error(""), HasSubstr("expected keys"));
  EXPECT_THAT(error("just words\n"), HasSubstr("expected keys"));
  EXPECT_THAT(error(std::string("\x89PNG\r\n\x1a\n\0\0", 10)), HasSubstr("camera.yaml"));
  EXPECT_THAT(input_error([&] { read_camera_file(folder_.path() / "none.yaml"); }), HasSubstr("none.yaml"));
}

}  // namespace
}  // namespace kinloop
