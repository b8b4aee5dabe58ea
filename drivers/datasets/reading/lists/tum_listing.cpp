#include "drivers/datasets/reading/lists/tum_listing.hpp"

#include <algorithm>
#include <string>

#include <fmt/format.h>

#include "drivers/datasets/reading/lists/image_pairs.hpp"
#include "drivers/datasets/sequence_layout.hpp"
#include "kinloop/core/association.hpp"
#include "kinloop/core/errors.hpp"
#include "kinloop/core/files/text_file.hpp"
#include "kinloop/core/log.hpp"
#include "kinloop/core/time.hpp"

namespace kinloop {
namespace {

/// The rows of a text file whose first column is a time stamp, and the rows skipped.
struct StampedRows {
  std::vector<int64_t> stamps_ns;
  std::vector<TextLine> lines;
  SkippedFrames skipped;
};

int64_t stamp_of(const std::filesystem::path& file, const TextLine& line, size_t column) {
  const auto stamp_ns = parse_stamp_ns(line.fields[column]);
  if (!stamp_ns) {
    throw_parse_error(
        file, line.number,
        fmt::format("'{}' is not a timestamp in seconds; correct or delete the line", line.fields[column]));
  }
  return *stamp_ns;
}

int64_t row_stamp(const std::filesystem::path& file, const TextLine& line, const std::string& columns) {
  const size_t expected = static_cast<size_t>(std::count(columns.begin(), columns.end(), ' ')) + 1;
  if (line.fields.size() != expected) {
    const char* blanks = line.fields.size() > expected ? "; names of files must not have blanks" : "";
    throw_parse_error(file, line.number,
                      fmt::format("expected '{}' separated by blanks, found {} fields{}", columns,
                                  line.fields.size(), blanks));
  }
  return stamp_of(file, line, 0);
}

/// The file of a row. Lists that were written on Windows may have backslashes.
std::filesystem::path file_of_row(const std::filesystem::path& folder, std::string name) {
  std::error_code ignored;
  if (name.find('\\') != std::string::npos && !std::filesystem::exists(folder / name, ignored))
    std::replace(name.begin(), name.end(), '\\', '/');
  return folder / name;
}

/// Reads rows with increasing time stamps. `columns` names the columns, separated by blanks.
StampedRows read_stamped_rows(const std::filesystem::path& file, const std::string& columns) {
  constexpr size_t kMaxDisorder = 2;  // tolerates one row out of order in this many
  StampedRows rows;
  size_t first_skipped_line = 0;
  for (TextLine& line : read_table(file)) {
    const int64_t stamp_ns = row_stamp(file, line, columns);
    if (rows.stamps_ns.empty() || stamp_ns > rows.stamps_ns.back()) {
      rows.stamps_ns.push_back(stamp_ns);
      rows.lines.push_back(std::move(line));
      continue;
    }
    if (rows.skipped.empty()) first_skipped_line = line.number;
    const char* what = stamp_ns == rows.stamps_ns.back() ? "repeats" : "is earlier than";
    rows.skipped.add(
        {line.fields[1], fmt::format("{}:{}: timestamp {} {} that of line {}", file.string(), line.number,
                                     line.fields[0], what, rows.lines.back().number)});
  }
  const size_t count = rows.lines.size() + rows.skipped.size();
  if (count == 0) {
    throw InputError(fmt::format("{}: empty; expected lines '{}'", file.string(), columns));
  }
  if (rows.skipped.size() * kMaxDisorder > count) {
    throw_parse_error(file, first_skipped_line,
                      fmt::format("timestamps do not increase in {} of {} lines: sort the file "
                                  "by time or correct the timestamps",
                                  rows.skipped.size(), count));
  }
  return rows;
}

/// Pairs made by the user are kept, but warn if they suggest different clocks.
void warn_of_pairs_apart(const std::filesystem::path& file, const StampedRows& rows) {
  size_t apart = 0, first_line = 0;
  for (size_t i = 0; i < rows.lines.size(); ++i) {
    const int64_t color_ns = rows.stamps_ns[i], depth_ns = stamp_of(file, rows.lines[i], 2);
    if (depth_ns >= color_ns - kMaxAssociationNs && depth_ns <= color_ns + kMaxAssociationNs) continue;
    if (apart++ == 0) first_line = rows.lines[i].number;
  }
  if (apart == 0) return;
  log::warn("{}:{}: colour and depth are more than {} s apart in {} of {} pairs; used anyway", file.string(),
            first_line, to_seconds(kMaxAssociationNs), apart, rows.lines.size());
}

TumListing read_associated(const std::filesystem::path& folder) {
  const auto file = folder / "associations.txt";
  StampedRows rows = read_stamped_rows(file, "timestamp colour_file timestamp depth_file");
  warn_of_pairs_apart(file, rows);
  TumListing listing;
  listing.skipped = std::move(rows.skipped);
  for (size_t i = 0; i < rows.lines.size(); ++i) {
    const auto& fields = rows.lines[i].fields;
    const int64_t depth_ns = stamp_of(file, rows.lines[i], 2);
    listing.frames.push_back({rows.stamps_ns[i],
                              depth_ns,
                              {file_of_row(folder, fields[1])},
                              {file_of_row(folder, fields[3])},
                              {},
                              0});
  }
  return listing;
}

}  // namespace

TumListing associate_lists(const std::filesystem::path& folder, const std::string& color_list,
                           const std::string& depth_list) {
  const StampedRows color = read_stamped_rows(folder / color_list, "timestamp colour_file");
  const StampedRows depth = read_stamped_rows(folder / depth_list, "timestamp depth_file");
  TumListing listing;
  listing.skipped = color.skipped;
  listing.skipped.add(depth.skipped);
  const auto files = [&](const StampedRows& rows) {
    std::vector<std::filesystem::path> paths;
    for (const TextLine& line : rows.lines) paths.push_back(file_of_row(folder, line.fields[1]));
    return paths;
  };
  listing.frames = pair_by_time(color.stamps_ns, files(color), depth.stamps_ns, files(depth));
  if (listing.frames.empty()) {
    throw InputError(
        fmt::format("{}: no colour image of {} has a depth image in {} within {} s; check that "
                    "both use the same clock, or write associations.txt",
                    folder.string(), color_list, depth_list, to_seconds(kMaxAssociationNs)));
  }
  return listing;
}

TumListing read_tum_listing(const std::filesystem::path& folder) {
  namespace fs = std::filesystem;
  constexpr bool kCameraKnown = true;  // the caller knows it
  if (!has_tum_lists(folder)) reject_sequence(folder, kCameraKnown);
  if (fs::exists(folder / "associations.txt")) return read_associated(folder);
  return associate_lists(folder, "rgb.txt", "depth.txt");
}

}  // namespace kinloop
