#include "drivers/datasets/reading/lists/name_times.hpp"

#include <algorithm>
#include <chrono>
#include <string_view>

namespace kinloop {
namespace fs = std::filesystem;

std::vector<NameNumber> numbers_in_name(const fs::path& file) {
  constexpr const char* kDigits = "0123456789";
  const std::string stem = file.stem().string();
  const auto run_at = [&](size_t begin) {
    return stem.substr(begin, std::min(stem.find_first_not_of(kDigits, begin), stem.size()) - begin);
  };
  std::vector<NameNumber> numbers;
  for (size_t at = stem.find_first_of(kDigits); at != std::string::npos;
       at = stem.find_first_of(kDigits, at)) {
    NameNumber number{run_at(at), "", at == 0 ? char{0} : stem[at - 1]};
    at += number.digits.size();
    if (at < stem.size() && stem[at] == '.') number.fraction = run_at(at + 1);
    if (!number.fraction.empty()) at += 1 + number.fraction.size();
    numbers.push_back(std::move(number));
  }
  return numbers;
}

namespace {

using Names = std::vector<std::vector<NameNumber>>;

/// Without what all names end with, such as the size of the images.
void drop_constant_ends(Names& names) {
  const auto has_same_end = [&](const auto& name) {
    const NameNumber &a = name.back(), &b = names.front().back();
    return name.size() == names.front().size() && a.digits == b.digits && a.fraction == b.fraction;
  };
  while (names.size() > 1 && names.front().size() > 1 &&
         std::all_of(names.begin(), names.end(),
                     [&](const auto& name) { return !name.empty() && has_same_end(name); })) {
    for (auto& name : names) name.pop_back();
  }
}

/// How many digits a part of a second has: 9 (ns), 6 (us) or 3 (ms); names may leave out leading zeros.
size_t subsecond_digits(size_t longest) {
  constexpr size_t kMilli = 3, kMicro = 6, kNano = 9;
  return longest > kMicro ? kNano : longest > kMilli ? kMicro : kMilli;
}

const char* name_of_parts(size_t digits) {
  constexpr size_t kMicro = 6;
  if (digits > kMicro) return "seconds and nanoseconds";
  return digits == kMicro ? "seconds and microseconds" : "seconds and milliseconds";
}

/// Seconds and the whole number that follows them.
struct TwoNumbers {
  std::string seconds, part;
};

/// The last two numbers of a name, or the two of "%d.%d".
std::optional<TwoNumbers> two_numbers(const std::vector<NameNumber>& name) {
  if (name.empty()) return std::nullopt;
  const NameNumber& last = name.back();
  if (!last.fraction.empty()) return TwoNumbers{last.digits, last.fraction};
  if (name.size() < 2 || (last.before != '_' && last.before != '-')) return std::nullopt;
  const NameNumber& seconds = name[name.size() - 2];
  return seconds.fraction.empty() ? std::optional(TwoNumbers{seconds.digits, last.digits}) : std::nullopt;
}

/// What the second of two numbers looks like in all names.
struct PartWidths {
  size_t shortest = std::string::npos, longest = 0;
  bool leading_zero = false, trailing_zero = false;

  void add(const std::string& part) {
    shortest = std::min(shortest, part.size());
    longest = std::max(longest, part.size());
    if (part.size() < 2) return;
    leading_zero = leading_zero || part.front() == '0';
    trailing_zero = trailing_zero || part.back() == '0';
  }

  /// A printed float has no zeros at its end; "%d.%d" of seconds and nanoseconds has none at the beginning.
  [[nodiscard]] bool lacks_leading_zeros() const {
    return shortest < longest && !leading_zero && trailing_zero;
  }
};

/// "1700000000_066667000", "1700000000-66667000" and "1700000000.66667000" of "%d.%d".
std::optional<FoundTimes> times_of_two_numbers(const Names& names) {
  constexpr size_t kNano = 9;
  std::vector<DecimalNumber> numbers;
  PartWidths widths;
  bool decimal = false, unix_time = true;
  for (const auto& name : names) {
    const auto two = two_numbers(name);
    const auto seconds = two ? parse_whole(two->seconds) : std::nullopt;
    if (!seconds || two->part.size() > kNano) return std::nullopt;
    widths.add(two->part);
    decimal = decimal || !name.back().fraction.empty();
    unix_time = unix_time && is_unix_second(*seconds);
    numbers.push_back({*seconds, two->part});
  }
  if (decimal && !widths.lacks_leading_zeros()) return std::nullopt;
  if (!unix_time && widths.shortest != kNano) return std::nullopt;
  const size_t digits = subsecond_digits(widths.longest);
  for (DecimalNumber& number : numbers) number.fraction.insert(0, digits - number.fraction.size(), '0');
  // A counter after a number has far shorter intervals; an interval of minutes is no camera's.
  constexpr double kShortest_s = 0.004, kLongest_s = 60;
  const double interval_s = median_interval(numbers);
  if (names.size() > 1 && (interval_s < kShortest_s || interval_s > kLongest_s)) return std::nullopt;
  const auto stamps_ns = stamps_in(kSecondsUnit, numbers);
  if (!stamps_ns) return std::nullopt;
  return FoundTimes{*stamps_ns, {kNsPerSecond, name_of_parts(digits), unix_time}};
}

/// The number of each name that is `from_end` before its last; nothing unless all have one.
std::optional<std::vector<DecimalNumber>> decimals_at(const Names& names, size_t from_end) {
  std::vector<DecimalNumber> numbers;
  for (const auto& name : names) {
    if (name.size() <= from_end) return std::nullopt;
    const NameNumber& number = name[name.size() - 1 - from_end];
    const auto whole = parse_whole(number.digits);
    if (!whole) return std::nullopt;
    numbers.push_back({*whole, number.fraction});
  }
  return numbers;
}

/// Times that are one number: the last of the names; an earlier one only if it is Unix time, as other things
/// are numbered there.
std::optional<FoundTimes> times_of_one_number(const Names& names) {
  constexpr size_t kMostNumbers = 8;
  for (size_t from_end = 0; from_end < kMostNumbers; ++from_end) {
    const auto numbers = decimals_at(names, from_end);
    if (!numbers) return std::nullopt;
    auto times = times_of(*numbers);
    if (times && (from_end == 0 || times->unit.from_clock)) return times;
  }
  return std::nullopt;
}

/// Seconds from 1970 of "YYYYMMDDhhmmss".
std::optional<uint64_t> seconds_of_date(const std::string& digits) {
  const auto part = [&](size_t begin, size_t size) {
    return static_cast<int>(parse_whole(std::string_view(digits).substr(begin, size)).value_or(0));
  };
  constexpr int kFirstYear = 2000, kLastYear = 2099, kHours = 24, kSixty = 60;
  const int year = part(0, 4), hour = part(8, 2), minute = part(10, 2), second = part(12, 2);
  namespace ch = std::chrono;
  const ch::year_month_day date{ch::year(year), ch::month(static_cast<unsigned>(part(4, 2))),
                                ch::day(static_cast<unsigned>(part(6, 2)))};
  if (year < kFirstYear || year > kLastYear || !date.ok() || hour >= kHours || minute >= kSixty ||
      second > kSixty)
    return std::nullopt;
  const auto since =
      ch::sys_days(date).time_since_epoch() + ch::hours(hour) + ch::minutes(minute) + ch::seconds(second);
  return static_cast<uint64_t>(ch::duration_cast<ch::seconds>(since).count());
}

/// "20240131_120000_250", "2024-01-31-12-00-00.25" and the like: a date and a time of day.
std::optional<FoundTimes> times_of_dates(const Names& names) {
  constexpr size_t kDate = 14, kNano = 9;
  std::vector<DecimalNumber> numbers;
  size_t longest = 0;
  bool decimal = false;
  for (const auto& name : names) {
    std::string digits, part;
    for (size_t at = 0; at < name.size() && part.empty(); ++at) {
      (digits.size() < kDate ? digits : part) += name[at].digits;
      decimal = decimal || !name[at].fraction.empty();
      if (!name[at].fraction.empty()) part = name[at].fraction;
    }
    if (digits.size() > kDate) part = digits.substr(kDate);  // all in one number
    if (digits.size() < kDate || part.size() > kNano) return std::nullopt;
    const auto seconds = seconds_of_date(digits);
    if (!seconds) return std::nullopt;
    longest = std::max(longest, part.size());
    numbers.push_back({*seconds, part});
  }
  for (DecimalNumber& number : numbers) {
    if (!decimal) number.fraction.insert(0, subsecond_digits(longest) - number.fraction.size(), '0');
  }
  const auto stamps_ns = stamps_in(kSecondsUnit, numbers);
  return stamps_ns ? std::optional(FoundTimes{*stamps_ns, {kNsPerSecond, "dates", true}}) : std::nullopt;
}

bool all_differ(std::vector<int64_t> stamps_ns) {
  std::sort(stamps_ns.begin(), stamps_ns.end());
  return std::adjacent_find(stamps_ns.begin(), stamps_ns.end()) == stamps_ns.end();
}

}  // namespace

std::optional<FoundTimes> times_in_names(const std::vector<fs::path>& files,
                                         const std::optional<TimeUnit>& known) {
  Names names;
  for (const fs::path& file : files) names.push_back(numbers_in_name(file));
  if (names.empty()) return std::nullopt;
  drop_constant_ends(names);
  for (const auto& read : {times_of_dates, times_of_two_numbers, times_of_one_number}) {
    auto times = read(names);
    if (times && all_differ(times->stamps_ns)) return times;
  }
  if (!known || names.size() > 1) return std::nullopt;
  const auto numbers = decimals_at(names, 0);
  const auto stamps_ns = numbers ? stamps_in(*known, *numbers) : std::nullopt;
  return stamps_ns ? std::optional(FoundTimes{*stamps_ns, *known}) : std::nullopt;
}

}  // namespace kinloop
