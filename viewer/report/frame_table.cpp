#include "viewer/report/frame_table.hpp"

#include <fmt/format.h>

#include "kinloop/base/text_file.hpp"
#include "kinloop/base/time.hpp"

namespace kinloop {
namespace {

constexpr size_t kFields = 5;

}  // namespace

void write_frame_table(const std::filesystem::path& path, const FrameTable& table) {
  std::string text = "# stamp_s status features tracked ms\n";
  for (const FrameRow& row : table) {
    text += fmt::format("{} {} {} {} {:.3f}\n", format_stamp(row.stamp_ns), row.status, row.features,
                        row.tracked, row.ms);
  }
  write_file(path, text);
}

FrameTable read_frame_table(const std::filesystem::path& path) {
  FrameTable table;
  for (const TextLine& line : read_table(path)) {
    if (line.fields.size() != kFields)
      throw_parse_error(path, line.number, "expected 'stamp status features tracked ms'");
    const auto stamp_ns = parse_stamp_ns(line.fields[0]);
    if (!stamp_ns)
      throw_parse_error(path, line.number, fmt::format("'{}' is not a time stamp", line.fields[0]));
    const auto number = [&](size_t field) { return parse_double(line.fields[field], path, line.number); };
    table.push_back(
        {*stamp_ns, line.fields[1], static_cast<int>(number(2)), static_cast<int>(number(3)), number(4)});
  }
  return table;
}

}  // namespace kinloop
