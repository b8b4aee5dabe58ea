#pragma once
// In: trajectories in one frame. Out: an SVG picture of them from above.

#include <string>
#include <vector>

#include "kinloop/geometry/trajectory.hpp"

namespace kinloop {

/// A trajectory and how it is drawn.
struct DrawnPath {
  std::string name;
  std::string color;  ///< as in CSS
  Trajectory path;    ///< T_world_camera; all in one frame
};

/// Returns the picture: the two axes in which the first path extends most, a scale bar and the names.
std::string trajectory_picture(const std::vector<DrawnPath>& paths);

}  // namespace kinloop
