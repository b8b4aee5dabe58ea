#pragma once
// Numbers as point files hold them: binary of ten types in either byte order, or text.

#include <array>
#include <bit>
#include <cstdint>
#include <cstring>
#include <optional>
#include <string>
#include <string_view>

namespace kinloop {

enum class NumberType { kInt8, kUint8, kInt16, kUint16, kInt32, kUint32, kInt64, kUint64, kFloat, kDouble };

/// Bytes of a number.
constexpr size_t size_of(NumberType type) {
  constexpr std::array<size_t, 10> kSizes = {1, 1, 2, 2, 4, 4, 8, 8, 4, 8};
  return kSizes[static_cast<size_t>(type)];
}

constexpr bool is_floating(NumberType type) {
  return type == NumberType::kFloat || type == NumberType::kDouble;
}

/// The number that the `size_of(type)` bytes at `at` hold.
double number_at(const char* at, NumberType type, std::endian order = std::endian::little);

/// Takes the next word off the front of `text`; empty at its end.
std::string_view next_word(std::string_view& text);

/// The number that all of `word` spells, "nan" and "inf" included.
std::optional<double> parse_number(std::string_view word);

/// The same for a whole number without a sign.
std::optional<size_t> parse_count(std::string_view word);

/// `text`, in which words of a damaged file may be, as a message on a terminal: short and in plain ASCII.
std::string printable(std::string text);

}  // namespace kinloop
