#include "drivers/images/depth_files/depth_file.hpp"

#include <algorithm>
#include <array>
#include <cstring>

#include <fmt/format.h>

#include "drivers/image_files/tiff_bytes.hpp"
#include "drivers/images/depth_files/depth_formats.hpp"
#include "kinloop/core/errors.hpp"
#include "kinloop/sensor/images/image_limits.hpp"

namespace kinloop {
namespace {

struct DepthFileFormat {
  bool (*is)(std::string_view bytes);
  cv::Size (*size)(std::string_view bytes);
  cv::Mat (*decode)(std::string_view bytes);
};

constexpr std::array kDepthFileFormats = {
    DepthFileFormat{is_exr, exr_size, decode_exr},
    DepthFileFormat{is_any_tiff, tiff_size, decode_tiff},
    DepthFileFormat{is_numpy, numpy_size, decode_numpy},
    DepthFileFormat{is_numpy_archive, numpy_archive_size, decode_numpy_archive},
    DepthFileFormat{is_opencv_yaml, opencv_yaml_size, decode_opencv_yaml},
};

const DepthFileFormat* depth_file_format(std::string_view bytes) {
  const auto* found = std::find_if(kDepthFileFormats.begin(), kDepthFileFormats.end(),
                                   [&](const DepthFileFormat& format) { return format.is(bytes); });
  return found == kDepthFileFormats.end() ? nullptr : found;
}

}  // namespace

bool is_depth_file(std::string_view bytes) {
  return depth_file_format(bytes) != nullptr;
}

std::optional<cv::Size> depth_file_size(std::string_view bytes) {
  const auto* format = depth_file_format(bytes);
  return format == nullptr ? std::nullopt : std::optional(format->size(bytes));
}

cv::Mat decode_depth_file(std::string_view bytes) {
  const auto* format = depth_file_format(bytes);
  if (format == nullptr) throw InputError("not a depth image in a known format");
  return format->decode(bytes);
}

cv::Mat floats_of_halves(std::string_view data, cv::Size size) {
  cv::Mat halves(size, CV_16FC1), floats;
  std::memcpy(halves.data, data.data(), halves.total() * halves.elemSize());
  halves.convertTo(floats, CV_32F);
  return floats;
}

cv::Size checked_depth_size(uint64_t width, uint64_t height) {
  constexpr uint64_t kMax_px = 30'000;
  const bool possible =
      width > 0 && height > 0 && width <= kMax_px && height <= kMax_px && width * height <= kMaxDecodedPixels;
  if (!possible) throw InputError(fmt::format("an image of {} x {} pixels", width, height));
  return {static_cast<int>(width), static_cast<int>(height)};
}

}  // namespace kinloop
