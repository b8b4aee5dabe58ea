#include <algorithm>
#include <charconv>
#include <cmath>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <yaml-cpp/yaml.h>

#include "drivers/datasets/camera_files/camera_formats.hpp"
#include "drivers/datasets/reading/json_file.hpp"
#include "drivers/images/depth_files/depth_formats.hpp"
#include "kinloop/core/errors.hpp"
#include "kinloop/core/files/byte_reader.hpp"
#include "kinloop/core/files/text_file.hpp"
#include "kinloop/core/text/json.hpp"
#include "kinloop/core/text/lower_case.hpp"

namespace kinloop {
namespace {

using nlohmann::json;

std::optional<double> parse_scalar(std::string_view text) {
  if (text.starts_with('+')) text.remove_prefix(1);
  double value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  const bool all = error == std::errc() && end == text.data() + text.size();
  return all ? std::optional(value) : std::nullopt;
}

/// Copies a YAML tree. An alias is copied wherever it is used, so that a small file can describe a huge tree:
/// beyond `budget` values it is refused.
json json_of(const YAML::Node& node, size_t& budget) {
  if (budget == 0) throw YAML::Exception(node.Mark(), "too many values");
  --budget;
  if (node.IsScalar()) {
    const auto number = parse_scalar(node.Scalar());
    return number ? json(*number) : json(node.Scalar());
  }
  if (node.IsSequence()) {
    json list = json::array();
    for (const YAML::Node& value : node) list.push_back(json_of(value, budget));
    return list;
  }
  if (!node.IsMap()) return {};
  json object = json::object();
  for (const auto& entry : node) {
    if (entry.first.IsScalar()) object.emplace(entry.first.Scalar(), json_of(entry.second, budget));
  }
  return object;
}

/// OpenCV begins its files with "%YAML:1.0", which is no directive of YAML.
json parse_camera_yaml(std::string text, const std::filesystem::path& file) {
  constexpr size_t kMaxValues = 100'000;
  if (text.starts_with("%YAML:")) text[0] = '#';
  size_t budget = kMaxValues;
  try {
    return json_of(YAML::Load(text), budget);
  } catch (const YAML::Exception& error) {
    const size_t line = error.mark.is_null() ? 1 : static_cast<size_t>(error.mark.line) + 1;
    throw_parse_error(file, line, fmt::format("not YAML: {}; expected lines 'key: value'", error.msg));
  }
}

/// The matrix of a .npy file as lines of numbers.
std::string text_of_array(std::string_view bytes, const std::filesystem::path& file) {
  constexpr int kLargest = 4;
  try {
    const cv::Size size = numpy_size(bytes);
    if (size.width > kLargest || size.height > kLargest)
      throw InputError(fmt::format("an array of {} x {}, not a matrix of intrinsics; give a camera file",
                                   size.height, size.width));
    cv::Mat matrix;
    decode_numpy(bytes).convertTo(matrix, CV_64F);
    std::string text;
    for (int y = 0; y < matrix.rows; ++y)
      text += fmt::format("{}\n", fmt::join(matrix.ptr<double>(y), matrix.ptr<double>(y) + matrix.cols, " "));
    return text;
  } catch (const InputError& error) {
    throw InputError(fmt::format("{}: {}", file.string(), error.what()));
  }
}

std::string camera_text(const std::filesystem::path& file) {
  constexpr uintmax_t kMaxBytes = 16 << 20;  // transforms.json lists all frames
  std::error_code absent;
  const auto bytes = std::filesystem::file_size(file, absent);
  if (!absent && bytes > kMaxBytes)
    throw InputError(
        fmt::format("{}: {} bytes are too many for a camera; give its camera file", file.string(), bytes));
  if (lower_case(file.extension().string()) == ".npy") return text_of_array(read_file(file), file);
  std::string text = read_text(file);
  if (text.find('\0') != std::string::npos)
    throw InputError(fmt::format("{}: not a text file; give a camera file", file.string()));
  return text;
}

void append_numbers(const json& value, std::vector<double>& numbers, bool& all_numbers) {
  constexpr size_t kMost = 64;
  if (value.is_array() && numbers.size() < kMost) {
    for (const json& element : value) append_numbers(element, numbers, all_numbers);
  } else if (value.is_number() && numbers.size() < kMost && std::isfinite(value.get<double>())) {
    numbers.push_back(value.get<double>());
  } else {
    all_numbers = false;
  }
}

}  // namespace

CameraDocument CameraDocument::read(const std::filesystem::path& file) {
  constexpr size_t kMaxYamlBytes = 1 << 20;
  CameraDocument document;
  document.file_ = file;
  document.text_ = camera_text(file);
  const std::string& text = document.text_;
  const std::string ending = lower_case(file.extension().string());
  if (ending == ".json") {
    document.values_ = read_json(file);
  } else if (const size_t first = text.find_first_not_of(" \t\r\n"); first != std::string::npos) {
    if (text[first] == '<') document.values_ = parse_camera_xml(text).value_or(json());
    if (text[first] == '{') document.values_ = parse_json(text);
    if (!document.values_.is_object() && text[first] != '<' && text.size() <= kMaxYamlBytes) {
      const bool yaml = ending == ".yaml" || ending == ".yml" || text.starts_with("%YAML");
      try {
        document.values_ = parse_camera_yaml(text, file);
      } catch (const InputError&) {
        if (yaml) throw;
      }
    }
  }
  if (!document.values_.is_object()) document.values_ = nullptr;
  return document;
}

void CameraDocument::reject(std::string_view key, const std::string& what) const {
  const size_t at = std::min(text_.find(key), text_.size());
  const auto lines = std::count(text_.begin(), text_.begin() + static_cast<std::ptrdiff_t>(at), '\n');
  throw_parse_error(file_, at == text_.size() ? 1 : static_cast<size_t>(lines) + 1, what);
}

const json* CameraValues::find_one(std::string_view key) const {
  if (!object_->is_object()) return nullptr;
  if (const auto found = object_->find(std::string(key)); found != object_->end()) return &*found;
  const size_t dot = key.find('.');
  if (dot == std::string_view::npos) return nullptr;
  const auto outer = object_->find(std::string(key.substr(0, dot)));
  return outer == object_->end() ? nullptr : CameraValues(*document_, *outer).find_one(key.substr(dot + 1));
}

const json* CameraValues::find(std::initializer_list<std::string_view> keys) const {
  for (const std::string_view key : keys) {
    if (const json* found = find_one(key)) return found;
  }
  return nullptr;
}

bool CameraValues::has_list(std::initializer_list<std::string_view> keys) const {
  const json* value = find(keys);
  return value != nullptr && (value->is_array() || (value->is_object() && value->contains("data")));
}

std::optional<CameraValues> CameraValues::object_at(std::initializer_list<std::string_view> keys) const {
  for (const std::string_view key : keys) {
    const json* value = find_one(key);
    if (value != nullptr && value->is_object()) return CameraValues(*document_, *value, std::string(key));
  }
  return std::nullopt;
}

std::vector<CameraValues> CameraValues::with_objects_below() const {
  constexpr int kDepth = 2;
  std::vector<CameraValues> all = {*this};
  size_t begin = 0;
  for (int depth = 0; depth < kDepth; ++depth) {
    const size_t end = all.size();
    for (size_t i = begin; i < end; ++i) {
      const json& object = *all[i].object_;
      if (!object.is_object()) continue;
      for (const auto& [key, value] : object.items()) {
        if (value.is_object()) all.emplace_back(*document_, value, key);
      }
    }
    begin = end;
  }
  return all;
}

std::optional<double> CameraValues::number(std::initializer_list<std::string_view> keys) const {
  for (const std::string_view key : keys) {
    const json* value = find_one(key);
    if (value == nullptr) continue;
    document_->note_used(*value);
    std::optional<double> number;
    if (value->is_number()) number = value->get<double>();
    if (value->is_string()) number = parse_scalar(value->get_ref<const std::string&>());
    if (!number || !std::isfinite(*number))
      document_->reject(key, fmt::format("key '{}': not a finite number; correct it", key));
    return number;
  }
  return std::nullopt;
}

double CameraValues::required(std::initializer_list<std::string_view> keys) const {
  if (const auto found = number(keys)) return *found;
  document_->reject(*keys.begin(), fmt::format("key '{}' is missing; add it", *keys.begin()));
}

std::vector<double> CameraValues::numbers(std::initializer_list<std::string_view> keys) const {
  for (const std::string_view key : keys) {
    const json* value = find_one(key);
    if (value == nullptr) continue;
    document_->note_used(*value);
    if (value->is_object()) value = CameraValues(*document_, *value).find({"data"});
    std::vector<double> numbers;
    bool all_numbers = value != nullptr && value->is_array();
    if (all_numbers) append_numbers(*value, numbers, all_numbers);
    if (!all_numbers)
      document_->reject(key, fmt::format("key '{}': not a list of finite numbers; correct it", key));
    return numbers;
  }
  return {};
}

std::string CameraValues::word(std::initializer_list<std::string_view> keys) const {
  const json* value = find(keys);
  if (value != nullptr) document_->note_used(*value);
  return value != nullptr && value->is_string() ? lower_case(value->get<std::string>()) : std::string();
}

}  // namespace kinloop
