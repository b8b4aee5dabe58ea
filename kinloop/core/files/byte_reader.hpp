#pragma once
// In: the bytes of a file or message. Out: its numbers, strings and blocks.

#include <bit>
#include <concepts>
#include <cstdint>
#include <cstring>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>

#include <fmt/format.h>

#include "kinloop/core/errors.hpp"

namespace kinloop {

using Bytes = std::span<const uint8_t>;

inline std::string_view as_text(Bytes bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}
inline Bytes as_bytes(std::string_view text) {
  return {reinterpret_cast<const uint8_t*>(text.data()), text.size()};
}

/// Returns the text of a file for names and messages: control characters become '?'.
inline std::string printable(std::string_view text) {
  std::string result(text);
  for (char& c : result) {
    if (static_cast<uint8_t>(c) < 0x20 || c == 0x7F) c = '?';
  }
  return result;
}

/// Returns the number in the opposite byte order.
template <class Number>
Number byte_swapped(Number number) {
  uint8_t bytes[sizeof(Number)];
  std::memcpy(bytes, &number, sizeof(Number));
  for (size_t i = 0; i < sizeof(Number) / 2; ++i) std::swap(bytes[i], bytes[sizeof(Number) - 1 - i]);
  std::memcpy(&number, bytes, sizeof(Number));
  return number;
}

/// Returns the big-endian number at `position`; all of its bytes must be there.
template <class Number>
requires std::is_unsigned_v<Number> Number big_endian_at(std::string_view bytes, size_t position) {
  Number value;
  std::memcpy(&value, bytes.data() + position, sizeof(Number));
  return std::endian::native == std::endian::big ? value : byte_swapped(value);
}

/// Reads little-endian data from the front. Every function throws InputError at the end of the data.
class ByteReader {
 public:
  explicit ByteReader(Bytes bytes) : bytes_(bytes) {}

  [[nodiscard]] size_t left() const { return bytes_.size(); }

  template <class Number>
  requires std::is_arithmetic_v<Number> Number number() {
    Number value;
    std::memcpy(&value, block(sizeof(Number)).data(), sizeof(Number));
    return std::endian::native == std::endian::little ? value : byte_swapped(value);
  }

  Bytes block(uint64_t size) {
    if (size > bytes_.size())
      throw InputError(fmt::format("truncated: {} bytes are needed, {} are left", size, bytes_.size()));
    const Bytes result = bytes_.first(static_cast<size_t>(size));
    bytes_ = bytes_.subspan(static_cast<size_t>(size));
    return result;
  }

  /// A printable string after its 32-bit length.
  std::string string() { return printable(as_text(block(number<uint32_t>()))); }

 private:
  Bytes bytes_;
};

}  // namespace kinloop
