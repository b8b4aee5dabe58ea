#include <algorithm>
#include <charconv>
#include <string>

#include "viewer/point_files/point_formats.hpp"

namespace kinloop {
namespace {

constexpr std::string_view kWhite = " \t\r\n\v\f";

template <class T>
double value_of(std::array<char, sizeof(double)> bytes) {
  T value{};
  std::memcpy(&value, bytes.data(), sizeof value);
  return static_cast<double>(value);
}

template <class T>
std::optional<T> parse_all(std::string_view word) {
  if (word.starts_with('+')) word.remove_prefix(1);
  T value{};
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (error != std::errc() || end != word.data() + word.size()) return std::nullopt;
  return value;
}

}  // namespace

double number_at(const char* at, NumberType type, std::endian order) {
  std::array<char, sizeof(double)> bytes{};
  const size_t size = size_of(type);
  if (order == std::endian::native) {
    std::memcpy(bytes.data(), at, size);
  } else {
    std::reverse_copy(at, at + size, bytes.begin());
  }
  switch (type) {
    case NumberType::kInt8:
      return value_of<int8_t>(bytes);
    case NumberType::kUint8:
      return value_of<uint8_t>(bytes);
    case NumberType::kInt16:
      return value_of<int16_t>(bytes);
    case NumberType::kUint16:
      return value_of<uint16_t>(bytes);
    case NumberType::kInt32:
      return value_of<int32_t>(bytes);
    case NumberType::kUint32:
      return value_of<uint32_t>(bytes);
    case NumberType::kInt64:
      return value_of<int64_t>(bytes);
    case NumberType::kUint64:
      return value_of<uint64_t>(bytes);
    case NumberType::kFloat:
      return value_of<float>(bytes);
    case NumberType::kDouble:
      return value_of<double>(bytes);
  }
  return 0;
}

std::string_view next_word(std::string_view& text) {
  text.remove_prefix(std::min(text.size(), text.find_first_not_of(kWhite)));
  const std::string_view word = text.substr(0, text.find_first_of(kWhite));
  text.remove_prefix(word.size());
  return word;
}

std::optional<double> parse_number(std::string_view word) {
  return parse_all<double>(word);
}

std::optional<size_t> parse_count(std::string_view word) {
  return parse_all<size_t>(word);
}

std::string ascii_excerpt(std::string text) {
  constexpr size_t kLongest = 200;
  constexpr char kFirst = ' ', kLast = '~';
  if (text.size() > kLongest) text = text.substr(0, kLongest) + "...";
  std::replace_if(
      text.begin(), text.end(), [](char c) { return c < kFirst || c > kLast; }, '?');
  return text;
}

}  // namespace kinloop
