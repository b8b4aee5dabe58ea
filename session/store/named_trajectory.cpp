#include "session/store/named_trajectory.hpp"

#include <array>
#include <optional>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "drivers/archives/unpacked_archive.hpp"
#include "kinloop/core/errors.hpp"
#include "session/source/open_frame_source.hpp"

namespace kinloop {
namespace {

namespace fs = std::filesystem;

// Of kinloop, ORB-SLAM and the tools of rpg; of a run and TUM, EuRoC.
constexpr std::array kEstimates = {"trajectory.txt", "CameraTrajectory.txt", "stamped_traj_estimate.txt",
                                   "poses.txt", "traj.txt"};
constexpr std::array kEurocTruths = {"mav0/state_groundtruth_estimate0/data.csv",
                                     "state_groundtruth_estimate0/data.csv"};
constexpr const char* kTruth = "groundtruth.txt";

template <class Names>
std::optional<fs::path> first_in(const fs::path& folder, const Names& names) {
  for (const char* name : names) {
    std::error_code unknown;
    if (fs::is_regular_file(folder / name, unknown)) return folder / name;
  }
  return std::nullopt;
}

bool is_folder(const fs::path& path) {
  std::error_code unknown;
  return fs::is_directory(path, unknown);
}

}  // namespace

std::vector<fs::path> trajectories_in(const fs::path& folder) {
  std::vector<fs::path> files = {folder / kTruth};
  for (const char* name : kEstimates) files.push_back(folder / name);
  for (const char* name : kEurocTruths) files.push_back(folder / name);
  return files;
}

TrajectoryFile open_estimate(const fs::path& path) {
  if (!is_folder(path)) return read_trajectory_file(path);
  if (const auto file = first_in(path, kEstimates)) return read_trajectory_file(*file);
  throw InputError(fmt::format("{}: holds no trajectory (looked for {}); give the file", path.string(),
                               fmt::join(kEstimates, ", ")));
}

TrajectoryFile open_ground_truth(const fs::path& path) {
  if (!is_folder(path) && !archive_of(path)) return read_trajectory_file(path);
  if (const auto file = first_in(path, kEurocTruths)) return read_trajectory_file(*file);
  const auto file = first_in(path, std::array{kTruth});
  if (file && fs::exists(path / "run.json")) return read_trajectory_file(*file);
  try {
    SourceRequest request;
    request.sequence = path.string();
    TrajectoryFile truth{.poses = open_frame_source(request)->info().ground_truth,
                         .knows_quaternion_order = true};
    if (!truth.poses.empty()) return truth;
  } catch (const InputError&) {  // its images may be elsewhere
    if (!file) throw;
  }
  if (file) return read_trajectory_file(*file);
  throw InputError(fmt::format("{}: holds no ground truth; give the file", path.string()));
}

}  // namespace kinloop
