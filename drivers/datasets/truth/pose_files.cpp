#include <algorithm>
#include <array>
#include <map>

#include <fmt/format.h>

#include "drivers/datasets/reading/lists/image_pairs.hpp"
#include "drivers/datasets/reading/matrix_text.hpp"
#include "drivers/datasets/truth/truth.hpp"
#include "kinloop/core/association.hpp"
#include "kinloop/core/errors.hpp"
#include "kinloop/core/files/text_file.hpp"
#include "kinloop/core/log.hpp"
#include "kinloop/geometry/ground_truth.hpp"

namespace kinloop {
namespace {

namespace fs = std::filesystem;

constexpr std::array kPoseFiles = {"groundtruth.txt", "poses.txt", "pose.txt",         "traj.txt",
                                   "traj_w_c.txt",    "gt.txt",    "camera_poses.txt", "poses_gt.txt"};
constexpr std::array kPoseFolders = {"pose", "poses", "camera_poses", "extrinsic", "extrinsics"};

constexpr size_t kRowFields = 4, kPoseFields = 7, kStampedFields = 8, kThreeRows = 12, kMatrixFields = 16;

using PoseList = std::vector<std::optional<SE3>>;

/// Matrices that are not rigid mark frames without a pose.
std::optional<SE3> written_pose(const std::vector<double>& numbers) {
  if (numbers.size() == kPoseFields) return motion_of(numbers);
  const auto matrix = matrix_of(numbers);
  return matrix ? rigid_motion(*matrix) : std::nullopt;
}

/// The numbers of a file, of which each line has as many.
struct NumberRows {
  size_t fields = 0;            ///< of a line; 0: there is none
  size_t first_line = 0;        ///< from 1
  std::vector<double> numbers;  ///< none of lines with a stamp
};

NumberRows read_rows(const fs::path& file) {
  constexpr std::array kKnown = {kRowFields, kPoseFields, kStampedFields, kThreeRows, kMatrixFields};
  NumberRows rows;
  visit_table(file, [&](const TextLine& line) {
    if (rows.fields == 0) rows.fields = line.fields.size(), rows.first_line = line.number;
    if (std::find(kKnown.begin(), kKnown.end(), rows.fields) == kKnown.end())
      throw_parse_error(file, line.number, "neither a matrix nor a position and a quaternion");
    if (rows.fields == kStampedFields) return;
    if (line.fields.size() != rows.fields)
      throw_parse_error(file, line.number, fmt::format("expected {} numbers", rows.fields));
    for (const std::string& field : line.fields)
      rows.numbers.push_back(parse_double(field, file, line.number));
  });
  return rows;
}

/// A pose in each line, or in each four lines.
PoseList poses_in(const NumberRows& rows, const fs::path& file) {
  const size_t numbers = rows.fields == kRowFields ? kMatrixFields : rows.fields;
  if (rows.numbers.size() % numbers != 0)
    throw_parse_error(file, rows.first_line, "neither a matrix nor a position and a quaternion");
  PoseList poses;
  for (auto pose = rows.numbers.begin(); pose != rows.numbers.end(); pose += static_cast<ptrdiff_t>(numbers))
    poses.push_back(written_pose({pose, pose + static_cast<ptrdiff_t>(numbers)}));
  return poses;
}

/// The pose nearest in time to each frame.
PoseList poses_by_time(const fs::path& file, const RecordedSequence& sequence) {
  const Trajectory trajectory = sorted_by_time(read_ground_truth(file));
  std::vector<int64_t> frames_ns, poses_ns;
  for (const RecordedFrame& frame : sequence.frames) frames_ns.push_back(frame.stamp_ns);
  for (const StampedPose& pose : trajectory) poses_ns.push_back(pose.stamp_ns);
  PoseList poses(sequence.frames.size());
  for (const auto& [frame, pose] : associate_stamps(frames_ns, poses_ns))
    poses[frame] = trajectory[pose].T_world_camera;
  return poses;
}

/// The number of a frame in the names of its images; nullopt if there is none.
std::optional<size_t> number_of(const RecordedFrame& frame) {
  const std::string stem = frame.color.file.stem().string();
  const size_t end = stem.find_last_of("0123456789");
  if (end == std::string::npos) return std::nullopt;
  const size_t before = stem.find_last_not_of("0123456789", end);
  const size_t begin = before == std::string::npos ? 0 : before + 1;
  constexpr size_t kMostDigits = 9;
  if (end + 1 - begin > kMostDigits) return std::nullopt;
  return std::stoul(stem.substr(begin, end + 1 - begin));
}

/// In the order of the frames if there are as many, else by their numbers from 0.
PoseList of_frames(const PoseList& poses, const RecordedSequence& sequence, const fs::path& file) {
  if (poses.size() == sequence.frames.size()) return poses;
  PoseList found;
  for (const RecordedFrame& frame : sequence.frames) {
    const auto number = number_of(frame);
    if (!number || *number >= poses.size()) {
      throw InputError(
          fmt::format("{}: {} poses for {} frames", file.string(), poses.size(), sequence.frames.size()));
    }
    found.push_back(poses[*number]);
  }
  return found;
}

PoseList read_pose_file(const fs::path& file, const RecordedSequence& sequence) {
  const NumberRows rows = read_rows(file);
  if (rows.fields == 0) throw InputError(fmt::format("{}: has no poses", file.string()));
  const bool stamped = rows.fields == kStampedFields;
  if (stamped && sequence.stamps_measured) return poses_by_time(file, sequence);
  if (!stamped) return of_frames(poses_in(rows, file), sequence, file);
  PoseList poses;
  for (const StampedPose& pose : read_tum_trajectory(file)) poses.push_back(pose.T_world_camera);
  return of_frames(poses, sequence, file);
}

/// The file of the stem of the colour image, else of its number.
PoseList read_pose_folder(const fs::path& folder, const RecordedSequence& sequence) {
  std::map<size_t, fs::path> by_number;
  for (const fs::path& file : images_in(folder, [](const fs::path& f) { return f.extension() == ".txt"; })) {
    RecordedFrame named;
    named.color.file = file;
    if (const auto number = number_of(named)) by_number.emplace(*number, file);
  }
  PoseList poses;
  for (const RecordedFrame& frame : sequence.frames) {
    const auto number = number_of(frame);
    const auto found = number ? by_number.find(*number) : by_number.end();
    poses.emplace_back();
    if (found == by_number.end()) continue;
    const auto numbers = read_numbers(found->second);
    poses.back() = written_pose(numbers);
  }
  return poses;
}

size_t known_in(const PoseList& poses) {
  return static_cast<size_t>(
      std::count_if(poses.begin(), poses.end(), [](const auto& T) { return T.has_value(); }));
}

using ReadPoses = PoseList (*)(const fs::path& path, const RecordedSequence& sequence);

std::optional<WrittenPoses> try_poses(const fs::path& path, const RecordedSequence& sequence,
                                      ReadPoses read) {
  constexpr size_t kFewest = 2;
  try {
    PoseList poses = read(path, sequence);
    if (known_in(poses) >= kFewest) return WrittenPoses{path.filename().string(), std::move(poses)};
    log::warn("{}: not used as ground truth: {} of {} frames have a pose", path.string(), known_in(poses),
              poses.size());
  } catch (const InputError& error) {
    log::warn("not used as ground truth: {}", error.what());
  }
  return std::nullopt;
}

}  // namespace

std::optional<WrittenPoses> find_written_poses(const fs::path& folder, const RecordedSequence& sequence) {
  std::error_code absent;
  for (const char* name : kPoseFiles) {
    if (!fs::is_regular_file(folder / name, absent)) continue;
    if (auto poses = try_poses(folder / name, sequence, read_pose_file)) return poses;
  }
  for (const char* name : kPoseFolders) {
    if (!fs::is_directory(folder / name, absent)) continue;
    if (auto poses = try_poses(folder / name, sequence, read_pose_folder)) return poses;
  }
  return std::nullopt;
}

}  // namespace kinloop
