#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>

#include <fmt/format.h>

#include "kinloop/core/text/lower_case.hpp"
#include "tools/evaluation/trajectory_files/columns.hpp"

namespace kinloop {
namespace {

constexpr size_t kTumFields = 8;

/// What is left of a column's name without unit and punctuation: "p_RS_R_x [m]" becomes "prsrx".
std::string plain_name(const std::string& name) {
  std::string plain;
  for (const char c : lower_case(name.substr(0, name.find('[')))) {
    if (std::isalnum(static_cast<unsigned char>(c)) != 0) plain += c;
  }
  return plain;
}

bool contains(const std::string& text, std::initializer_list<const char*> parts) {
  return std::any_of(parts.begin(), parts.end(),
                     [&](const char* part) { return text.find(part) != std::string::npos; });
}

bool is_quaternion(const std::string& name) {
  return name[0] == 'q' || contains(name, {"orientation", "quat", "rotation", "rot"});
}

bool is_position(const std::string& name) {
  return name.size() == 1 || name[0] == 't' || name[0] == 'p' || contains(name, {"position", "translation"});
}

/// Columns that are filled in as their names are found.
struct NamedColumns {
  std::optional<size_t> stamp, nanoseconds;
  std::array<std::optional<size_t>, 3> translation;
  std::array<std::optional<size_t>, 4> quaternion;

  void add(const std::string& name, size_t column) {
    const auto set = [&](std::optional<size_t>& found) {
      if (!found) found = column;
    };
    const size_t axis = std::string("xyzw").find(name.back());
    if (axis != std::string::npos && is_quaternion(name)) return set(quaternion[axis]);
    if (axis < 3 && is_position(name)) return set(translation[axis]);
    if (name.ends_with("nanosec") || name.ends_with("nanosecs") || name.ends_with("nsecs"))
      return set(nanoseconds);
    if (contains(name, {"time", "stamp", "sec"}) || name == "t" || name == "ns") set(stamp);
  }

  [[nodiscard]] bool is_complete() const {
    const auto is_set = [](const auto& found) { return found.has_value(); };
    return stamp && std::all_of(translation.begin(), translation.end(), is_set) &&
           std::all_of(quaternion.begin(), quaternion.end(), is_set);
  }
};

std::optional<PoseColumns> columns_by_name(const NumberTable& table) {
  NamedColumns named;
  for (size_t i = 0; i < table.names.size(); ++i) {
    const std::string name = plain_name(table.names[i]);
    if (!name.empty()) named.add(name, i);
  }
  if (!named.is_complete()) return std::nullopt;
  PoseColumns columns;
  columns.stamp = *named.stamp;
  columns.nanoseconds = named.nanoseconds;
  for (size_t i = 0; i < 3; ++i) columns.translation[i] = *named.translation[i];
  for (size_t i = 0; i < 4; ++i) columns.quaternion[i] = *named.quaternion[i];
  columns.knows_order = true;
  columns.format = table.has_commas ? TrajectoryFormat::kCsv : TrajectoryFormat::kTum;
  if (table.has_commas) columns.note = "columns are those that the first line names";
  return columns;
}

std::optional<double> number_in(const TextLine& row, size_t column) {
  if (column >= row.fields.size()) return std::nullopt;
  const std::string& text = row.fields[column];
  double value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  return error == std::errc() ? std::optional(value) : std::nullopt;
}

/// Whether almost all rows have a unit quaternion in the four columns from `first`; those of NaN do not
/// count.
bool holds_unit_quaternions(const NumberTable& table, size_t first) {
  constexpr double kNormTolerance = 1e-2, kShare = 0.95;
  size_t units = 0, known = 0;
  for (const TextLine& row : table.rows) {
    double squared = 0;
    for (size_t i = 0; i < 4; ++i) squared += std::pow(number_in(row, first + i).value_or(2), 2);
    if (std::isnan(squared)) continue;
    ++known;
    if (std::abs(std::sqrt(squared) - 1) < kNormTolerance) ++units;
  }
  return static_cast<double>(units) >= kShare * static_cast<double>(known);
}

/// Whether the first pose is the identity, w first. Estimates begin there; x y z w would be half a turn.
bool begins_with_identity_w_first(const NumberTable& table, size_t first) {
  constexpr double kTolerance = 1e-6;
  const TextLine& row = table.rows.front();
  for (size_t i = 0; i < 4; ++i) {
    const double difference = std::abs(std::abs(number_in(row, first + i).value_or(2)) - (i == 0 ? 1 : 0));
    if (!(difference <= kTolerance)) return false;  // also of NaN
  }
  return true;
}

/// Lines "stamp tx ty tz q" or "stamp q tx ty tz".
PoseColumns columns_by_content(const NumberTable& table) {
  PoseColumns columns;
  const bool quaternion_first = !holds_unit_quaternions(table, 4) && holds_unit_quaternions(table, 1);
  const size_t t = quaternion_first ? 5 : 1, q = quaternion_first ? 1 : 4;
  columns.translation = {t, t + 1, t + 2};
  columns.quaternion = {q, q + 1, q + 2, q + 3};
  const bool w_first = begins_with_identity_w_first(table, q);
  if (w_first) columns.quaternion = {q + 1, q + 2, q + 3, q};
  columns.knows_order = w_first;
  if (quaternion_first || w_first) {
    const char* order = w_first ? "qw qx qy qz" : "qx qy qz qw";
    columns.note = quaternion_first ? fmt::format("columns are taken as timestamp {} tx ty tz", order)
                                    : fmt::format("columns are taken as timestamp tx ty tz {}", order);
  }
  return columns;
}

/// Whether the first field of the first row is a whole number of nanoseconds of Unix time.
bool begins_with_nanoseconds(const NumberTable& table) {
  constexpr double kEarliestNs = 1e17;  // 1973
  return number_in(table.rows.front(), 0).value_or(0) > kEarliestNs;
}

}  // namespace

size_t PoseColumns::width() const {
  size_t last = std::max(stamp, nanoseconds.value_or(0));
  for (const size_t column : translation) last = std::max(last, column);
  for (const size_t column : quaternion) last = std::max(last, column);
  return last + 1;
}

PoseColumns find_pose_columns(const NumberTable& table, const std::filesystem::path& path) {
  const TextLine& first = table.rows.front();
  const size_t fields = first.fields.size();
  if (auto named = columns_by_name(table); named && named->width() <= fields) return *named;
  if (fields == 12 || fields == 16) {
    PoseColumns columns;
    columns.format = TrajectoryFormat::kKitti;
    return columns;
  }
  if (table.has_commas && fields >= kTumFields && begins_with_nanoseconds(table)) {
    PoseColumns columns;
    columns.format = TrajectoryFormat::kEuroc;
    columns.translation = {1, 2, 3};
    columns.quaternion = {5, 6, 7, 4};
    columns.knows_order = true;
    columns.note = "EuRoC format: timestamp in ns, tx, ty, tz, qw, qx, qy, qz";
    return columns;
  }
  if (fields != kTumFields) {
    throw_parse_error(
        path, first.number,
        fmt::format("expected 'timestamp tx ty tz qx qy qz qw' (TUM format), 12 numbers (KITTI), EuRoC "
                    "format or a first line with the names of the columns, found {} fields",
                    fields));
  }
  return columns_by_content(table);
}

}  // namespace kinloop
