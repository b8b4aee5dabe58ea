#pragma once
// In: a trajectory that is said to be true. Out: its poses, without the lines that are none.

#include <filesystem>

#include "kinloop/geometry/trajectory.hpp"

namespace kinloop {

/// The same of a ground truth, in which lines of NaN, or with a quaternion of zeros, are no poses: motion
/// capture writes them where it lost the camera. Says how many there are.
Trajectory read_ground_truth(const std::filesystem::path& path);

}  // namespace kinloop
