#include "apps/shared/log_output.hpp"

#include <memory>
#include <string>
#include <string_view>
#include <utility>

#include <fmt/format.h>
#include <spdlog/pattern_formatter.h>
#include <spdlog/sinks/stdout_color_sinks.h>

#include "kinloop/core/log.hpp"

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

/// Escapes control characters as in C: a path may hold line breaks and the codes that control a terminal.
std::string escaped(std::string_view text) {
  constexpr unsigned char kFirstPrintable = 0x20, kDelete = 0x7F;
  std::string result;
  for (size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    const auto code = static_cast<unsigned char>(c);
    if (c == '\n') {
      result += "\\n";
    } else if (code < kFirstPrintable || code == kDelete || begins_with_unicode_control(text.substr(i))) {
      result += fmt::format("\\x{:02x}", code);
    } else {
      result += c;
    }
  }
  return result;
}

/// The text of a message.
class MessageText : public spdlog::custom_flag_formatter {
 public:
  void format(const spdlog::details::log_msg& message, const std::tm&, spdlog::memory_buf_t& line) override {
    const std::string text = escaped({message.payload.data(), message.payload.size()});
    line.append(text.data(), text.data() + text.size());
  }
  [[nodiscard]] std::unique_ptr<custom_flag_formatter> clone() const override {
    return std::make_unique<MessageText>();
  }
};

}  // namespace

void set_up_log() {
  auto logger = spdlog::stderr_color_st("kinloop");
  auto formatter = std::make_unique<spdlog::pattern_formatter>();
  formatter->add_flag<MessageText>('*').set_pattern("%^%l:%$ %*");
  logger->set_formatter(std::move(formatter));
  spdlog::set_default_logger(logger);
}

}  // namespace kinloop
