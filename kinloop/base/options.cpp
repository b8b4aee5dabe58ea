#include "kinloop/base/options.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "kinloop/base/did_you_mean.hpp"
#include "kinloop/base/errors.hpp"

namespace kinloop {
namespace {

[[noreturn]] void reject(const std::string& key, const std::string& text, const std::string& expected) {
  throw UsageError(fmt::format("option {}: '{}' is not {}", key, text, expected));
}

template <class Number>
Number parse_number(const std::string& key, const std::string& text, const std::string& expected,
                    Range range) {
  Number value{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  const bool whole_text = error == std::errc() && end == text.data() + text.size();
  const auto as_double = static_cast<double>(value);
  if (!whole_text || !std::isfinite(as_double) || as_double < range.low || as_double > range.high) {
    reject(key, text, expected);
  }
  return value;
}

std::string describe(const char* kind, Range range) {
  if (std::isinf(range.low) && std::isinf(range.high)) return kind;
  if (std::isinf(range.high)) return fmt::format("{} of at least {}", kind, range.low);
  return fmt::format("{} from {} to {}", kind, range.low, range.high);
}

}  // namespace

namespace detail {

OptionEntry make_entry(const std::string& key, bool& field, std::string help) {
  const auto set = [key, &field](const std::string& text) {
    if (text == "true" || text == "on" || text == "1") {
      field = true;
    } else if (text == "false" || text == "off" || text == "0") {
      field = false;
    } else {
      reject(key, text, "true or false");
    }
  };
  return {key, std::move(help), "true or false", field, set};
}

OptionEntry make_entry(const std::string& key, int& field, std::string help, Range range) {
  const std::string expected = describe("a whole number", range);
  const auto set = [key, &field, expected, range](const std::string& text) {
    field = parse_number<int>(key, text, expected, range);
  };
  return {key, std::move(help), expected, static_cast<int64_t>(field), set};
}

OptionEntry make_entry(const std::string& key, double& field, std::string help, Range range) {
  const std::string expected = describe("a number", range);
  const auto set = [key, &field, expected, range](const std::string& text) {
    field = parse_number<double>(key, text, expected, range);
  };
  return {key, std::move(help), expected, field, set};
}

OptionEntry make_entry(const std::string& key, std::string& field, std::string help, Choices choices) {
  const std::string expected =
      choices.words.empty() ? "text" : fmt::format("one of {}", fmt::join(choices.words, ", "));
  const auto set = [key, &field, expected, choices](const std::string& text) {
    const auto& words = choices.words;
    if (!words.empty() && std::find(words.begin(), words.end(), text) == words.end())
      reject(key, text, expected);
    field = text;
  };
  return {key, std::move(help), expected, field, set};
}

}  // namespace detail

void apply_assignment(std::span<const OptionEntry> entries, const std::string& assignment) {
  const size_t equals = assignment.find('=');
  if (equals == std::string::npos) {
    const std::string example =
        entries.empty() ? "" : fmt::format(", e.g. {}={}", entries[0].key, to_text(entries[0].value));
    throw UsageError(fmt::format("option '{}': expected key=value{}", assignment, example));
  }
  const std::string key = assignment.substr(0, equals);
  const auto found =
      std::find_if(entries.begin(), entries.end(), [&](const auto& e) { return e.key == key; });
  if (found == entries.end()) {
    std::vector<std::string> keys;
    for (const OptionEntry& entry : entries) keys.push_back(entry.key);
    throw UsageError(fmt::format("unknown option '{}'{}", key, did_you_mean(key, keys)));
  }
  found->set(assignment.substr(equals + 1));
}

std::string to_text(const OptionValue& value) {
  return std::visit([](const auto& v) { return fmt::format("{}", v); }, value);
}

std::string options_help(std::span<const OptionEntry> entries) {
  std::string help;
  for (const auto& entry : entries) {
    help +=
        fmt::format("  {}={}\n      {} ({})\n", entry.key, to_text(entry.value), entry.help, entry.expected);
  }
  return help;
}

}  // namespace kinloop
