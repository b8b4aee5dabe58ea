#include "kinloop/core/text/base64.hpp"

#include <cstdint>

namespace kinloop {

std::string base64(std::string_view bytes) {
  constexpr std::string_view kDigits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  constexpr size_t kGroupBytes = 3, kGroupDigits = 4;
  std::string text;
  text.reserve((bytes.size() + 2) / kGroupBytes * kGroupDigits);
  for (size_t i = 0; i < bytes.size(); i += kGroupBytes) {
    const auto byte = [&](size_t k) {
      return i + k < bytes.size() ? static_cast<uint8_t>(bytes[i + k]) : 0U;
    };
    const uint32_t group = byte(0) << 16 | byte(1) << 8 | byte(2);
    for (size_t k = 0; k < kGroupDigits; ++k) {
      text += i + k <= bytes.size() ? kDigits[group >> (18 - 6 * k) & 63] : '=';
    }
  }
  return text;
}

}  // namespace kinloop
