#include "tools/evaluation/report/evaluation_table.hpp"

#include <algorithm>
#include <functional>
#include <optional>

#include <fmt/format.h>

#include "kinloop/core/text/escaped.hpp"
#include "kinloop/core/text/json.hpp"
#include "kinloop/core/time.hpp"

namespace kinloop {
namespace {

using Value = std::optional<double>;

/// A figure of an estimate.
struct Column {
  std::string title;  ///< for people, with unit
  std::string key;    ///< for programs, with unit
  int decimals;
  std::function<Value(const Evaluation&)> value;
  bool is_in_text = true;  ///< false: in CSV alone
};

std::vector<Column> ate_columns() {
  const auto of = [](double ErrorStatistics::*figure) {
    return [figure](const Evaluation& e) -> Value { return e.ate.error_m.*figure; };
  };
  return {{"ATE rmse, m", "ate_rmse_m", 6, of(&ErrorStatistics::rmse)},
          {"mean, m", "ate_mean_m", 6, of(&ErrorStatistics::mean), false},
          {"median, m", "ate_median_m", 6, of(&ErrorStatistics::median)},
          {"std, m", "ate_std_m", 6, of(&ErrorStatistics::std), false},
          {"min, m", "ate_min_m", 6, of(&ErrorStatistics::min), false},
          {"max, m", "ate_max_m", 6, of(&ErrorStatistics::max)}};
}

/// RMS drift over an interval; `error` returns its statistics.
void add_rpe_columns(std::vector<Column>& columns, const std::string& title, const std::string& key,
                     const std::function<const std::optional<RpeResult>&(const Evaluation&)>& error) {
  columns.push_back(
      {"RPE " + title + ", m", "rpe_" + key + "_rmse_m", 6, [error](const Evaluation& e) -> Value {
         return error(e) ? Value(error(e)->translation_m.rmse) : std::nullopt;
       }});
  columns.push_back(
      {"RPE " + title + ", deg", "rpe_" + key + "_rmse_deg", 4, [error](const Evaluation& e) -> Value {
         return error(e) ? Value(error(e)->rotation_deg.rmse) : std::nullopt;
       }});
}

std::string without_blanks(std::string text) {
  std::erase(text, ' ');
  return text;
}

/// All estimates are evaluated over the same intervals.
std::vector<Column> columns_of(std::span<const NamedEvaluation> all) {
  auto columns = ate_columns();
  using Rpe = const std::optional<RpeResult>&;
  add_rpe_columns(columns, "1 s", "1s", [](const Evaluation& e) -> Rpe { return e.rpe_second; });
  add_rpe_columns(columns, "1 f", "1frame", [](const Evaluation& e) -> Rpe { return e.rpe_frame; });
  for (size_t i = 0; i < all.front().evaluation.rpe.size(); ++i) {
    const std::string delta = to_string(all.front().evaluation.rpe[i].delta);
    add_rpe_columns(columns, delta, without_blanks(delta),
                    [i](const Evaluation& e) -> Rpe { return e.rpe[i].error; });
  }
  const auto has_scale = [](const NamedEvaluation& named) { return named.evaluation.ate.scale != 1; };
  columns.push_back({"scale", "scale", 6, [](const Evaluation& e) -> Value { return e.ate.scale; },
                     std::any_of(all.begin(), all.end(), has_scale)});
  columns.push_back(
      {"offset, s", "offset_s", 4, [](const Evaluation& e) -> Value { return to_seconds(e.offset_ns); },
       std::any_of(all.begin(), all.end(), [](const auto& n) { return n.evaluation.offset_ns != 0; })});
  columns.push_back({"pairs", "pairs", 0,
                     [](const Evaluation& e) -> Value { return static_cast<double>(e.ate.error_m.count); }});
  columns.push_back({"coverage, %", "coverage_percent", 1,
                     [](const Evaluation& e) -> Value { return 100 * e.coverage.time_fraction; }});
  return columns;
}

std::string rounded(const Column& column, const Evaluation& evaluation) {
  const Value value = column.value(evaluation);
  return value ? fmt::format("{:.{}f}", *value, column.decimals) : "-";
}

std::string statistics_row(const std::string& name, const char* unit, const ErrorStatistics& s) {
  return fmt::format("{:<20} {:<4} {:>10.6f} {:>10.6f} {:>10.6f} {:>10.6f} {:>10.6f} {:>10.6f} {:>7}\n", name,
                     unit, s.rmse, s.mean, s.median, s.std, s.min, s.max, s.count);
}

std::string rpe_rows(const std::string& interval, const std::optional<RpeResult>& rpe) {
  if (!rpe) return {};
  return statistics_row(fmt::format("RPE {} translation", interval), "m", rpe->translation_m) +
         statistics_row(fmt::format("RPE {} rotation", interval), "deg", rpe->rotation_deg);
}

std::string text_of_one(const Evaluation& evaluation) {
  std::string text = fmt::format("{:<25} {:>10} {:>10} {:>10} {:>10} {:>10} {:>10} {:>7}\n", "", "rmse",
                                 "mean", "median", "std", "min", "max", "pairs");
  text += statistics_row("ATE", "m", evaluation.ate.error_m);
  text += rpe_rows("1 s", evaluation.rpe_second);
  text += rpe_rows("1 f", evaluation.rpe_frame);
  for (const RpeOver& asked : evaluation.rpe) text += rpe_rows(to_string(asked.delta), asked.error);
  text += '\n';
  if (evaluation.ate.scale != 1) text += fmt::format("scale      {:.6f}\n", evaluation.ate.scale);
  if (evaluation.offset_ns != 0)
    text += fmt::format("offset     {:.4f} s\n", to_seconds(evaluation.offset_ns));
  return text +
         fmt::format(
             "coverage   {:.1f} % of the ground truth's duration; {:.1f} % of the estimated poses have "
             "ground truth\n",
             100 * evaluation.coverage.time_fraction, 100 * evaluation.coverage.matched_fraction);
}

std::string text_of_several(std::span<const NamedEvaluation> all) {
  size_t width = 8;
  for (const auto& named : all) width = std::max(width, escaped(named.name).size());
  const auto columns = columns_of(all);
  std::string text = fmt::format("{:<{}}", "estimate", width);
  for (const Column& column : columns) {
    if (column.is_in_text) text += fmt::format("  {:>10}", column.title);
  }
  text += '\n';
  for (const auto& [name, evaluation] : all) {
    text += fmt::format("{:<{}}", escaped(name), width);
    for (const Column& column : columns) {
      if (column.is_in_text)
        text +=
            fmt::format("  {:>{}}", rounded(column, evaluation), std::max<size_t>(10, column.title.size()));
    }
    text += '\n';
  }
  return text;
}

/// A field of RFC 4180. One that a spreadsheet would take for a formula begins with an apostrophe.
std::string quoted(std::string text) {
  if (text.find_first_of("=+-@\t\r") == 0) text.insert(text.begin(), '\'');
  if (text.find_first_of(",\"\r\n") == std::string::npos) return text;
  std::string field = "\"";
  for (const char c : text) field += c == '"' ? std::string("\"\"") : std::string(1, c);
  return field + '"';
}

std::string csv(std::span<const NamedEvaluation> all) {
  const auto columns = columns_of(all);
  std::string text = "estimate";
  for (const Column& column : columns) text += "," + column.key;
  text += '\n';
  for (const auto& [name, evaluation] : all) {
    text += quoted(name);
    for (const Column& column : columns) {
      const Value value = column.value(evaluation);
      text += value ? fmt::format(",{}", *value) : ",";
    }
    text += '\n';
  }
  return text;
}

/// Text in which TeX sees no command.
std::string tex_of(const std::string& text) {
  std::string safe;
  for (const char c : text) {
    if (c == '\\') {
      safe += "\\textbackslash{}";
    } else if (c == '~' || c == '^') {
      safe += fmt::format("\\{}{{}}", c);
    } else {
      if (std::string("_%&#${}").find(c) != std::string::npos) safe += '\\';
      safe += c;
    }
  }
  return safe;
}

/// A table for the package booktabs.
std::string latex(std::span<const NamedEvaluation> all) {
  const auto columns = columns_of(all);
  std::string alignment = "l", header = "estimate";
  for (const Column& column : columns) {
    if (!column.is_in_text) continue;
    alignment += 'r';
    header += " & " + tex_of(column.title);
  }
  std::string text =
      fmt::format("\\begin{{tabular}}{{{}}}\n\\toprule\n{} \\\\\n\\midrule\n", alignment, header);
  for (const auto& [name, evaluation] : all) {
    text += tex_of(escaped(name));
    for (const Column& column : columns) {
      if (column.is_in_text) text += " & " + rounded(column, evaluation);
    }
    text += " \\\\\n";
  }
  return text + "\\bottomrule\n\\end{tabular}\n";
}

std::string json(std::span<const NamedEvaluation> all) {
  if (all.size() == 1) return json_text(to_json(all.front().evaluation), 2) + '\n';
  nlohmann::json array = nlohmann::json::array();
  for (const auto& [name, evaluation] : all) {
    array.push_back(to_json(evaluation));
    array.back()["estimate"] = name;
  }
  return json_text(array, 2) + '\n';
}

}  // namespace

std::string evaluation_table(std::span<const NamedEvaluation> all, TableFormat format) {
  if (all.empty()) return {};
  switch (format) {
    case TableFormat::kCsv:
      return csv(all);
    case TableFormat::kJson:
      return json(all);
    case TableFormat::kLatex:
      return latex(all);
    case TableFormat::kText:
      break;
  }
  return all.size() == 1 ? text_of_one(all.front().evaluation) : text_of_several(all);
}

}  // namespace kinloop
