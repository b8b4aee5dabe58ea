#include "viewer/report/report_text.hpp"

#include <cmath>
#include <cstdint>

namespace kinloop {

std::string escape_html(std::string_view text) {
  std::string html;
  for (const char c : text) {
    switch (c) {
      case '&':
        html += "&amp;";
        break;
      case '<':
        html += "&lt;";
        break;
      case '>':
        html += "&gt;";
        break;
      case '"':
        html += "&quot;";
        break;
      default:
        html += c;
    }
  }
  return html;
}

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

std::string format_with_thousands(double number) {
  constexpr size_t kGroup = 3;
  std::string digits = std::to_string(std::llround(std::abs(number)));
  for (size_t at = digits.size(); at > kGroup; at -= kGroup) digits.insert(at - kGroup, "&#8239;");
  return (number < 0 ? "-" : "") + digits;
}

std::string fill_template(std::string_view page,
                          const std::map<std::string, std::string, std::less<>>& values) {
  constexpr std::string_view kOpen = "{{", kClose = "}}";
  std::string filled;
  while (true) {
    const size_t open = page.find(kOpen);
    const size_t close = page.find(kClose, open);
    filled += page.substr(0, open);
    if (open == std::string_view::npos || close == std::string_view::npos) return filled;
    const auto value = values.find(page.substr(open + kOpen.size(), close - open - kOpen.size()));
    if (value != values.end()) filled += value->second;
    page.remove_prefix(close + kClose.size());
  }
}

}  // namespace kinloop
