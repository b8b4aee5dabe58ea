#include "kinloop/io/map_file/feature_serialization.hpp"

#include <cmath>

#include "kinloop/io/map_file/byte_stream.hpp"

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

/// Optional lists may be empty.
bool consistent(const Features& features) {
  bool same = features.level_count > 0 && features.scale_factor > 1 && std::isfinite(features.depth_lag_s);
  for_each_list(features,
                [&](const auto& list) { same = same && (list.empty() || list.size() == features.size()); });
  return same &&
         (features.descriptors.empty() || static_cast<size_t>(features.descriptors.rows) == features.size());
}

cv::Mat descriptors_from(ValueReader& reader) {
  const auto type = reader.value<int32_t>();
  const auto rows = reader.value<int32_t>(), cols = reader.value<int32_t>();
  const auto values = reader.list<uint8_t>();
  const bool known = type == CV_8UC1 || type == CV_32FC1;
  if (!known || rows < 0 || cols < 0) return {};
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
  put_values(bytes, &features.depth_lag_s, 1);
  return bytes;
}

std::optional<Features> deserialize_features(const std::string& bytes) {
  ValueReader reader(bytes);
  Features features;
  features.scale_factor = reader.value<double>();
  features.level_count = reader.value<int>();
  for_each_list(features, [&]<class T>(std::vector<T>& list) { list = reader.list<T>(); });
  features.descriptors = descriptors_from(reader);
  if (!reader.exhausted()) features.depth_lag_s = reader.value<float>();  // not in files of version 1
  if (!reader.exhausted() || !consistent(features)) return std::nullopt;
  return features;
}

}  // namespace kinloop
