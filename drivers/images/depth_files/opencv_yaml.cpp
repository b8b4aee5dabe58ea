#include <algorithm>
#include <charconv>
#include <cstdint>

#include <fmt/format.h>

#include "drivers/images/depth_files/depth_file.hpp"
#include "drivers/images/depth_files/depth_formats.hpp"
#include "kinloop/core/files/byte_reader.hpp"

namespace kinloop {
namespace {

using namespace std::string_view_literals;

constexpr auto kYamlMatrix = "!!opencv-matrix"sv;

/// The text after the key, from the first character that is no blank.
std::string_view after_key(std::string_view text, std::string_view key) {
  const size_t at = text.find(key);
  if (at == std::string_view::npos)
    throw InputError(fmt::format("the YAML file has no matrix: no '{}'", key));
  text.remove_prefix(at + key.size());
  text.remove_prefix(std::min(text.find_first_not_of(" \t\r\n"), text.size()));
  return text;
}

uint64_t yaml_count(std::string_view text, std::string_view key) {
  const std::string_view value = after_key(text, key);
  uint64_t count = 0;
  std::from_chars(value.data(), value.data() + value.size(), count);
  return count;
}

/// The header of the matrix and its numbers.
struct YamlMatrix {
  std::string_view head, data;
};

YamlMatrix yaml_matrix(std::string_view bytes) {
  constexpr size_t kLongestHead = 1000;
  bytes.remove_prefix(std::min(bytes.find(kYamlMatrix), bytes.size()));
  const std::string_view data = after_key(bytes.substr(0, bytes.size()), "data:");
  const auto head = bytes.substr(0, bytes.size() - data.size());
  if (head.size() > kLongestHead) throw InputError("the YAML file has no matrix");
  return {head, data};
}

/// OpenCV writes infinity as .Inf and what is no number as .Nan; both mean unknown.
bool skip_word(std::string_view& text) {
  const size_t sign = text.starts_with('-') ? 1 : 0;
  for (const std::string_view word : {".Inf"sv, ".Nan"sv, ".inf"sv, ".nan"sv}) {
    if (!text.substr(sign).starts_with(word)) continue;
    text.remove_prefix(sign + word.size());
    return true;
  }
  return false;
}

float next_yaml_number(std::string_view& text) {
  text.remove_prefix(std::min(text.find_first_not_of(" \t\r\n,["), text.size()));
  if (skip_word(text)) return 0;
  float value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error == std::errc::invalid_argument)
    throw InputError("the matrix is truncated, or has something that is no number; copy it again");
  text.remove_prefix(static_cast<size_t>(end - text.data()));
  return value;
}

}  // namespace

bool is_opencv_yaml(std::string_view bytes) {
  constexpr size_t kBeginning = 1000;
  return bytes.starts_with("%YAML"sv) &&
         bytes.substr(0, kBeginning).find(kYamlMatrix) != std::string_view::npos;
}

cv::Size opencv_yaml_size(std::string_view bytes) {
  const std::string_view head = yaml_matrix(bytes).head;
  return checked_depth_size(yaml_count(head, "cols:"), yaml_count(head, "rows:"));
}

cv::Mat decode_opencv_yaml(std::string_view bytes) {
  auto [head, data] = yaml_matrix(bytes);
  const cv::Size size = opencv_yaml_size(bytes);
  std::string_view type = after_key(head, "dt:");
  type.remove_prefix(type.starts_with('"') ? 1 : 0);
  const char letter = type.empty() ? ' ' : type[0];
  constexpr size_t kLeastPerPixel = 2;  // a digit and a comma
  if ("wsifd"sv.find(letter) == std::string_view::npos)
    throw InputError(fmt::format("a matrix of type '{}'; write depth with 16 bits or as floats",
                                 printable(type.substr(0, 2))));
  if (data.size() / kLeastPerPixel < static_cast<size_t>(size.area()))
    throw InputError("the matrix is truncated; copy it again");
  cv::Mat image(size, CV_32FC1);
  for (auto* pixel = image.ptr<float>(); pixel != image.ptr<float>() + size.area(); ++pixel)
    *pixel = next_yaml_number(data);
  if (letter == 'w') image.convertTo(image, CV_16U);
  return image;
}

}  // namespace kinloop
