#include "apps/shared/terminal/log_output.hpp"

#include <memory>
#include <string>
#include <string_view>
#include <utility>

#include <fmt/format.h>
#include <spdlog/pattern_formatter.h>
#include <spdlog/sinks/stdout_color_sinks.h>

#include "kinloop/core/log.hpp"
#include "kinloop/core/text/escaped.hpp"

namespace kinloop {
namespace {

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
