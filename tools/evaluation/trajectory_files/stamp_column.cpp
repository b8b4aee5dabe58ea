#include <algorithm>
#include <charconv>
#include <cmath>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "kinloop/core/errors.hpp"
#include "kinloop/core/files/text_file.hpp"
#include "kinloop/core/quantile.hpp"
#include "kinloop/core/time.hpp"
#include "tools/evaluation/trajectory_files/columns.hpp"

namespace kinloop {
namespace {

struct StampUnit {
  const char* name;
  int64_t ns;
};

constexpr StampUnit kUnits[] = {{"s", kNsPerSecond}, {"ms", 1'000'000}, {"us", 1000}, {"ns", 1}};

std::optional<double> parse_number(const std::string& text) {
  double value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size() || !std::isfinite(value)) return std::nullopt;
  return value;
}

std::vector<double> parse_numbers(const std::vector<StampText>& texts, const std::filesystem::path& path) {
  std::vector<double> values;
  for (const auto& [line, text] : texts) {
    const auto value = parse_number(text);
    if (!value)
      throw_parse_error(path, line,
                        fmt::format("'{}' is not a time stamp in seconds; correct or delete the line", text));
    values.push_back(*value);
  }
  return values;
}

double median_step(const std::vector<double>& values) {
  std::vector<double> steps;
  for (size_t i = 1; i < values.size(); ++i) steps.push_back(std::abs(values[i] - values[i - 1]));
  return median(std::move(steps));
}

/// The largest unit in which the stamps are those of a trajectory.
const StampUnit& unit_of(const std::vector<double>& values) {
  constexpr double kUnixBeginS = 1e9, kUnixEndS = 2.3e9;  // 2001 to 2042
  constexpr double kLongestStepS = 10;
  double largest = 0, least = kUnixEndS;
  for (const double value : values) {
    largest = std::max(largest, std::abs(value));
    least = std::min(least, value);
  }
  const bool whole = std::all_of(values.begin(), values.end(), [](double v) { return v == std::floor(v); });
  const bool is_unix = least > kUnixBeginS && largest < kUnixEndS;
  const double step = median_step(values);
  for (const StampUnit& unit : kUnits) {
    const double unit_s = to_seconds(unit.ns);
    if (largest * unit_s > kUnixEndS) continue;
    if (!whole || is_unix || step * unit_s <= kLongestStepS) return unit;
  }
  return kUnits[0];
}

/// Exact where the text is decimal: doubles do not resolve nanoseconds of Unix time.
std::optional<int64_t> stamp_of(const std::string& text, double value, const StampUnit& unit) {
  if (unit.ns == kNsPerSecond) return parse_stamp_ns(text);
  int64_t whole = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), whole);
  const bool is_whole = error == std::errc() && end == text.data() + text.size();
  const int64_t stamp_ns = is_whole ? whole * unit.ns : std::llround(value * static_cast<double>(unit.ns));
  return is_possible_stamp(stamp_ns) ? std::optional(stamp_ns) : std::nullopt;
}

/// The first stamp of each interval in which time does not go back.
std::vector<size_t> intervals(const std::vector<int64_t>& stamps_ns) {
  std::vector<size_t> begins = {0};
  for (size_t i = 1; i < stamps_ns.size(); ++i) {
    if (stamps_ns[i] < stamps_ns[i - 1]) begins.push_back(i);
  }
  return begins;
}

/// Whether lines out of order are long intervals at the same times, as where one run was appended to another.
bool holds_several(const std::vector<int64_t>& stamps_ns, const std::vector<size_t>& begins) {
  constexpr size_t kMinPoses = 10;
  if (begins.size() < 2 || stamps_ns.size() / begins.size() < kMinPoses) return false;
  for (size_t k = 1; k < begins.size(); ++k) {
    const size_t end = k + 1 < begins.size() ? begins[k + 1] : stamps_ns.size();
    if (stamps_ns[end - 1] > stamps_ns[begins[k - 1]]) return true;
  }
  return false;
}

}  // namespace

StampColumn parse_stamps(const std::vector<StampText>& texts, const std::filesystem::path& path) {
  const auto values = parse_numbers(texts, path);
  const StampUnit& unit = unit_of(values);
  StampColumn column;
  for (size_t i = 0; i < texts.size(); ++i) {
    const auto stamp_ns = stamp_of(texts[i].text, values[i], unit);
    if (!stamp_ns)
      throw_parse_error(
          path, texts[i].line,
          fmt::format("'{}' is not a possible time stamp; correct or delete the line", texts[i].text));
    column.stamps_ns.push_back(*stamp_ns);
  }
  if (unit.ns != kNsPerSecond) column.note = fmt::format("time stamps are taken as {}", unit.name);
  return column;
}

std::string check_order(const std::vector<int64_t>& stamps_ns, const std::vector<StampText>& texts,
                        const std::filesystem::path& path) {
  const auto begins = intervals(stamps_ns);
  if (holds_several(stamps_ns, begins)) {
    throw_parse_error(
        path, texts[begins[1]].line,
        fmt::format("time goes back by {:.3f} s: the file holds {} trajectories of the same time, one after "
                    "the other; give each a file of its own",
                    to_seconds(stamps_ns[begins[1] - 1] - stamps_ns[begins[1]]), begins.size()));
  }
  std::vector<int64_t> sorted = stamps_ns;
  std::sort(sorted.begin(), sorted.end());
  size_t repeated = 0;
  for (size_t i = 1; i < sorted.size(); ++i) repeated += sorted[i] == sorted[i - 1] ? 1 : 0;
  if (100 * repeated > sorted.size()) {
    throw InputError(
        fmt::format("{}: {} of {} time stamps repeat; were they written with too few digits? Write them "
                    "with at least four decimals",
                    path.string(), repeated, sorted.size()));
  }
  if (begins.size() > 1) return "lines are not in order of time, and were sorted";
  if (1000 * repeated < sorted.size()) return {};  // recordings of motion capture have some
  if (repeated == 1) return fmt::format("one of {} time stamps repeats", sorted.size());
  if (repeated > 1) return fmt::format("{} of {} time stamps repeat", repeated, sorted.size());
  return {};
}

}  // namespace kinloop
