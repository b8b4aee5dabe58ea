#include "apps/features/feature_table.hpp"

#include <algorithm>
#include <array>
#include <optional>

#include <fmt/format.h>

#include "kinloop/core/quantile.hpp"

namespace kinloop {
namespace {

double share(double part, double whole) {
  return whole > 0 ? part / whole : 0;
}

/// A column of the table: medians over the images or pairs of one seed, ratios over all its pairs together.
/// nullopt if it requires a ground truth that is missing.
struct Column {
  const char* key;    ///< in JSON
  const char* title;  ///< in the table
  int width;
  int digits;
  double unit;  ///< scale factor in the table
  const char* suffix;
  std::optional<double> (*of_seed)(const SeedMetrics& seed);
};

template <class Value>
double median_of_pairs(const SeedMetrics& seed, const Value& value) {
  std::vector<double> values;
  for (const PairMetrics& pair : seed.pairs) values.push_back(static_cast<double>(value(pair)));
  return median(values);
}

template <class Part, class Whole>
std::optional<double> share_of_pairs(const SeedMetrics& seed, const Part& part, const Whole& whole) {
  double visible = 0, parts = 0, wholes = 0;
  for (const PairMetrics& pair : seed.pairs) {
    visible += static_cast<double>(pair.visible);
    parts += static_cast<double>(part(pair));
    wholes += static_cast<double>(whole(pair));
  }
  return visible > 0 ? std::optional(share(parts, wholes)) : std::nullopt;
}

std::optional<double> median_error_px(const SeedMetrics& seed) {
  std::vector<double> errors_px;
  size_t visible = 0;
  for (const PairMetrics& pair : seed.pairs) {
    errors_px.insert(errors_px.end(), pair.errors_px.begin(), pair.errors_px.end());
    visible += pair.visible;
  }
  return visible > 0 ? std::optional(median(errors_px)) : std::nullopt;
}

using Figure = std::optional<double>;
using Pair = PairMetrics;

const std::array<Column, 8> kColumns = {{
    {"keypoints", "keypoints", 12, 0, 1, "",
     [](const SeedMetrics& s) -> Figure { return median(s.keypoints); }},
    {"milliseconds", "ms", 13, 2, 1, "",
     [](const SeedMetrics& s) -> Figure { return median(s.milliseconds); }},
    {"matches", "matches", 11, 0, 1, "",
     [](const SeedMetrics& s) -> Figure {
       return median_of_pairs(s, [](const Pair& p) { return p.matches; });
     }},
    {"screened", "screened", 11, 0, 1, "",
     [](const SeedMetrics& s) -> Figure {
       return median_of_pairs(s, [](const Pair& p) { return p.screened; });
     }},
    {"inliers", "inliers", 11, 0, 1, "",
     [](const SeedMetrics& s) -> Figure {
       return median_of_pairs(s, [](const Pair& p) { return p.inliers; });
     }},
    {"repeatability", "repeatability", 14, 1, 100, " %",
     [](const SeedMetrics& s) {
       return share_of_pairs(
           s, [](const Pair& p) { return p.repeated; }, [](const Pair& p) { return p.visible; });
     }},
    {"precision", "precision", 14, 1, 100, " %",
     [](const SeedMetrics& s) {
       return share_of_pairs(
           s, [](const Pair& p) { return p.correct; }, [](const Pair& p) { return p.checked; });
     }},
    {"error_px", "error px", 11, 2, 1, "", median_error_px},
}};

/// A figure over the seeds.
struct Spread {
  double median = 0, low = 0, high = 0;
};

std::optional<Spread> spread_of(const Column& column, const DetectorMetrics& detector) {
  std::vector<double> values;
  for (const SeedMetrics& seed : detector.seeds) {
    if (const auto value = column.of_seed(seed)) values.push_back(*value);
  }
  if (values.empty()) return std::nullopt;
  const auto [low, high] = std::minmax_element(values.begin(), values.end());
  return Spread{median(values), *low, *high};
}

std::string median_text(const Column& column, const Spread& spread) {
  return fmt::format("{:.{}f}{}", column.unit * spread.median, column.digits, column.suffix);
}

std::string range_text(const Column& column, const Spread& spread) {
  const auto number = [&](double value) {
    return fmt::format("{:.{}f}", column.unit * value, column.digits);
  };
  if (spread.low == spread.high) return "same";
  return fmt::format("{}-{}{}", number(spread.low), number(spread.high), column.suffix);
}

}  // namespace

std::string comparison_table(const std::vector<DetectorMetrics>& figures) {
  std::string table = fmt::format("{:<14}", "");
  for (const Column& column : kColumns) table += fmt::format("{:>{}}", column.title, column.width);
  for (const DetectorMetrics& detector : figures) {
    std::string medians = fmt::format("\n{:<14}", detector.name);
    std::string ranges = fmt::format("\n{:<14}", fmt::format("  {} seeds", detector.seeds.size()));
    for (const Column& column : kColumns) {
      const auto spread = spread_of(column, detector);
      medians += fmt::format("{:>{}}", spread ? median_text(column, *spread) : "-", column.width);
      ranges += fmt::format("{:>{}}", spread ? range_text(column, *spread) : "-", column.width);
    }
    table += medians + ranges;
  }
  return table + "\n";
}

nlohmann::json comparison_json(const std::vector<DetectorMetrics>& figures) {
  nlohmann::json list = nlohmann::json::array();
  for (const DetectorMetrics& detector : figures) {
    size_t images = 0, pairs = 0;
    for (const SeedMetrics& seed : detector.seeds) {
      images += seed.keypoints.size();
      pairs += seed.pairs.size();
    }
    nlohmann::json entry = {{"detector", detector.id},
                            {"name", detector.name},
                            {"images", images},
                            {"pairs", pairs},
                            {"seeds", detector.seeds.size()}};
    for (const Column& column : kColumns) {
      const auto spread = spread_of(column, detector);
      if (!spread) continue;
      entry[column.key] = spread->median;
      entry["ranges"][column.key] = {spread->low, spread->high};
    }
    list.push_back(entry);
  }
  return list;
}

}  // namespace kinloop
