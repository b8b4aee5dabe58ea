#include "drivers/datasets/reading/lists/tum_listing.hpp"

#include <algorithm>
#include <set>
#include <string>

#include <fmt/format.h>

#include "drivers/datasets/reading/lists/image_pairs.hpp"
#include "drivers/datasets/reading/lists/pair_images.hpp"
#include "drivers/datasets/sequence_layout.hpp"
#include "kinloop/core/association.hpp"
#include "kinloop/core/errors.hpp"
#include "kinloop/core/files/text_file.hpp"
#include "kinloop/core/log.hpp"
#include "kinloop/core/time_unit.hpp"

namespace kinloop {
namespace {

/// The rows of a text file whose first column is a time stamp, and the rows skipped.
struct StampedRows {
  std::vector<int64_t> stamps_ns;
  std::vector<TextLine> lines;
  std::vector<int64_t> second_stamps_ns;  ///< of the third column, if there is one
  SkippedFrames skipped;
  const char* unit = kSecondsUnit.name;
};

/// The times of a column, in seconds or another unit that all its numbers tell.
FoundTimes times_of_column(const std::filesystem::path& file, const std::vector<TextLine>& lines,
                           size_t column) {
  std::vector<std::string> texts;
  for (const TextLine& line : lines) texts.push_back(line.fields[column]);
  if (auto times = times_not_in_seconds(texts)) return *times;
  FoundTimes times{{}, kSecondsUnit};
  for (const TextLine& line : lines) {
    const auto stamp_ns = parse_stamp_ns(line.fields[column]);
    if (!stamp_ns) {
      throw_parse_error(
          file, line.number,
          fmt::format("'{}' is not a timestamp in seconds; correct or delete the line", line.fields[column]));
    }
    times.stamps_ns.push_back(*stamp_ns);
  }
  return times;
}

void require_columns(const std::filesystem::path& file, const TextLine& line, const std::string& columns) {
  const size_t expected = static_cast<size_t>(std::count(columns.begin(), columns.end(), ' ')) + 1;
  if (line.fields.size() == expected) return;
  const char* blanks = line.fields.size() > expected ? "; names of files must not have blanks" : "";
  throw_parse_error(file, line.number,
                    fmt::format("expected '{}' separated by blanks, found {} fields{}", columns,
                                line.fields.size(), blanks));
}

/// The file of a row. Lists that were written on Windows may have backslashes.
std::filesystem::path file_of_row(const std::filesystem::path& folder, std::string name) {
  std::error_code ignored;
  if (name.find('\\') != std::string::npos && !std::filesystem::exists(folder / name, ignored))
    std::replace(name.begin(), name.end(), '\\', '/');
  return folder / name;
}

/// Without rows that are the same as an earlier one: a driver that publishes each image twice loses none.
std::vector<TextLine> without_repeated_lines(const std::filesystem::path& file, std::vector<TextLine> lines) {
  std::set<std::vector<std::string>> seen;
  std::vector<TextLine> kept;
  for (TextLine& line : lines) {
    if (seen.insert(line.fields).second) kept.push_back(std::move(line));
  }
  if (kept.size() < lines.size())
    log::info("{}: {} of {} lines repeat an earlier one and are not used", file.string(),
              lines.size() - kept.size(), lines.size());
  return kept;
}

/// Reads rows with increasing time stamps. `columns` names the columns, separated by blanks.
StampedRows read_stamped_rows(const std::filesystem::path& file, const std::string& columns) {
  constexpr size_t kMaxDisorder = 2;  // tolerates one row out of order in this many
  constexpr size_t kSecondStamp = 2;
  auto lines = without_repeated_lines(file, read_table(file));
  const size_t count = lines.size();
  if (count == 0) throw InputError(fmt::format("{}: empty; expected lines '{}'", file.string(), columns));
  for (const TextLine& line : lines) require_columns(file, line, columns);
  const FoundTimes times = times_of_column(file, lines, 0);
  FoundTimes second;
  if (lines.front().fields.size() > kSecondStamp) second = times_of_column(file, lines, kSecondStamp);
  StampedRows rows;
  rows.unit = times.unit.name;
  size_t first_skipped_line = 0;
  for (size_t i = 0; i < count; ++i) {
    TextLine& line = lines[i];
    const int64_t stamp_ns = times.stamps_ns[i];
    if (rows.stamps_ns.empty() || stamp_ns > rows.stamps_ns.back()) {
      rows.stamps_ns.push_back(stamp_ns);
      if (!second.stamps_ns.empty()) rows.second_stamps_ns.push_back(second.stamps_ns[i]);
      rows.lines.push_back(std::move(line));
      continue;
    }
    if (rows.skipped.empty()) first_skipped_line = line.number;
    const char* what = stamp_ns == rows.stamps_ns.back() ? "repeats" : "is earlier than";
    rows.skipped.add(
        {line.fields[1], fmt::format("{}:{}: timestamp {} {} that of line {}", file.string(), line.number,
                                     line.fields[0], what, rows.lines.back().number)});
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
    const int64_t color_ns = rows.stamps_ns[i], depth_ns = rows.second_stamps_ns[i];
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
  if (rows.unit != kSecondsUnit.name) listing.pairing.times = fmt::format("times are in {}", rows.unit);
  for (size_t i = 0; i < rows.lines.size(); ++i) {
    const auto& fields = rows.lines[i].fields;
    listing.frames.push_back({rows.stamps_ns[i],
                              rows.second_stamps_ns[i],
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
  const auto color_files = files(color), depth_files = files(depth);
  listing.frames = pair_by_time(color.stamps_ns, color_files, depth.stamps_ns, depth_files);
  if (listing.frames.empty()) {
    throw InputError(
        fmt::format("{}: no colour image of {} has a depth image in {} within {} s; check that "
                    "both use the same clock, or write associations.txt",
                    folder.string(), color_list, depth_list, to_seconds(kMaxAssociationNs)));
  }
  listing.pairing = pairing_of(listing.frames, color_files, depth_files);
  listing.pairing.rule = nearest_time_rule();
  if (color.unit != kSecondsUnit.name || depth.unit != kSecondsUnit.name)
    listing.pairing.times =
        fmt::format("times are in {} ({}) and {} ({})", color.unit, color_list, depth.unit, depth_list);
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
