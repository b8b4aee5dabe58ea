#include "kinloop/sensor/images/encoded_images.hpp"

#include <limits>
#include <new>
#include <optional>
#include <string_view>
#include <utility>

#include "kinloop/core/errors.hpp"
#include "kinloop/sensor/images/depth_codec.hpp"
#include "kinloop/sensor/images/jpeg_codec.hpp"

namespace kinloop {
namespace {

// Both conversions have no branches, so that they are vectorised.

std::vector<uint16_t> to_units(const cv::Mat& depth_m, double units_per_m) {
  std::vector<uint16_t> units(depth_m.total());
  const auto scale = static_cast<float>(units_per_m);
  constexpr auto kMaxCount = static_cast<float>(std::numeric_limits<uint16_t>::max());
  const int cols = depth_m.cols;
  for (int row = 0; row < depth_m.rows; ++row) {
    const auto* depths = depth_m.ptr<float>(row);
    uint16_t* out = &units[static_cast<size_t>(row) * static_cast<size_t>(cols)];
    for (int col = 0; col < cols; ++col) {
      const float value = depths[col] * scale + 0.5F;
      const float known = ((value >= 1) & (value < kMaxCount)) ? value : 0.0F;
      out[col] = static_cast<uint16_t>(static_cast<int>(known));
    }
  }
  return units;
}

cv::Mat to_metres(const std::vector<uint16_t>& units, int rows, int cols, double units_per_m) {
  cv::Mat depth_m(rows, cols, CV_32FC1);
  auto* depths = depth_m.ptr<float>();
  const auto scale = static_cast<float>(units_per_m);
  for (size_t i = 0; i < units.size(); ++i) depths[i] = static_cast<float>(units[i]) / scale;
  return depth_m;
}

std::optional<std::vector<uint16_t>> try_unpack_depth(const std::vector<uint8_t>& bytes, size_t count) {
  try {
    return unpack_depth(bytes, count);
  } catch (const InputError&) {
    return std::nullopt;
  }
}

size_t pixels_of(const EncodedImages& images) {
  return static_cast<size_t>(images.rows) * static_cast<size_t>(images.cols);
}

cv::Mat decode_color(const std::vector<uint8_t>& jpeg) {
  return decode_jpeg({reinterpret_cast<const char*>(jpeg.data()), jpeg.size()});
}

std::vector<uint8_t> encode_color(const ColorImage& color, int jpeg_quality) {
  const std::string_view jpeg = color.jpeg();
  if (jpeg.empty()) return encode_jpeg(color.bgr(), jpeg_quality);
  return {jpeg.begin(), jpeg.end()};
}

}  // namespace

StoredImages encode_images(const ColorImage& color, const cv::Mat& depth_m, const ImageEncoding& encoding) {
  require(depth_m.type() == CV_32FC1 && color.size() == depth_m.size(),
          "encode_images: expected depth 32FC1 of the size of the colour image");
  const int rows = depth_m.rows, cols = depth_m.cols;
  const auto units = to_units(depth_m, encoding.depth_scale);
  EncodedImages encoded{rows, cols, encode_color(color, encoding.jpeg_quality), pack_depth(units)};
  RgbdImages decoded{decode_color(encoded.color), to_metres(units, rows, cols, encoding.depth_scale)};
  if (decoded.color.size() != depth_m.size()) throw std::bad_alloc();  // it has been decoded before
  return {std::move(encoded), std::move(decoded)};
}

RgbdImages decode_images(const EncodedImages& images, const ImageEncoding& encoding) {
  const auto depth = try_unpack_depth(images.depth, pixels_of(images));
  cv::Mat color = decode_color(images.color);
  if (depth && color.size() == cv::Size(images.cols, images.rows))
    return {std::move(color), to_metres(*depth, images.rows, images.cols, encoding.depth_scale)};
  return {cv::Mat(images.rows, images.cols, CV_8UC3, cv::Scalar::all(0)),
          cv::Mat(images.rows, images.cols, CV_32FC1, cv::Scalar(0))};
}

bool is_decodable(const EncodedImages& images) {
  const std::string_view color(reinterpret_cast<const char*>(images.color.data()), images.color.size());
  return jpeg_size(color) == cv::Size(images.cols, images.rows) &&
         try_unpack_depth(images.depth, pixels_of(images)).has_value();
}

}  // namespace kinloop
