#include "drivers/images/depth_files/tiff_compression.hpp"

#include <algorithm>
#include <cstdint>
#include <vector>

#include "kinloop/core/errors.hpp"

namespace kinloop {
namespace {

/// Reads codes of up to 12 bits.
class LzwCodes {
 public:
  explicit LzwCodes(std::string_view bytes) : bytes_(bytes) {}

  /// The code that ends the data if they are truncated.
  uint32_t next(unsigned width, uint32_t at_end) {
    while (bits_ < width) {
      if (at_ == bytes_.size()) return at_end;
      held_ = held_ << 8U | static_cast<uint8_t>(bytes_[at_++]);
      bits_ += 8;
    }
    bits_ -= width;
    return held_ >> bits_ & ((1U << width) - 1);
  }

 private:
  std::string_view bytes_;
  size_t at_ = 0;
  uint32_t held_ = 0;
  unsigned bits_ = 0;
};

/// A string of the table is a part of the output.
struct LzwEntry {
  size_t begin = 0, length = 0;
};

}  // namespace

std::string expand_tiff_lzw(std::string_view packed, size_t size) {
  constexpr uint32_t kClear = 256, kEnd = 257, kMostCodes = 4096;
  constexpr unsigned kFewestBits = 9;
  LzwCodes codes(packed);
  std::vector<LzwEntry> table;  // of the codes after kEnd
  std::string out;
  LzwEntry previous;
  unsigned width = kFewestBits;
  while (out.size() < size) {
    const uint32_t code = codes.next(width, kEnd);
    if (code == kEnd) break;
    if (code == kClear) {
      table.clear();
      width = kFewestBits;
      previous = {};
      continue;
    }
    const LzwEntry now{out.size(), 0};
    const uint32_t index = code - kEnd - 1;
    if (code < kClear) {
      out += static_cast<char>(code);
    } else if (index < table.size()) {
      for (size_t i = 0; i < table[index].length; ++i) out += out[table[index].begin + i];
    } else if (index == table.size() && previous.length > 0) {
      for (size_t i = 0; i < previous.length; ++i) out += out[previous.begin + i];
      out += out[previous.begin];
    } else {
      throw InputError("a block compressed by LZW is damaged; copy the file again");
    }
    if (previous.length > 0 && table.size() + kEnd + 1 < kMostCodes)
      table.push_back({previous.begin, previous.length + 1});  // its last byte is the first of this one
    previous = {now.begin, out.size() - now.begin};
    while (table.size() + kEnd + 2 >= (size_t{1} << width) && width < 12) ++width;
  }
  out.resize(std::min(out.size(), size));
  return out;
}

std::string expand_packbits(std::string_view packed, size_t size) {
  constexpr size_t kNothing = 128;
  std::string out;
  for (size_t at = 0; at < packed.size() && out.size() < size;) {
    const size_t n = static_cast<unsigned char>(packed[at++]);
    if (n == kNothing) continue;
    const bool repeats = n > kNothing;
    const size_t count = repeats ? 2 * kNothing + 1 - n : n + 1;
    const size_t used = repeats ? 1 : count;
    if (used > packed.size() - at) throw InputError("a compressed block is truncated; copy the file again");
    repeats ? out.append(count, packed[at]) : out.append(packed.substr(at, count));
    at += used;
  }
  out.resize(std::min(out.size(), size));
  return out;
}

}  // namespace kinloop
