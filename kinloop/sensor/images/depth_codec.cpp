#include "kinloop/sensor/images/depth_codec.hpp"

#include <algorithm>

#include "kinloop/core/errors.hpp"

namespace kinloop {
namespace {

// A number is written in nibbles, lowest three bits first; the fourth bit marks a continuation.
constexpr uint32_t kPayloadBits = 3;
constexpr uint32_t kPayloadMask = 7;
constexpr uint32_t kMoreBit = 8;

class NibbleWriter {
 public:
  explicit NibbleWriter(size_t expected_nibbles) : nibbles_(expected_nibbles + kMaxDigits) {}

  void write(uint32_t number) {
    if (count_ + kMaxDigits > nibbles_.size()) nibbles_.resize(2 * nibbles_.size());
    // Most numbers have one or two digits; which is hard to predict, so there is no branch.
    constexpr uint32_t kTwoDigits = 1U << (2 * kPayloadBits);
    while (number >= kTwoDigits) {
      nibbles_[count_++] = static_cast<uint8_t>((number & kPayloadMask) | kMoreBit);
      number >>= kPayloadBits;
    }
    const uint32_t rest = number >> kPayloadBits;
    const uint32_t more = static_cast<uint32_t>(rest != 0);
    nibbles_[count_] = static_cast<uint8_t>((number & kPayloadMask) | more * kMoreBit);
    nibbles_[count_ + 1] = static_cast<uint8_t>(rest);  // overwritten by the next number if it is zero
    count_ += 1 + more;
  }

  /// All nibbles, two to a byte, the earlier one in the lower bits.
  [[nodiscard]] std::vector<uint8_t> bytes() const {
    std::vector<uint8_t> packed((count_ + 1) / 2);
    for (size_t i = 0; i < count_ / 2; ++i) {
      packed[i] = static_cast<uint8_t>(nibbles_[2 * i] | nibbles_[2 * i + 1] << 4);
    }
    if (count_ % 2 == 1) packed.back() = nibbles_[count_ - 1];
    return packed;
  }

 private:
  static constexpr size_t kMaxDigits = 11;  // of 32 bits

  std::vector<uint8_t> nibbles_;
  size_t count_ = 0;
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
    throw InputError("packed depth is damaged");
  }

 private:
  uint32_t next() {
    if (position_ / 2 >= bytes_.size()) throw InputError("packed depth is truncated");
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
  NibbleWriter writer(values.size());
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
  return writer.bytes();
}

std::vector<uint16_t> unpack_depth(std::span<const uint8_t> bytes, size_t count) {
  NibbleReader reader(bytes);
  std::vector<uint16_t> values(count);
  uint32_t previous = 0;  // wraps in damaged bytes
  for (size_t i = 0; i < count;) {
    i += reader.read();
    const size_t known = reader.read();
    if (i > count || known > count - i) throw InputError("packed depth has more values than the image");
    for (const size_t end = i + known; i < end; ++i) {
      previous += static_cast<uint32_t>(unzigzag(reader.read()));
      values[i] = static_cast<uint16_t>(previous);
    }
  }
  return values;
}

}  // namespace kinloop
