#include "kinloop/dense/image_store.hpp"

#include <cmath>
#include <limits>

#include <opencv2/imgcodecs.hpp>

#include "kinloop/base/errors.hpp"
#include "kinloop/dense/depth_codec.hpp"

namespace kinloop {
namespace {

std::vector<uint16_t> to_units(const cv::Mat& depth_m, double units_per_m) {
  std::vector<uint16_t> units;
  units.reserve(depth_m.total());
  const auto scale = static_cast<float>(units_per_m);
  constexpr auto kMaxCount = static_cast<float>(std::numeric_limits<uint16_t>::max());
  for (int row = 0; row < depth_m.rows; ++row) {
    const auto* depths = depth_m.ptr<float>(row);
    for (int col = 0; col < depth_m.cols; ++col) {
      const float value = depths[col] * scale + 0.5F;
      units.push_back(value >= 1 && value < kMaxCount ? static_cast<uint16_t>(value) : uint16_t{0});
    }
  }
  return units;
}

cv::Mat to_metres(const std::vector<uint16_t>& units, int rows, int cols, double units_per_m) {
  cv::Mat depth_m(rows, cols, CV_32FC1);
  auto* depths = depth_m.ptr<float>();
  for (size_t i = 0; i < units.size(); ++i) depths[i] = static_cast<float>(units[i] / units_per_m);
  return depth_m;
}

}  // namespace

EncodedImages encode_images(const RgbdImages& images, const ImageStoreOptions& options) {
  require(images.color.type() == CV_8UC3 && images.depth_m.type() == CV_32FC1 &&
              images.color.size() == images.depth_m.size(),
          "encode_images: expected colour 8UC3 and depth 32FC1 of the same size");
  EncodedImages encoded{images.color.rows, images.color.cols, {}, {}};
  encoded.depth = pack_depth(to_units(images.depth_m, options.depth_scale));
  cv::imencode(".jpg", images.color, encoded.color, {cv::IMWRITE_JPEG_QUALITY, options.jpeg_quality});
  return encoded;
}

RgbdImages decode_images(const EncodedImages& images, const ImageStoreOptions& options) {
  const auto depth =
      unpack_depth(images.depth, static_cast<size_t>(images.rows) * static_cast<size_t>(images.cols));
  return {cv::imdecode(images.color, cv::IMREAD_COLOR),
          to_metres(depth, images.rows, images.cols, options.depth_scale)};
}

size_t ImageStore::add(const EncodedImages& images) {
  std::vector<uint8_t> bytes;
  bytes.reserve(images.color.size() + images.depth.size());
  bytes.insert(bytes.end(), images.color.begin(), images.color.end());
  bytes.insert(bytes.end(), images.depth.begin(), images.depth.end());
  sizes_.push_back({images.rows, images.cols, images.color.size()});
  return bytes_.add(std::move(bytes));
}

EncodedImages ImageStore::encoded(size_t index) const {
  require(index < sizes_.size(), "ImageStore: no such image");
  const Size& size = sizes_[index];
  const std::vector<uint8_t> bytes = bytes_.load(index);
  const auto middle = bytes.begin() + static_cast<std::ptrdiff_t>(size.color_bytes);
  return {size.rows, size.cols, {bytes.begin(), middle}, {middle, bytes.end()}};
}

}  // namespace kinloop
