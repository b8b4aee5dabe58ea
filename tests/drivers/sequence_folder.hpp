#pragma once
// Small sequences in TUM layout, in a temporary folder.

#include <cstdint>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>

#include "tests/support/temp_folder.hpp"

namespace kinloop::test {

constexpr int kWidth = 32, kHeight = 24;
constexpr const char* kSmallCamera =
    "{width: 32, height: 24, fx: 25, fy: 25, cx: 15.5, cy: 11.5, distortion: [0, 0, 0, 0, 0], "
    "depth_scale: 1000, fps: 30}\n";

/// A colour image determined by `seed`.
inline cv::Mat make_color(int seed, int type = CV_8UC3, cv::Size size = {kWidth, kHeight}) {
  cv::Mat image(size, type);
  cv::RNG rng(static_cast<uint64_t>(seed) + 1);
  rng.fill(image, cv::RNG::UNIFORM, 0, 256);
  return image;
}

inline cv::Mat make_depth(uint16_t value, cv::Size size = {kWidth, kHeight}) {
  return {size, CV_16UC1, cv::Scalar(value)};
}

inline std::string encoded(const cv::Mat& image, const std::string& extension) {
  std::vector<uint8_t> bytes;
  cv::imencode(extension, image, bytes);
  return {bytes.begin(), bytes.end()};
}

/// A sequence of `frames` frames at 30 Hz from second 100: rgb/<i>.png, depth/<i>.png (value 1000 + i, a
/// metre and i millimetres), rgb.txt, depth.txt (5 ms later) and camera.yaml.
class SequenceFolder {
 public:
  explicit SequenceFolder(int frames) {
    std::string rgb = "# colour\n", depth = "# depth\n";
    for (int i = 0; i < frames; ++i) {
      folder.write(color_name(i), encoded(make_color(i), ".png"));
      folder.write(depth_name(i), encoded(make_depth(static_cast<uint16_t>(1000 + i)), ".png"));
      rgb += fmt::format("{} {}\n", stamp(i), color_name(i));
      depth += fmt::format("{} {}\n", stamp(i, 0.005), depth_name(i));
    }
    folder.write("rgb.txt", rgb);
    folder.write("depth.txt", depth);
    folder.write("camera.yaml", kSmallCamera);
  }

  static std::string color_name(int i) { return fmt::format("rgb/{}.png", i); }
  static std::string depth_name(int i) { return fmt::format("depth/{}.png", i); }
  static std::string stamp(int i, double later_s = 0) {
    return fmt::format("{:.6f}", 100 + i / 30.0 + later_s);
  }

  [[nodiscard]] const std::filesystem::path& path() const { return folder.path(); }

  TempFolder folder;
};

}  // namespace kinloop::test
