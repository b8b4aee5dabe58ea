#pragma once
// Number types of point files: ten binary types in either byte order, and text.

#include <array>
#include <bit>
#include <cstdint>
#include <cstring>
#include <optional>
#include <string>
#include <string_view>

namespace kinloop {

enum class NumberType { kInt8, kUint8, kInt16, kUint16, kInt32, kUint32, kInt64, kUint64, kFloat, kDouble };

/// Size of a number, bytes.
constexpr size_t size_of(NumberType type) {
  constexpr std::array<size_t, 10> kSizes = {1, 1, 2, 2, 4, 4, 8, 8, 4, 8};
  return kSizes[static_cast<size_t>(type)];
}

constexpr bool is_floating(NumberType type) {
  return type == NumberType::kFloat || type == NumberType::kDouble;
}

/// Reads the number in the `size_of(type)` bytes at `at`.
double number_at(const char* at, NumberType type, std::endian order = std::endian::little);

/// Removes and returns the next word of `text`; empty at its end.
std::string_view next_word(std::string_view& text);

/// Parses all of `word` as a number, including "nan" and "inf".
std::optional<double> parse_number(std::string_view word);

/// Same for an unsigned integer.
std::optional<size_t> parse_count(std::string_view word);

/// Shortens `text`, which may come from a damaged file, and reduces it to plain ASCII for messages on a
/// terminal.
std::string ascii_excerpt(std::string text);

}  // namespace kinloop
