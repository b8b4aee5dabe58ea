#include "kinloop/core/text/escaped.hpp"

#include <algorithm>

#include <fmt/format.h>

namespace kinloop {
namespace {

/// Returns the number of bytes of the control character of Unicode that `text` begins with, in UTF-8: C1,
/// which terminals obey, and those that reverse the direction of writing; 0 if it begins with another
/// character.
size_t unicode_control_bytes(std::string_view text) {
  const auto byte = [&](size_t i) { return i < text.size() ? static_cast<unsigned char>(text[i]) : 0U; };
  const auto in = [](unsigned value, unsigned first, unsigned last) {
    return first <= value && value <= last;
  };
  if (byte(0) == 0xC2 && in(byte(1), 0x80, 0x9F)) return 2;  // U+0080 to U+009F
  if (byte(0) == 0xD8 && byte(1) == 0x9C) return 2;          // U+061C
  const bool is_mark = byte(1) == 0x80 && (in(byte(2), 0x8E, 0x8F) || in(byte(2), 0xAA, 0xAE));
  const bool is_isolate = byte(1) == 0x81 && in(byte(2), 0xA6, 0xA9);
  return byte(0) == 0xE2 && (is_mark || is_isolate) ? 3 : 0;  // U+200E, F, U+202A to E, U+2066 to U+2069
}

/// Returns whether `c` is a control character of ASCII.
bool is_ascii_control(unsigned char c) {
  constexpr unsigned char kFirstPrintable = 0x20, kDelete = 0x7F;
  return c < kFirstPrintable || c == kDelete;
}

}  // namespace

std::string escaped(std::string_view text, std::string_view kept) {
  std::string result;
  size_t control_end = 0;  // no byte of a control character is left: some terminals obey 0x9B alone
  for (size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    const auto code = static_cast<unsigned char>(c);
    control_end = std::max(control_end, i + unicode_control_bytes(text.substr(i)));
    const bool control = is_ascii_control(code) || i < control_end;
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
