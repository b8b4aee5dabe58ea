#include "tools/evaluation/trajectory_files/trajectory_file.hpp"

#include <algorithm>
#include <array>

#include <Eigen/LU>
#include <fmt/format.h>

#include "kinloop/core/errors.hpp"
#include "kinloop/core/text/lower_case.hpp"
#include "kinloop/core/time.hpp"
#include "tools/evaluation/trajectory_files/columns.hpp"

namespace kinloop {
namespace {

namespace fs = std::filesystem;

/// The pose of a row of 12 or 16 numbers, a matrix by rows.
SE3 parse_matrix(const TextLine& row, const fs::path& path) {
  Eigen::Matrix<double, 3, 4, Eigen::RowMajor> matrix;
  for (int i = 0; i < matrix.size(); ++i)
    matrix.data()[i] = parse_double(row.fields[static_cast<size_t>(i)], path, row.number);
  constexpr double kTolerance = 1e-2;
  const Eigen::Matrix3d R = matrix.leftCols<3>();
  if (!(R * R.transpose()).isIdentity(kTolerance) || R.determinant() < 0)
    throw_parse_error(path, row.number,
                      "the matrix is not a rotation beside a translation; correct the line");
  return {Eigen::Quaterniond(R).normalized(), matrix.col(3)};
}

SE3 parse_pose(const TextLine& row, const PoseColumns& columns, const fs::path& path) {
  const auto number = [&](size_t column) { return parse_double(row.fields[column], path, row.number); };
  const auto& t = columns.translation;
  const auto& q = columns.quaternion;
  const Eigen::Quaterniond rotation(number(q[3]), number(q[0]), number(q[1]), number(q[2]));
  constexpr double kMinNorm = 1e-6;
  if (rotation.norm() < kMinNorm)
    throw_parse_error(path, row.number, "the quaternion is zero; correct or delete the line");
  return {rotation.normalized(), {number(t[0]), number(t[1]), number(t[2])}};
}

void require_fields(const TextLine& row, size_t at_least, size_t at_most, const fs::path& path) {
  const size_t found = row.fields.size();
  if (found >= at_least && found <= at_most) return;
  throw_parse_error(
      path, row.number,
      fmt::format("{} fields where the first line has {}; correct or delete the line", found, at_most));
}

/// Motion capture writes rows of NaN where it lost the camera: they are no poses.
bool has_pose(const TextLine& row, const PoseColumns& columns) {
  const auto is_nan = [&](size_t column) {
    const std::string text = lower_case(row.fields[column]);
    return text == "nan" || text == "-nan" || text == "+nan";
  };
  return std::none_of(columns.translation.begin(), columns.translation.end(), is_nan) &&
         std::none_of(columns.quaternion.begin(), columns.quaternion.end(), is_nan);
}

/// Stamps as text; those in two columns are joined.
std::vector<StampText> stamp_texts(const NumberTable& table, const PoseColumns& columns) {
  std::vector<StampText> texts;
  for (const TextLine& row : table.rows) {
    std::string text = row.fields[columns.stamp];
    if (columns.nanoseconds) text = fmt::format("{}.{:0>9}", text, row.fields[*columns.nanoseconds]);
    texts.push_back({row.number, text});
  }
  return texts;
}

/// The stamps of a file times.txt beside `path`, as KITTI has it; empty if it is not there or of another
/// length.
std::vector<StampText> times_beside(const fs::path& path, size_t count) {
  const fs::path times = path.parent_path() / "times.txt";
  std::error_code unknown;
  if (!fs::is_regular_file(times, unknown) || fs::equivalent(times, path, unknown)) return {};
  std::vector<StampText> texts;
  for (const TextLine& row : read_table(times)) texts.push_back({row.number, row.fields[0]});
  return texts.size() == count ? texts : std::vector<StampText>();
}

void add_note(TrajectoryFile& file, const std::string& note) {
  if (!note.empty()) file.notes.push_back(note);
}

void set_stamps(TrajectoryFile& file, const std::vector<StampText>& texts, const fs::path& path) {
  const StampColumn column = parse_stamps(texts, path);
  for (size_t i = 0; i < file.poses.size(); ++i) file.poses[i].stamp_ns = column.stamps_ns[i];
  add_note(file, column.note);
  add_note(file, check_order(column.stamps_ns, texts, path));
  std::stable_sort(file.poses.begin(), file.poses.end(),
                   [](const auto& a, const auto& b) { return a.stamp_ns < b.stamp_ns; });
}

void read_matrices(TrajectoryFile& file, const NumberTable& table, const fs::path& path) {
  const size_t fields = table.rows.front().fields.size();
  for (const TextLine& row : table.rows) {
    require_fields(row, fields, fields, path);
    file.poses.push_back(
        {static_cast<int64_t>(file.poses.size()) * kNumberedStepNs, parse_matrix(row, path)});
  }
  file.knows_quaternion_order = true;
  const auto texts = times_beside(path, file.poses.size());
  file.has_stamps = !texts.empty();
  if (file.has_stamps) set_stamps(file, texts, path.parent_path() / "times.txt");
  add_note(file, file.has_stamps ? "KITTI format, with the time stamps of times.txt beside it"
                                 : "KITTI format, which has no time stamps: poses are numbered");
}

}  // namespace

TrajectoryFile read_trajectory_file(const fs::path& path) {
  NumberTable table = read_number_table(path);
  const PoseColumns columns = find_pose_columns(table, path);
  TrajectoryFile file;
  file.format = columns.format;
  if (columns.format == TrajectoryFormat::kKitti) {
    read_matrices(file, table, path);
    return file;
  }
  const size_t first_fields = table.rows.front().fields.size();
  for (const TextLine& row : table.rows) require_fields(row, columns.width(), first_fields, path);
  const size_t without_pose =
      std::erase_if(table.rows, [&](const TextLine& row) { return !has_pose(row, columns); });
  if (table.rows.empty()) throw InputError(fmt::format("{}: all poses are NaN", path.string()));
  if (without_pose > 0) add_note(file, fmt::format("{} lines of NaN, which are no poses", without_pose));
  for (const TextLine& row : table.rows) file.poses.push_back({0, parse_pose(row, columns, path)});
  file.knows_quaternion_order = columns.knows_order;
  add_note(file, columns.note);
  set_stamps(file, stamp_texts(table, columns), path);
  return file;
}

}  // namespace kinloop
