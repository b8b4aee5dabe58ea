#ifdef KINLOOP_WITH_VIDEO

#include "drivers/azure/azure_source.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "drivers/azure/azure_recording.hpp"
#include "kinloop/core/files/byte_reader.hpp"
#include "kinloop/sensor/camera/registration.hpp"
#include "tests/drivers/mkv_writer.hpp"
#include "tests/drivers/mutation.hpp"
#include "tests/drivers/sequence_folder.hpp"
#include "tests/support/expect_error.hpp"

namespace kinloop {
namespace {

using test::input_error;
using testing::AllOf;
using testing::HasSubstr;

using test::color_data;
using test::depth_data;
using test::kAzureCalibration;
using test::kAzureColorSize;
using test::kAzureDepthSize;
using test::mkv_bytes;
using test::MkvParts;

class AzureRecordingTest : public testing::Test {
 protected:
  std::unique_ptr<FrameSource> open(const std::string& bytes,
                                    const std::optional<RgbdCamera>& camera = {}) const {
    return open_azure_recording(folder.write("a.mkv", bytes), camera);
  }
  const test::TempFolder folder;
};

TEST_F(AzureRecordingTest, TheCameraIsThatOfTheFactoryAndDepthIsRegistered) {
  const auto source = open(mkv_bytes({}));
  const RgbdCamera& camera = source->camera();
  ASSERT_TRUE(camera.depth);
  EXPECT_NEAR(camera.color.fx, 0.4781888 * 160, 1e-9);
  EXPECT_NEAR(camera.color.cy, 0.5020676 * 120 - 15 - 0.5, 1e-9);  // 16:9 is cropped out of 4:3
  EXPECT_NEAR(camera.depth->cx, 0.5122697 * 512 - 96 - 0.5, 1e-9);
  EXPECT_NEAR(camera.T_color_depth.translation.x(), -0.032022722, 1e-9);
  EXPECT_EQ(lens_coefficients(camera.color.lens),
            (std::vector<double>{0.5843808, -2.4942491, 0.0006530, -0.0001765, 1.3602830, 0.4647552,
                                 -2.3362464, 1.3011596}));
  EXPECT_EQ(camera.depth->lens.k6, 0.6629416);
  EXPECT_EQ(camera.sensor.model, DepthSensorModel::kAzureKinect);
  for (int i = 0; i < 3; ++i) {
    const auto frame = source->next();
    ASSERT_TRUE(frame);
    EXPECT_EQ(frame->stamp_ns, 33'333'000LL * (i + 1));
    EXPECT_EQ(frame->color.size(), kAzureColorSize);
    EXPECT_GT(cv::countNonZero(frame->depth_m), 5000);
    EXPECT_NEAR(frame->depth_m.at<float>(45, 80), 1.5, 0.02);
  }
  EXPECT_FALSE(source->next());
}

TEST_F(AzureRecordingTest, AGivenCameraTakesImagesAsTheyAre) {
  RgbdCamera camera;
  camera.color.width = kAzureColorSize.width, camera.color.height = kAzureColorSize.height;
  camera.color.fx = camera.color.fy = 80, camera.color.cx = 79.5, camera.color.cy = 44.5;
  camera.depth = camera.color;
  camera.depth->width = kAzureDepthSize.width, camera.depth->height = kAzureDepthSize.height;
  MkvParts without;
  without.calibration.clear();
  const auto frame = open(mkv_bytes(without), camera)->next();
  ASSERT_TRUE(frame);
  const auto jpeg = color_data(0, kAzureColorSize);
  EXPECT_EQ(
      cv::norm(frame->color.bgr(),
               cv::imdecode(std::vector<uint8_t>(jpeg.begin(), jpeg.end()), cv::IMREAD_COLOR), cv::NORM_INF),
      0);
}

TEST_F(AzureRecordingTest, NamesWhatIsMissing) {
  MkvParts parts;
  parts.calibration.clear();
  EXPECT_THAT(input_error([&] { open(mkv_bytes(parts)); }),
              AllOf(HasSubstr("calibration.json"), HasSubstr("--camera")));
  for (const char* wrong : {"{", "{}", R"({"CalibrationInformation": {"Cameras": [{"Location": 3}]}})"}) {
    parts.calibration = wrong;
    EXPECT_THAT(input_error([&] { open(mkv_bytes(parts)); }),
                AllOf(HasSubstr("a.mkv"), HasSubstr("calibration.json")));
  }
  parts = {};
  parts.depth_name = "IR";
  EXPECT_THAT(input_error([&] { open(mkv_bytes(parts)); }), HasSubstr("no track DEPTH"));
  parts = {};
  parts.depth_fourcc = "abcd";
  EXPECT_THAT(input_error([&] { open(mkv_bytes(parts))->next(); }), HasSubstr("abcd"));
  EXPECT_THAT(input_error([&] { open("text"); }), HasSubstr("a.mkv"));
  EXPECT_THAT(input_error([&] { open_azure_recording("absent.mkv", {}); }), HasSubstr("no such file"));
  EXPECT_THAT(input_error([&] {
                read_azure_calibration(kAzureCalibration, {1280, 720}, {641, 576});
              }),
              HasSubstr("641 x 576"));
}

TEST_F(AzureRecordingTest, ATruncatedFileGivesItsFirstFrames) {
  const std::string whole = mkv_bytes({});
  size_t before = 0;
  for (size_t size = 0; size < whole.size(); size += 3001) {
    size_t frames = 0;
    try {
      const auto source = open(whole.substr(0, size));
      while (source->next()) ++frames;
    } catch (const InputError& error) {
      EXPECT_THAT(error.what(), HasSubstr("a.mkv"));
    }
    EXPECT_GE(frames, before);
    before = frames;
    std::filesystem::remove(folder.path() / "a.mkv");
  }
  EXPECT_GE(before, 2U);
}

TEST_F(AzureRecordingTest, NoMutatedFileBreaksTheReader) {
  MkvParts parts;
  parts.frames = 1;
  const std::string bytes = mkv_bytes(parts);
  const size_t structure =
      bytes.size() - depth_data(0, kAzureDepthSize).size();  // the pixels of depth cannot be wrong
  Random random(22);
  for (int i = test::mutations(500); i > 0; --i) {
    const auto path =
        folder.write("m.mkv", test::mutated(bytes.substr(0, structure), random) + bytes.substr(structure));
    try {
      const auto source = open_azure_recording(path, {});
      while (source->next()) {
      }
    } catch (const InputError& error) {
      EXPECT_THAT(std::string(error.what()), testing::Not(HasSubstr("\n")));
    }
    std::filesystem::remove(path);
  }
}

}  // namespace
}  // namespace kinloop

#endif
