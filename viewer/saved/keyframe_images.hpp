#pragma once
// In: a map file. Out: small images of its keyframes, which the page shows at their poses.

#include <cstdint>
#include <filesystem>
#include <vector>

#include "kinloop/geometry/trajectory.hpp"
#include "viewer/scene/scene.hpp"

namespace kinloop {

/// A small colour image of a keyframe.
struct KeyframeImage {
  uint32_t keyframe = 0;  ///< index into the shown keyframes
  std::vector<uint8_t> jpeg;
};

/// How many images are wanted, and how large.
struct KeyframeImageOptions {
  size_t most = 500;
  int width_px = 320;
  int quality = 80;  ///< of JPEG, 1 to 100
};

/// Reads the images of those `keyframes`, in the order of their stamps, that the map file has; of a long run
/// evenly chosen ones. Leaves out damaged images. Throws InputError if the file is not a map.
std::vector<KeyframeImage> read_keyframe_images(const std::filesystem::path& map_file,
                                                const Trajectory& keyframes,
                                                const KeyframeImageOptions& options = {});

/// Reads the images of a map file, or of a run's folder that may hold one. None, with a warning, if the map
/// is damaged: all else can be shown.
std::vector<KeyframeImage> keyframe_images_of(const std::filesystem::path& shown, const Trajectory& keyframes,
                                              const KeyframeImageOptions& options = {});

/// Returns them as they are sent.
std::vector<EncodedPart> encode_keyframe_images(std::vector<KeyframeImage> images);

}  // namespace kinloop
