#include "kinloop/dense/depth_codec.hpp"

#include <algorithm>

#include "kinloop/base/errors.hpp"

namespace kinloop {
namespace {

// A number is written in nibbles, lowest three bits first; the fourth bit marks a continuation.
constexpr uint32_t kPayloadBits = 3;
constexpr uint32_t kPayloadMask = 7;
constexpr uint32_t kMoreBit = 8;

class NibbleWriter {
 public:
  void write(uint32_t number) {
    do {
      const uint32_t rest = number >> kPayloadBits;
      put((number & kPayloadMask) | (rest != 0 ? kMoreBit : 0));
      number = rest;
    } while (number != 0);
  }

  std::vector<uint8_t> take() { return std::move(bytes_); }

 private:
  void put(uint32_t nibble) {
    if (half_written_) {
      bytes_.back() = static_cast<uint8_t>(bytes_.back() | nibble << 4);
    } else {
      bytes_.push_back(static_cast<uint8_t>(nibble));
    }
    half_written_ = !half_written_;
  }

  std::vector<uint8_t> bytes_;
  bool half_written_ = false;
};

class NibbleReader {
 public:
  explicit NibbleReader(std::span<const uint8_t> bytes) : bytes_(bytes) {}

  uint32_t read() {
    constexpr uint32_t kLastShift = 30;
    uint32_t number = 0;
    for (uint32_t shift = 0; shift <= kLastShift; shift += kPayloadBits) {
      const uint32_t nibble = next();
      number |= (nibble & kPayloadMask) << shift;
      if ((nibble & kMoreBit) == 0) return number;
    }
    throw std::logic_error("unpack_depth: unterminated number");
  }

 private:
  uint32_t next() {
    require(position_ / 2 < bytes_.size(), "unpack_depth: truncated");
    const uint32_t byte = bytes_[position_ / 2];
    return position_++ % 2 == 0 ? byte & 15U : byte >> 4;
  }

  std::span<const uint8_t> bytes_;
  size_t position_ = 0;  // in nibbles
};

/// Maps differences of either sign to small unsigned numbers: 0, -1, 1, -2, ... become 0, 1, 2, 3, ...
uint32_t zigzag(int32_t difference) {
  return (static_cast<uint32_t>(difference) << 1) ^ static_cast<uint32_t>(difference >> 31);
}

int32_t unzigzag(uint32_t code) {
  return static_cast<int32_t>(code >> 1) ^ -static_cast<int32_t>(code & 1);
}

}  // namespace

std::vector<uint8_t> pack_depth(std::span<const uint16_t> values) {
  NibbleWriter writer;
  int32_t previous = 0;
  for (auto at = values.begin(); at != values.end();) {
    const auto known = std::find_if(at, values.end(), [](uint16_t v) { return v != 0; });
    const auto unknown = std::find(known, values.end(), uint16_t{0});
    writer.write(static_cast<uint32_t>(known - at));
    writer.write(static_cast<uint32_t>(unknown - known));
    for (at = known; at != unknown; ++at) {
      writer.write(zigzag(*at - previous));
      previous = *at;
    }
  }
  return writer.take();
}

std::vector<uint16_t> unpack_depth(std::span<const uint8_t> bytes, size_t count) {
  NibbleReader reader(bytes);
  std::vector<uint16_t> values(count);
  int32_t previous = 0;
  for (size_t i = 0; i < count;) {
    i += reader.read();
    const size_t known = reader.read();
    require(i <= count && known <= count - i, "unpack_depth: more values than the image has");
    for (const size_t end = i + known; i < end; ++i) {
      previous += unzigzag(reader.read());
      values[i] = static_cast<uint16_t>(previous);
    }
  }
  return values;
}

}  // namespace kinloop
