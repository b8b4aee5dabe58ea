#pragma once
// Shows what a run left behind: its folder, or any cloud or mesh alone.

#include <filesystem>
#include <string>

#include "kinloop/dense/mesh/colored_mesh.hpp"
#include "kinloop/geometry/trajectory.hpp"
#include "viewer/options.hpp"
#include "viewer/scene/scene.hpp"

namespace kinloop {

struct SavedRun {
  std::string name;
  ColoredCloud cloud;
  Trajectory path, keyframes, truth;                     ///< each may be empty
  std::vector<std::pair<KeyframeId, KeyframeId>> loops;  ///< indices into `keyframes`
  nlohmann::json metrics;                                ///< run.json
  Eigen::Vector3d up = {0, -1, 0};                       ///< in the world

  // What a file alone may hold instead.
  ColoredMesh mesh;
  std::string model;     ///< the bytes of a GLB file
  bool colored = true;   ///< whether the points have colours
  bool up_known = true;  ///< else `up` is a guess
};

/// Reads the folder of a run, of which only trajectory.txt must be there, or a file: PLY, PCD or GLB. Throws
/// InputError naming what is missing or damaged.
SavedRun read_saved_run(const std::filesystem::path& path);

/// The scene of it.
void show_saved_run(Scene& scene, const SavedRun& run);

}  // namespace kinloop
