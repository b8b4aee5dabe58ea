#pragma once
// In: a folder whose layout has no ground truth. Out: the poses of a file or a folder of files that may be
// it, in the unknown convention of whoever wrote them.

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "drivers/datasets/recorded_sequence.hpp"

namespace kinloop {

/// Poses as they stand in the files: of the camera or its inverse, with any axes.
struct WrittenPoses {
  std::string name;                        ///< of the file or folder, for users
  std::vector<std::optional<SE3>> frames;  ///< one for each frame of the sequence; nullopt: not known
};

/// Looks for poses.txt, traj.txt and the like (a pose per line: 12 or 16 numbers of a matrix, tx ty tz qx qy
/// qz qw, or those after a time stamp; or matrices of four lines), and for pose/, poses/ and the like with a
/// matrix in a file for each frame. A file whose poses cannot belong to the frames is left out with a
/// warning.
std::optional<WrittenPoses> find_written_poses(const std::filesystem::path& folder,
                                               const RecordedSequence& sequence);

}  // namespace kinloop
