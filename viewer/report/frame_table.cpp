#include "viewer/report/frame_table.hpp"

#include <limits>

#include <fmt/format.h>

#include "kinloop/core/files/text_file.hpp"
#include "kinloop/core/time.hpp"

namespace kinloop {
namespace {

constexpr const char* kColumns =
    "stamp_s status features tracked ms sigma_m cause expected contradicted moved";
constexpr size_t kFields = 10, kFieldsUntilSigma = 6, kFieldsWithoutSigma = 5;

FrameRow parse_row(const TextLine& line, const std::filesystem::path& path) {
  const size_t fields = line.fields.size();
  if (fields != kFields && fields != kFieldsUntilSigma && fields != kFieldsWithoutSigma)
    throw_parse_error(path, line.number, fmt::format("expected '{}'", kColumns));
  const auto stamp_ns = parse_stamp_ns(line.fields[0]);
  if (!stamp_ns)
    throw_parse_error(path, line.number, fmt::format("'{}' is not a time stamp", line.fields[0]));
  const auto count = [&](const std::string& field) {
    const double number = parse_double(field, path, line.number);
    if (number < 0 || number > std::numeric_limits<int>::max())
      throw_parse_error(path, line.number, fmt::format("'{}' is not a number of features", field));
    return static_cast<int>(number);
  };
  const auto number = [&](size_t field) { return parse_double(line.fields[field], path, line.number); };
  FrameRow row{*stamp_ns, line.fields[1], count(line.fields[2]), count(line.fields[3]), number(4)};
  if (fields >= kFieldsUntilSigma) row.sigma_m = number(5);
  if (fields < kFields) return row;
  row.cause = line.fields[6];
  row.expected = count(line.fields[7]);
  row.contradicted = number(8);
  row.moved = number(9);
  return row;
}

}  // namespace

void write_frame_table(const std::filesystem::path& path, const FrameTable& table) {
  std::string text = fmt::format("# {}\n", kColumns);
  for (const FrameRow& row : table) {
    text += fmt::format("{} {} {} {} {:.3f} {:.6f} {} {} {:.3f} {:.3f}\n", format_stamp(row.stamp_ns),
                        row.status, row.features, row.tracked, row.ms, row.sigma_m, row.cause, row.expected,
                        row.contradicted, row.moved);
  }
  write_file(path, text);
}

FrameTable read_frame_table(const std::filesystem::path& path) {
  FrameTable table;
  visit_table(path, [&](const TextLine& line) { table.push_back(parse_row(line, path)); });
  return table;
}

}  // namespace kinloop
