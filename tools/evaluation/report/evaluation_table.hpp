#pragma once
// In: the errors of one or several estimates. Out: them as a table for people, spreadsheets, programs and
// papers.

#include <span>
#include <string>

#include "tools/evaluation/evaluate.hpp"

namespace kinloop {

enum class TableFormat { kText, kCsv, kJson, kLatex };

constexpr auto option_names(TableFormat) {
  using enum TableFormat;
  return std::to_array<EnumName<TableFormat>>(
      {{kText, "text"}, {kCsv, "csv"}, {kJson, "json"}, {kLatex, "latex"}});
}

/// The errors of an estimate, with its name.
struct NamedEvaluation {
  std::string name;
  Evaluation evaluation;
};

/// Returns the table. Text of a single estimate has a row for each measure with all statistics, that of
/// several one row for each estimate. JSON of a single estimate is an object, that of several an array of
/// them with their names.
std::string evaluation_table(std::span<const NamedEvaluation> all, TableFormat format);

}  // namespace kinloop
