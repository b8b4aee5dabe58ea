#include "kinloop/core/time.hpp"

#include <charconv>
#include <cmath>

#include <fmt/format.h>

#include "kinloop/core/errors.hpp"

namespace kinloop {
namespace {

std::optional<int64_t> parse_digits(std::string_view digits) {
  int64_t value = 0;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
  if (error != std::errc() || end != digits.data() + digits.size()) return std::nullopt;
  return value;
}

/// Exponents ("1.3e9") are legal in text files but rare; they go through double.
std::optional<int64_t> parse_scientific(std::string_view text) {
  double seconds = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), seconds);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  if (!std::isfinite(seconds) || std::abs(seconds) > to_seconds(kMaxStampNs)) return std::nullopt;
  return to_ns(seconds);
}

}  // namespace

int64_t checked_stamp_ns(int64_t stamp_ns) {
  if (is_possible_stamp(stamp_ns)) return stamp_ns;
  throw InputError(fmt::format("a time of {:.0f} s, more than 73 years from zero; correct the clock",
                               to_seconds(stamp_ns)));
}

std::optional<int64_t> parse_stamp_ns(std::string_view text) {
  if (text.empty()) return std::nullopt;
  if (text.find_first_not_of("-0123456789.") != std::string_view::npos) return parse_scientific(text);
  const bool negative = text.front() == '-';
  if (negative) text.remove_prefix(1);
  const size_t point = text.find('.');
  const std::string_view whole = text.substr(0, point);
  std::string fraction(point == std::string_view::npos ? "" : text.substr(point + 1));
  if (whole.empty() && fraction.empty()) return std::nullopt;
  if (fraction.find_first_not_of("0123456789") != std::string::npos) return std::nullopt;
  fraction.resize(9, '0');

  const auto seconds = whole.empty() ? std::optional<int64_t>(0) : parse_digits(whole);
  const auto nanoseconds = parse_digits(fraction);
  constexpr int64_t kMaxSeconds = 9'000'000'000;
  if (!seconds || !nanoseconds || *seconds > kMaxSeconds || *seconds < 0) return std::nullopt;
  const int64_t stamp_ns = *seconds * kNsPerSecond + *nanoseconds;
  if (!is_possible_stamp(stamp_ns)) return std::nullopt;
  return negative ? -stamp_ns : stamp_ns;
}

std::string format_stamp(int64_t stamp_ns) {
  const char* sign = stamp_ns < 0 ? "-" : "";
  const int64_t magnitude = std::abs(stamp_ns);
  const int64_t seconds = magnitude / kNsPerSecond;
  const int64_t nanoseconds = magnitude % kNsPerSecond;
  if (nanoseconds % 1000 != 0) return fmt::format("{}{}.{:09d}", sign, seconds, nanoseconds);
  return fmt::format("{}{}.{:06d}", sign, seconds, nanoseconds / 1000);
}

int64_t to_ns(double seconds) {
  return std::llround(seconds * 1e9);
}

}  // namespace kinloop
