#include "kinloop/core/text/escaped.hpp"

#include <algorithm>

#include <fmt/format.h>

namespace kinloop {
namespace {

/// Returns the byte at an index, 0 beyond the end.
unsigned byte_at(std::string_view text, size_t i) {
  return i < text.size() ? static_cast<unsigned char>(text[i]) : 0U;
}

/// Returns whether a character in UTF-8 is a control character: of ASCII, C1, which terminals obey, or one
/// of those that reverse the direction of writing.
bool is_control(std::string_view character) {
  constexpr unsigned kFirstPrintable = 0x20, kDelete = 0x7F;
  const auto in = [](unsigned value, unsigned first, unsigned last) {
    return first <= value && value <= last;
  };
  const unsigned lead = byte_at(character, 0), second = byte_at(character, 1), third = byte_at(character, 2);
  if (character.size() == 1) return lead < kFirstPrintable || lead == kDelete;
  if (lead == 0xC2 && in(second, 0x80, 0x9F)) return true;  // U+0080 to U+009F
  if (lead == 0xD8 && second == 0x9C) return true;          // U+061C
  const bool is_mark = second == 0x80 && (in(third, 0x8E, 0x8F) || in(third, 0xAA, 0xAE));
  const bool is_isolate = second == 0x81 && in(third, 0xA6, 0xA9);
  return lead == 0xE2 && (is_mark || is_isolate);  // U+200E, F, U+202A to E, U+2066 to U+2069
}

/// Returns the number of bytes of the character that `text` begins with, in well-formed UTF-8; 0 if it
/// begins with anything else.
size_t utf8_bytes(std::string_view text) {
  const unsigned lead = byte_at(text, 0), second = byte_at(text, 1);
  if (lead < 0x80) return 1;
  const size_t count = lead >= 0xC2 && lead <= 0xDF ? 2 : lead >= 0xE0 && lead <= 0xEF ? 3 : 4;
  if (lead < 0xC2 || lead > 0xF4) return 0;
  for (size_t i = 1; i < count; ++i)
    if (byte_at(text, i) < 0x80 || byte_at(text, i) > 0xBF) return 0;
  // No longer form than is needed, no surrogate, nothing above U+10FFFF.
  const bool too_long = (lead == 0xE0 && second < 0xA0) || (lead == 0xF0 && second < 0x90);
  const bool no_character = (lead == 0xED && second > 0x9F) || (lead == 0xF4 && second > 0x8F);
  return too_long || no_character ? 0 : count;
}

}  // namespace

std::string escaped(std::string_view text, std::string_view kept) {
  std::string result;
  while (!text.empty()) {
    // No byte of a control character is left, nor one that is not UTF-8: some terminals obey 0x9B alone.
    const size_t bytes = utf8_bytes(text);
    const std::string_view character = text.substr(0, std::max<size_t>(bytes, 1));
    text.remove_prefix(character.size());
    const bool is_safe = bytes > 0 && !is_control(character);
    if (is_safe || kept.find(character) != std::string_view::npos) {
      result += character;
    } else if (character == "\n") {
      result += "\\n";
    } else {
      for (const char byte : character) result += fmt::format("\\x{:02x}", static_cast<unsigned char>(byte));
    }
  }
  return result;
}

std::string escaped_markup(std::string_view text) {
  std::string markup;
  for (const char c : text) {
    if (c == '&') {
      markup += "&amp;";
    } else if (c == '<') {
      markup += "&lt;";
    } else if (c == '>') {
      markup += "&gt;";
    } else if (c == '"') {
      markup += "&quot;";
    } else if (static_cast<unsigned char>(c) >= ' ' || c == '\n' || c == '\r' || c == '\t') {
      markup += c;
    }
  }
  return markup;
}

}  // namespace kinloop
