#pragma once
// In: a folder whose layout has no ground truth. Out: the poses in it that may be it, and their convention.

#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "drivers/datasets/recorded_sequence.hpp"
#include "kinloop/sensor/camera/rgbd_camera.hpp"

namespace kinloop {

// In: a folder whose layout has no ground truth. Out: the poses of a file or a folder of files that may be
// it, in the unknown convention of whoever wrote them.

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

// In: poses in an unknown convention, and the images. Out: the convention with which depth agrees between
// frames. Programs differ in the axes of the camera (OpenCV's: y down, looking along z; OpenGL's and ARKit's:
// y up, looking along -z) and in the direction (world from camera, or its inverse, an extrinsic matrix).

struct PoseConvention {
  bool is_inverse = false;  ///< camera from world
  bool has_y_up = false;    ///< OpenGL's axes
  double agreement = 0;     ///< share of depth that agrees between frames
  double next_best = 0;     ///< the same with the best of the others
  bool is_certain = false;  ///< agrees clearly better than all others
};

/// Returns the pose of the camera, in OpenCV's axes.
SE3 to_world_from_camera(const SE3& written, const PoseConvention& convention);

/// A pair of frames and the motion between them, as the poses tell.
struct FramePair {
  size_t first = 0, second = 0;
};

/// Returns up to a dozen pairs spread over the frames with rotations of some degrees between them.
std::vector<FramePair> pairs_for_convention(const WrittenPoses& poses);

/// Returns the convention in which the depth of the first frame of each pair, seen from the second, agrees
/// best with the depth and the brightness there. The images of the pairs come from `sequence`.
PoseConvention find_pose_convention(const WrittenPoses& poses, const RecordedSequence& sequence,
                                    const RgbdCamera& camera);

/// Sets the ground truth of a sequence without one to the poses that lie in its folder, if there are any, in
/// the convention that agrees with its images, and says so.
void find_truth(const std::filesystem::path& folder, const RgbdCamera& camera, RecordedSequence& sequence);

}  // namespace kinloop
