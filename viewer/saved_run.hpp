#pragma once
// Shows what a run left behind: its folder, or any cloud alone.

#include <filesystem>

#include "kinloop/dense/colored_cloud.hpp"
#include "kinloop/geometry/trajectory.hpp"
#include "viewer/options.hpp"
#include "viewer/scene/scene.hpp"

namespace kinloop {

struct SavedRun {
  std::string name;
  ColoredCloud cloud;
  Trajectory path, keyframes, truth;                     ///< each may be empty
  std::vector<std::pair<KeyframeId, KeyframeId>> loops;  ///< indices into `keyframes`
  nlohmann::json figures;                                ///< run.json
  Eigen::Vector3d up = {0, -1, 0};                       ///< in the world
};

/// Reads the folder of a run, of which only trajectory.txt must be there, or a map in PLY. Throws InputError
/// naming what is missing or damaged.
SavedRun read_saved_run(const std::filesystem::path& path);

/// The scene of it.
void show_saved_run(Scene& scene, const SavedRun& run);

}  // namespace kinloop
