#include <vector>

#include <fmt/format.h>

#include "drivers/openni2/oni_file.hpp"
#include "kinloop/core/errors.hpp"

namespace kinloop {
namespace {

constexpr uint8_t kRepeat = 0xE0, kFull = 0xFF;        ///< codes of a whole byte
constexpr uint8_t kFullNibble = 0xF, kNoNibble = 0xD;  ///< codes of the second nibble
constexpr int kNibbleOffset = 6, kByteOffset = 192;

/// Successive values differ little: a nibble holds a difference of -6 to 6, a byte one of -63 to 63.
class Decoder16z {
 public:
  Decoder16z(Bytes bytes, cv::Size size, bool with_table) : bytes_(bytes), depth_(size, CV_16UC1) {
    if (!with_table) return;
    const auto entries = bytes_.number<uint16_t>();
    for (int i = 0; i < entries; ++i) table_.push_back(bytes_.number<uint16_t>());
    indexed_ = true;
  }

  cv::Mat decode() {
    put(bytes_.number<uint16_t>());
    while (bytes_.left() > 0) decode_byte(bytes_.number<uint8_t>());
    if (pixels_ != depth_.total())
      throw InputError(fmt::format("truncated depth: {} of {} pixels", pixels_, depth_.total()));
    return depth_;
  }

 private:
  void decode_byte(uint8_t code) {
    if (code == kFull) return put_full();
    if (code >= kRepeat) {
      for (int i = 0; i < 2 * (code - kRepeat); ++i) put(last_);
      return;
    }
    const int second = code & 0xF;
    put(last_ - ((code >> 4) - kNibbleOffset));
    if (second == kFullNibble) return put_full();
    if (second != kNoNibble) put(last_ - (second - kNibbleOffset));
  }

  /// A difference in one byte, or a value in two.
  void put_full() {
    const auto high = bytes_.number<uint8_t>();
    put((high & 0x80) != 0 ? last_ - (high - kByteOffset) : high << 8 | bytes_.number<uint8_t>());
  }

  void put(int value) {
    last_ = static_cast<uint16_t>(value);
    if (pixels_ == depth_.total()) throw InputError("damaged depth: too many pixels");
    if (indexed_ && last_ >= table_.size()) throw InputError("damaged depth: a value beyond its table");
    depth_.ptr<uint16_t>()[pixels_++] = indexed_ ? table_[last_] : last_;
  }

  ByteReader bytes_;
  cv::Mat depth_;
  std::vector<uint16_t> table_;
  bool indexed_ = false;
  uint16_t last_ = 0;
  size_t pixels_ = 0;
};

}  // namespace

cv::Mat decode_16z(Bytes bytes, cv::Size size, bool with_table) {
  return Decoder16z(bytes, size, with_table).decode();
}

}  // namespace kinloop
