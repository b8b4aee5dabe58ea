#include "kinloop/core/time_unit.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>

namespace kinloop {
namespace {

constexpr std::array kUnits = {kSecondsUnit, TimeUnit{1'000'000, "milliseconds"},
                               TimeUnit{1'000, "microseconds"}, TimeUnit{1, "nanoseconds"}};

constexpr uint64_t kFirstUnixSecond = 1'000'000'000, kLastUnixSecond = 4'000'000'000;  // 2001 to 2096

/// The first nine digits of a fraction, as billionths.
int64_t billionths(const std::string& fraction) {
  constexpr size_t kDigits = 9;
  std::string nine = fraction;
  nine.resize(kDigits, '0');
  return static_cast<int64_t>(parse_whole(nine).value_or(0));
}

std::optional<int64_t> stamp_of(const DecimalNumber& number, const TimeUnit& unit) {
  if (number.whole > static_cast<uint64_t>(kMaxStampNs / unit.ns) - 1) return std::nullopt;
  return static_cast<int64_t>(number.whole) * unit.ns + billionths(number.fraction) * unit.ns / kNsPerSecond;
}

/// The intervals between numbers in order of size, without repetitions.
std::vector<double> intervals_of(const std::vector<DecimalNumber>& numbers) {
  std::vector<double> values, intervals;
  for (const DecimalNumber& n : numbers)
    values.push_back(static_cast<double>(n.whole) + 1e-9 * static_cast<double>(billionths(n.fraction)));
  std::sort(values.begin(), values.end());
  for (size_t i = 1; i < values.size(); ++i) {
    if (values[i] > values[i - 1]) intervals.push_back(values[i] - values[i - 1]);
  }
  std::sort(intervals.begin(), intervals.end());
  return intervals;
}

/// Milliseconds of a camera come at even intervals. Every n-th frame, and keyframes that were chosen, are
/// numbers of frames, or seconds.
bool are_milliseconds(const std::vector<double>& intervals, bool fractions) {
  constexpr double kLeast_ms = 8;                         // 125 Hz
  constexpr double kTolerance = 0.1, kLeastShare = 0.75;  // of the median; of the intervals
  const double median = intervals[intervals.size() / 2];  // they are sorted
  const bool counted = !fractions && intervals.front() == intervals.back();
  if (median < kLeast_ms || counted) return false;
  const auto even = std::count_if(intervals.begin(), intervals.end(), [&](double interval) {
    return std::abs(interval - median) <= kTolerance * median;
  });
  return static_cast<double>(even) >= kLeastShare * static_cast<double>(intervals.size());
}

std::optional<TimeUnit> unit_by_clock(const std::vector<DecimalNumber>& numbers) {
  for (const TimeUnit& unit : kUnits) {
    const auto per_second = static_cast<uint64_t>(kNsPerSecond / unit.ns);
    if (std::all_of(numbers.begin(), numbers.end(),
                    [&](const DecimalNumber& n) { return is_unix_second(n.whole / per_second); }))
      return TimeUnit{unit.ns, unit.name, true};
  }
  return std::nullopt;
}

std::optional<TimeUnit> unit_by_intervals(const std::vector<DecimalNumber>& numbers) {
  constexpr double kShortest_s = 0.004, kLongest_s = 4;  // a factor of 1000: one unit fits
  const auto intervals = intervals_of(numbers);
  if (intervals.empty()) return std::nullopt;
  const bool fractions =
      std::any_of(numbers.begin(), numbers.end(), [](const DecimalNumber& n) { return !n.fraction.empty(); });
  const double median = intervals[intervals.size() / 2];
  for (const TimeUnit& unit : kUnits) {
    const double interval_s = median * to_seconds(unit.ns);
    if (interval_s < kShortest_s || interval_s >= kLongest_s) continue;
    const bool seconds = unit.ns == kSecondsUnit.ns, milliseconds = unit.ns == kUnits[1].ns;
    if (seconds && !fractions) continue;  // numbers of frames
    if (milliseconds && !are_milliseconds(intervals, fractions)) continue;
    return unit;
  }
  return fractions ? std::optional(kSecondsUnit) : std::nullopt;
}

}  // namespace

bool is_unix_second(uint64_t seconds) {
  return seconds >= kFirstUnixSecond && seconds < kLastUnixSecond;
}

std::optional<uint64_t> parse_whole(std::string_view digits) {
  uint64_t value = 0;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
  if (digits.empty() || error != std::errc() || end != digits.data() + digits.size()) return std::nullopt;
  return value;
}

std::optional<DecimalNumber> parse_decimal(std::string_view text) {
  const size_t point = std::min(text.find('.'), text.size());
  const auto whole = parse_whole(text.substr(0, point));
  const std::string_view fraction = text.substr(std::min(point + 1, text.size()));
  if (!whole || fraction.find_first_not_of("0123456789") != std::string_view::npos) return std::nullopt;
  return DecimalNumber{*whole, std::string(fraction)};
}

std::optional<std::vector<int64_t>> stamps_in(const TimeUnit& unit,
                                              const std::vector<DecimalNumber>& numbers) {
  std::vector<int64_t> stamps_ns;
  for (const DecimalNumber& number : numbers) {
    const auto stamp_ns = stamp_of(number, unit);
    if (!stamp_ns) return std::nullopt;
    stamps_ns.push_back(*stamp_ns);
  }
  return stamps_ns;
}

double median_interval(const std::vector<DecimalNumber>& numbers) {
  const auto intervals = intervals_of(numbers);
  return intervals.empty() ? 0 : intervals[intervals.size() / 2];
}

std::optional<FoundTimes> times_of(const std::vector<DecimalNumber>& numbers) {
  if (numbers.empty()) return std::nullopt;
  auto unit = unit_by_clock(numbers);
  if (!unit) unit = unit_by_intervals(numbers);
  if (!unit) return std::nullopt;
  const auto stamps_ns = stamps_in(*unit, numbers);
  return stamps_ns ? std::optional(FoundTimes{*stamps_ns, *unit}) : std::nullopt;
}

std::optional<FoundTimes> times_not_in_seconds(const std::vector<std::string>& texts) {
  std::vector<DecimalNumber> numbers;
  for (const std::string& text : texts) {
    auto number = parse_decimal(text);
    if (!number) return std::nullopt;
    numbers.push_back(*std::move(number));
  }
  auto times = times_of(numbers);
  return times && times->unit.ns != kSecondsUnit.ns ? times : std::nullopt;
}

}  // namespace kinloop
