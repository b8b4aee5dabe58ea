#pragma once
// In: a map file, and loops of it that are false. Out: a map file without them, solved again.

#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "kinloop/core/progress.hpp"
#include "kinloop/loop/options.hpp"
#include "kinloop/map/saved_map.hpp"
#include "kinloop/sensor/sensor.hpp"

namespace kinloop {

/// Takes loops out of the map: splits the landmarks and parts the components that only they joined, and
/// solves the pose graph of what remains. A map file does not hold the odometry as it was before a loop bent
/// it, so the relative pose of each edge is measured anew, from the depth of one keyframe and the keypoints
/// of the other. `loops` must be loops of the map.
void withdraw_loops(SavedMap& saved, std::span<const LoopEnds> loops, const Sensor& sensor,
                    const PlaceOptions& options);

struct WithdrawalRequest {
  std::filesystem::path map;       ///< a map file
  std::filesystem::path output;    ///< another file
  std::vector<std::string> loops;  ///< each by the stamps of its keyframes, "12.3,45.6"
};

/// What the new map holds.
struct WithdrawalResult {
  size_t withdrawn_loops = 0, loops = 0, keyframes = 0, components = 0;
};

/// Throws InputError naming the nearest loops if one is not in the map, and UsageError for stamps that are
/// none.
WithdrawalResult withdraw_from_file(const WithdrawalRequest& request, const Progress& progress);

/// Returns the name of a file beside the map that does not exist: of map.kinmap map_withdrawn.kinmap, then
/// map_withdrawn_2.kinmap, also if the map has such a name itself.
std::filesystem::path free_withdrawn_name(const std::filesystem::path& map);

}  // namespace kinloop
