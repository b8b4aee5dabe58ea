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

/// Returns the number of bytes of the character that `text` begins with, 2 to 4, in well-formed UTF-8; 0 if
/// it begins with ASCII or anything else.
size_t utf8_bytes(std::string_view text) {
  const auto byte = [&](size_t i) { return i < text.size() ? static_cast<unsigned char>(text[i]) : 0U; };
  const unsigned lead = byte(0);
  const size_t count = lead >= 0xC2 && lead <= 0xDF ? 2 : lead >= 0xE0 && lead <= 0xEF ? 3 : 4;
  if (lead < 0xC2 || lead > 0xF4) return 0;
  for (size_t i = 1; i < count; ++i)
    if (byte(i) < 0x80 || byte(i) > 0xBF) return 0;
  // No longer form than is needed, no surrogate, nothing above U+10FFFF.
  const bool too_long = (lead == 0xE0 && byte(1) < 0xA0) || (lead == 0xF0 && byte(1) < 0x90);
  const bool no_character = (lead == 0xED && byte(1) > 0x9F) || (lead == 0xF4 && byte(1) > 0x8F);
  return too_long || no_character ? 0 : count;
}

/// Returns whether `c` is a control character of ASCII.
bool is_ascii_control(unsigned char c) {
  constexpr unsigned char kFirstPrintable = 0x20, kDelete = 0x7F;
  return c < kFirstPrintable || c == kDelete;
}

}  // namespace

std::string escaped(std::string_view text, std::string_view kept) {
  std::string result;
  // No byte of a control character is left, nor one that is not UTF-8: some terminals obey 0x9B alone.
  size_t control_end = 0, character_end = 0;
  for (size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    const auto code = static_cast<unsigned char>(c);
    control_end = std::max(control_end, i + unicode_control_bytes(text.substr(i)));
    character_end = std::max(character_end, i + utf8_bytes(text.substr(i)));
    const bool malformed = code >= 0x80 && i >= character_end;
    const bool control = is_ascii_control(code) || malformed || i < control_end;
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
