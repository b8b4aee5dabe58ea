#include "kinloop/io/map_file/feature_serialization.hpp"

#include <algorithm>
#include <cmath>

#include "kinloop/core/files/byte_stream.hpp"

namespace kinloop {
namespace {

/// Visits every list with one entry per keypoint.
template <class Self, class Visit>
void for_each_list(Self& features, Visit&& visit) {
  visit(features.pixels);
  visit(features.depths_m);
  visit(features.raw_pixels);
  visit(features.measured_pixels);
  visit(features.measured_depths_m);
  visit(features.inverse_depth_gradients);
  visit(features.levels);
  visit(features.angles_rad);
  visit(features.sigmas_px);
}

/// Every list has an entry per keypoint, except for the one that may be empty. Descriptors have 256 bits
/// whatever their kind.
bool consistent(const Features& features) {
  constexpr int kMaxLevels = 64, kDescriptorBytes = 32;
  constexpr double kMaxScale = 10;
  bool same = features.size() > 0 && features.level_count > 0 && features.level_count <= kMaxLevels &&
              features.scale_factor > 1 && features.scale_factor <= kMaxScale;
  for_each_list(features, [&](const auto& list) {
    const bool optional = static_cast<const void*>(&list) == &features.inverse_depth_gradients;
    same = same && (list.size() == features.size() || (optional && list.empty()));
  });
  const cv::Mat& descriptors = features.descriptors;
  return same && static_cast<size_t>(descriptors.rows) == features.size() && descriptors.type() == CV_8UC1 &&
         descriptors.cols == kDescriptorBytes;
}

/// Every number is one that a camera can have measured.
bool possible(const Features& features) {
  constexpr float kMaxPixel = 1e6F, kMaxDepthM = 1e6F, kMaxLag_s = 1e3F;
  const auto all = [](const auto& list, const auto& is_possible) {
    return std::all_of(list.begin(), list.end(), is_possible);
  };
  const auto is_pixel = [](const Eigen::Vector2f& p) {
    return p.cwiseAbs().maxCoeff() <= kMaxPixel && p.allFinite();
  };
  const auto is_depth = [](float depth_m) { return depth_m >= 0 && depth_m <= kMaxDepthM; };
  return std::abs(features.depth_stamp_difference_s) <= kMaxLag_s && all(features.pixels, is_pixel) &&
         all(features.raw_pixels, is_pixel) && all(features.measured_pixels, is_pixel) &&
         all(features.depths_m, is_depth) && all(features.measured_depths_m, is_depth) &&
         all(features.levels, [&](int level) { return level >= 0 && level < features.level_count; }) &&
         all(features.angles_rad, [](float angle_rad) { return std::isfinite(angle_rad); }) &&
         all(features.sigmas_px, [](float sigma_px) { return sigma_px > 0 && sigma_px <= kMaxPixel; });
}

cv::Mat descriptors_from(ValueReader& reader) {
  const auto type = reader.value<int32_t>();
  const auto rows = reader.value<int32_t>(), cols = reader.value<int32_t>();
  const auto values = reader.list<uint8_t>();
  const bool known = type == CV_8UC1 || type == CV_32FC1;
  constexpr int32_t kMaxCols = 1024;
  if (!known || rows < 0 || cols < 0 || cols > kMaxCols) return {};
  const size_t bytes = static_cast<size_t>(rows) * static_cast<size_t>(cols) * (type == CV_8UC1 ? 1 : 4);
  if (values.size() != bytes) return {};
  cv::Mat descriptors(rows, cols, type);
  if (bytes > 0) std::memcpy(descriptors.data, values.data(), bytes);
  return descriptors;
}

}  // namespace

std::string serialize_features(const Features& features) {
  std::string bytes;
  put_values(bytes, &features.scale_factor, 1);
  put_values(bytes, &features.level_count, 1);
  for_each_list(features, [&](const auto& list) { put_list(bytes, list); });
  const cv::Mat descriptors =
      features.descriptors.isContinuous() ? features.descriptors : features.descriptors.clone();
  const int32_t shape[] = {descriptors.type(), descriptors.rows, descriptors.cols};
  put_values(bytes, shape, 3);
  const uint64_t count = descriptors.total() * descriptors.elemSize();
  put_values(bytes, &count, 1);
  put_values(bytes, descriptors.data, count);
  put_values(bytes, &features.depth_stamp_difference_s, 1);
  return bytes;
}

std::optional<Features> deserialize_features(const std::string& bytes) {
  ValueReader reader(bytes);
  Features features;
  features.scale_factor = reader.value<double>();
  features.level_count = reader.value<int>();
  for_each_list(features, [&]<class T>(std::vector<T>& list) { list = reader.list<T>(); });
  features.descriptors = descriptors_from(reader);
  if (!reader.exhausted())
    features.depth_stamp_difference_s = reader.value<float>();  // not in files of version 1
  if (!reader.exhausted() || !consistent(features) || !possible(features)) return std::nullopt;
  return features;
}

}  // namespace kinloop
