#pragma once
// In: the bytes of an EXIF block, which is a TIFF file. Out: its numbers, in its own byte order.

#include <bit>
#include <cstdint>
#include <cstring>
#include <string_view>

#include "kinloop/core/errors.hpp"
#include "kinloop/core/files/byte_reader.hpp"

namespace kinloop {

/// Returns whether the bytes begin like a TIFF file of either byte order.
inline bool is_tiff(std::string_view bytes) {
  return bytes.starts_with(std::string_view("II*\0", 4)) || bytes.starts_with(std::string_view("MM\0*", 4));
}

/// Returns whether the bytes begin like a BigTIFF file, which has 64-bit offsets.
inline bool is_big_tiff(std::string_view bytes) {
  return bytes.starts_with(std::string_view("II+\0", 4)) || bytes.starts_with(std::string_view("MM\0+", 4));
}

inline bool is_any_tiff(std::string_view bytes) {
  return is_tiff(bytes) || is_big_tiff(bytes);
}

/// Throws InputError beyond the end.
class TiffBytes {
 public:
  explicit TiffBytes(std::string_view bytes)
      : bytes_(bytes), is_swapped_(bytes.starts_with("MM") == (std::endian::native == std::endian::little)) {}

  [[nodiscard]] std::string_view block(uint64_t at, uint64_t size) const {
    if (at > bytes_.size() || size > bytes_.size() - at) throw InputError("an EXIF block is truncated");
    return bytes_.substr(static_cast<size_t>(at), static_cast<size_t>(size));
  }

  template <class Number>
  [[nodiscard]] Number number(uint64_t at) const {
    Number value;
    std::memcpy(&value, block(at, sizeof(Number)).data(), sizeof(Number));
    return is_swapped_ ? byte_swapped(value) : value;
  }

 private:
  std::string_view bytes_;
  bool is_swapped_;
};

}  // namespace kinloop
