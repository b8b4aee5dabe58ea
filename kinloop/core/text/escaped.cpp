#include "kinloop/core/text/escaped.hpp"

#include <fmt/format.h>

namespace kinloop {
namespace {

/// Returns whether `text` begins with one of the control characters of Unicode, in UTF-8: C1, which terminals
/// obey, and those that reverse the direction of writing.
bool begins_with_unicode_control(std::string_view text) {
  const auto byte = [&](size_t i) { return i < text.size() ? static_cast<unsigned char>(text[i]) : 0U; };
  const auto in = [](unsigned value, unsigned first, unsigned last) {
    return first <= value && value <= last;
  };
  if (byte(0) == 0xC2) return in(byte(1), 0x80, 0x9F);  // U+0080 to U+009F
  if (byte(0) == 0xD8) return byte(1) == 0x9C;          // U+061C
  if (byte(0) != 0xE2) return false;
  if (byte(1) == 0x80) return in(byte(2), 0x8E, 0x8F) || in(byte(2), 0xAA, 0xAE);  // U+200E, F, U+202A to E
  return byte(1) == 0x81 && in(byte(2), 0xA6, 0xA9);                               // U+2066 to U+2069
}

}  // namespace

std::string escaped(std::string_view text, std::string_view kept) {
  constexpr unsigned char kFirstPrintable = 0x20, kDelete = 0x7F;
  std::string result;
  for (size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    const auto code = static_cast<unsigned char>(c);
    const bool control =
        code < kFirstPrintable || code == kDelete || begins_with_unicode_control(text.substr(i));
    if (!control || kept.find(c) != std::string_view::npos) {
      result += c;
    } else if (c == '\n') {
      result += "\\n";
    } else {
      result += fmt::format("\\x{:02x}", code);
    }
  }
  return result;
}

}  // namespace kinloop
