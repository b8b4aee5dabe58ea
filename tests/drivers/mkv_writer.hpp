#pragma once
// Writes recordings of an Azure Kinect (.mkv), element by element.

#include <cstdint>
#include <string>

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "tests/drivers/sequence_folder.hpp"

namespace kinloop::test {

inline const cv::Size kAzureColorSize(160, 90), kAzureDepthSize(320, 288);

/// Numbers of a real Azure Kinect.
constexpr const char* kAzureCalibration = R"({"CalibrationInformation": {"Cameras": [
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

inline std::string big_endian(uint64_t value, size_t size) {
  std::string bytes;
  for (size_t i = 0; i < size; ++i) bytes += static_cast<char>(value >> (8 * (size - 1 - i)));
  return bytes;
}

/// An element of EBML: its identifier, its size in 8 bytes, its content.
inline std::string element(uint32_t id, const std::string& content) {
  const size_t id_size = id > 0xFFFFFF ? 4 : id > 0xFFFF ? 3 : id > 0xFF ? 2 : 1;
  return big_endian(id, id_size) + big_endian(uint64_t{1} << 56U | content.size(), 8) + content;
}

/// CodecPrivate of V_MS/VFW/FOURCC: a BITMAPINFOHEADER.
inline std::string bitmap_header(cv::Size size, const std::string& fourcc) {
  std::string header;
  const auto add = [&](auto number) {
    header.append(reinterpret_cast<const char*>(&number), sizeof(number));
  };
  add(uint32_t{40}), add(size.width), add(size.height), add(uint16_t{1}), add(uint16_t{16});
  header += fourcc;
  for (int i = 0; i < 5; ++i) add(uint32_t{0});
  return header;
}

inline std::string track(unsigned number, const std::string& name, cv::Size size, const std::string& fourcc) {
  const std::string video = element(0xB0, big_endian(static_cast<unsigned>(size.width), 2)) +
                            element(0xBA, big_endian(static_cast<unsigned>(size.height), 2));
  return element(0xAE, element(0xD7, big_endian(number, 1)) + element(0x73C5, big_endian(number, 1)) +
                           element(0x83, big_endian(1, 1)) + element(0x536E, name) +
                           element(0x86, "V_MS/VFW/FOURCC") + element(0x63A2, bitmap_header(size, fourcc)) +
                           element(0xE0, video));
}

/// A block of one image, `stamp_us` after the beginning of its cluster.
inline std::string block(unsigned track_number, int stamp_us, const std::string& data) {
  return element(0xA3, big_endian(0x80U | track_number, 1) + big_endian(static_cast<uint64_t>(stamp_us), 2) +
                           big_endian(0x80, 1) + data);
}

inline std::string depth_data(uint16_t millimetres, cv::Size size) {
  std::string data;
  for (int i = 0; i < size.area(); ++i) data += big_endian(millimetres, 2);
  return data;
}

inline std::string depth_png(uint16_t millimetres, cv::Size size) {
  return encoded(make_depth(millimetres, size), ".png");
}

struct MkvParts {
  std::string calibration = kAzureCalibration;
  std::string depth_name = "DEPTH";
  std::string depth_fourcc = "b16g";  ///< or MPNG
  int frames = 3;
  cv::Size color_size = kAzureColorSize, depth_size = kAzureDepthSize;
};

inline std::string color_data(int i, cv::Size size) {
  cv::Mat small = make_color(i, CV_8UC3, {16, 9}), color;
  cv::resize(small, color, size, 0, 0, cv::INTER_LINEAR);
  return encoded(color, ".jpg");
}

inline std::string mkv_bytes(const MkvParts& parts) {
  const std::string header =
      element(0x1A45DFA3, element(0x4286, big_endian(1, 1)) + element(0x42F7, big_endian(1, 1)) +
                              element(0x42F2, big_endian(4, 1)) + element(0x42F3, big_endian(8, 1)) +
                              element(0x4282, "matroska") + element(0x4287, big_endian(4, 1)) +
                              element(0x4285, big_endian(2, 1)));
  std::string segment = element(0x1549A966, element(0x2AD7B1, big_endian(1000, 4)));  // microseconds
  segment += element(0x1654AE6B, track(1, "COLOR", parts.color_size, "MJPG") +
                                     track(2, parts.depth_name, parts.depth_size, parts.depth_fourcc));
  if (!parts.calibration.empty()) {
    segment += element(
        0x1941A469,
        element(0x61A7, element(0x466E, "calibration.json") + element(0x4660, "application/octet-stream") +
                            element(0x465C, parts.calibration + '\0') + element(0x46AE, big_endian(7, 1))));
  }
  for (int i = 0; i < parts.frames; ++i) {
    const std::string depth =
        parts.depth_fourcc == "MPNG" ? depth_png(1500, parts.depth_size) : depth_data(1500, parts.depth_size);
    segment += element(0x1F43B675, element(0xE7, big_endian(static_cast<uint64_t>(33'333 * (i + 1)), 4)) +
                                       block(1, 0, color_data(i, parts.color_size)) + block(2, 100, depth));
  }
  return header + element(0x18538067, segment);
}

}  // namespace kinloop::test
