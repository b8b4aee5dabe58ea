#ifdef KINLOOP_WITH_VIDEO

#include "drivers/azure/azure_source.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "drivers/azure/azure_calibration.hpp"
#include "kinloop/base/byte_reader.hpp"
#include "kinloop/sensor/registration.hpp"
#include "tests/drivers/mutation.hpp"
#include "tests/drivers/sequence_folder.hpp"
#include "tests/support/expect_error.hpp"

namespace kinloop {
namespace {

using test::input_error;
using testing::AllOf;
using testing::HasSubstr;

const cv::Size kColorSize(160, 90), kDepthSize(320, 288);

/// Numbers of a real Azure Kinect.
constexpr const char* kCalibration = R"({"CalibrationInformation": {"Cameras": [
 {"Intrinsics": {"ModelParameters": [0.5122697, 0.4945123, 0.4921168, 0.4921667, 3.1305770, 2.3249390, 0.1304156,
   3.4586515, 3.3501145, 0.6629416, 0, 0, -5.11557e-05, 8.13217e-05],
   "ModelType": "CALIBRATION_LensDistortionModelBrownConrady"}, "Location": "CALIBRATION_CameraLocationD0",
   "Rt": {"Rotation": [1, 0, 0, 0, 1, 0, 0, 0, 1], "Translation": [0, 0, 0]}},
 {"Intrinsics": {"ModelParameters": [0.4986625, 0.5020676, 0.4781888, 0.6373624, 0.5843808, -2.4942491, 1.3602830,
   0.4647552, -2.3362464, 1.3011596, 0, 0, -0.0001765, 0.0006530],
   "ModelType": "CALIBRATION_LensDistortionModelBrownConrady"}, "Location": "CALIBRATION_CameraLocationPV0",
   "Rt": {"Rotation": [0.99999535083770752, -0.001910345396026969, -0.0023798577021807432, 0.0021437217947095633,
   0.994754433631897, 0.10226964205503464, 0.0021720037329941988, -0.10227426886558533, 0.994753897190094],
   "Translation": [-0.032022722, -0.0020792526, 0.0039346060]}}]}})";

std::string big_endian(uint64_t value, size_t size) {
  std::string bytes;
  for (size_t i = 0; i < size; ++i) bytes += static_cast<char>(value >> (8 * (size - 1 - i)));
  return bytes;
}

/// An element of EBML: its identifier, its size in 8 bytes, its content.
std::string element(uint32_t id, const std::string& content) {
  const size_t id_size = id > 0xFFFFFF ? 4 : id > 0xFFFF ? 3 : id > 0xFF ? 2 : 1;
  return big_endian(id, id_size) + big_endian(uint64_t{1} << 56U | content.size(), 8) + content;
}

/// CodecPrivate of V_MS/VFW/FOURCC: a BITMAPINFOHEADER.
std::string bitmap_header(cv::Size size, const std::string& fourcc) {
  std::string header;
  const auto add = [&](auto number) {
    header.append(reinterpret_cast<const char*>(&number), sizeof(number));
  };
  add(uint32_t{40}), add(size.width), add(size.height), add(uint16_t{1}), add(uint16_t{16});
  header += fourcc;
  for (int i = 0; i < 5; ++i) add(uint32_t{0});
  return header;
}

std::string track(unsigned number, const std::string& name, cv::Size size, const std::string& fourcc) {
  const std::string video = element(0xB0, big_endian(static_cast<unsigned>(size.width), 2)) +
                            element(0xBA, big_endian(static_cast<unsigned>(size.height), 2));
  return element(0xAE, element(0xD7, big_endian(number, 1)) + element(0x73C5, big_endian(number, 1)) +
                           element(0x83, big_endian(1, 1)) + element(0x536E, name) +
                           element(0x86, "V_MS/VFW/FOURCC") + element(0x63A2, bitmap_header(size, fourcc)) +
                           element(0xE0, video));
}

/// A block of one image, `stamp_us` after the beginning of its cluster.
std::string block(unsigned track_number, int stamp_us, const std::string& data) {
  return element(0xA3, big_endian(0x80U | track_number, 1) + big_endian(static_cast<uint64_t>(stamp_us), 2) +
                           big_endian(0x80, 1) + data);
}

std::string depth_data(uint16_t millimetres) {
  std::string data;
  for (int i = 0; i < kDepthSize.area(); ++i) data += big_endian(millimetres, 2);
  return data;
}

struct MkvParts {
  std::string calibration = kCalibration;
  std::string depth_name = "DEPTH";
  std::string depth_fourcc = "b16g";
  int frames = 3;
};

std::string color_data(int i) {
  cv::Mat small = test::make_color(i, CV_8UC3, {16, 9}), color;
  cv::resize(small, color, kColorSize, 0, 0, cv::INTER_LINEAR);
  return test::encoded(color, ".jpg");
}

std::string mkv_bytes(const MkvParts& parts) {
  const std::string header =
      element(0x1A45DFA3, element(0x4286, big_endian(1, 1)) + element(0x42F7, big_endian(1, 1)) +
                              element(0x42F2, big_endian(4, 1)) + element(0x42F3, big_endian(8, 1)) +
                              element(0x4282, "matroska") + element(0x4287, big_endian(4, 1)) +
                              element(0x4285, big_endian(2, 1)));
  std::string segment = element(0x1549A966, element(0x2AD7B1, big_endian(1000, 4)));  // microseconds
  segment += element(0x1654AE6B, track(1, "COLOR", kColorSize, "MJPG") +
                                     track(2, parts.depth_name, kDepthSize, parts.depth_fourcc));
  if (!parts.calibration.empty()) {
    segment += element(
        0x1941A469,
        element(0x61A7, element(0x466E, "calibration.json") + element(0x4660, "application/octet-stream") +
                            element(0x465C, parts.calibration + '\0') + element(0x46AE, big_endian(7, 1))));
  }
  for (int i = 0; i < parts.frames; ++i) {
    segment += element(0x1F43B675, element(0xE7, big_endian(static_cast<uint64_t>(33'333 * (i + 1)), 4)) +
                                       block(1, 0, color_data(i)) + block(2, 100, depth_data(1500)));
  }
  return header + element(0x18538067, segment);
}

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
    EXPECT_EQ(frame->color.size(), kColorSize);
    EXPECT_GT(cv::countNonZero(frame->depth_m), 5000);
    EXPECT_NEAR(frame->depth_m.at<float>(45, 80), 1.5, 0.02);
  }
  EXPECT_FALSE(source->next());
}

TEST_F(AzureRecordingTest, AGivenCameraTakesImagesAsTheyAre) {
  RgbdCamera camera;
  camera.color.width = kColorSize.width, camera.color.height = kColorSize.height;
  camera.color.fx = camera.color.fy = 80, camera.color.cx = 79.5, camera.color.cy = 44.5;
  camera.depth = camera.color;
  camera.depth->width = kDepthSize.width, camera.depth->height = kDepthSize.height;
  MkvParts without;
  without.calibration.clear();
  const auto frame = open(mkv_bytes(without), camera)->next();
  ASSERT_TRUE(frame);
  const auto jpeg = color_data(0);
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
                read_azure_calibration(kCalibration, {1280, 720}, {641, 576});
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
  const size_t structure = bytes.size() - depth_data(0).size();  // the pixels of depth cannot be wrong
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
