#pragma once
// In: an opened map, which has the images of keyframes, and its recording. Out: the map with images of more
// frames.

#include <filesystem>
#include <string>

#include "kinloop/core/progress.hpp"
#include "session/store/map_store.hpp"

namespace kinloop {

struct RecordedImagesRequest {
  std::filesystem::path map;  ///< named in errors
  std::string recording;      ///< empty: as the map names it
  size_t session = 0;         ///< as of OpenMap::session_log
  size_t count = 0;           ///< of images with a pose
};

/// Reads images of the session's frames, evenly spread over those with a trusted pose, until the map has
/// `count` or all of them. Warns if there are fewer. Throws InputError or UsageError if the recording cannot
/// be read, is of another camera, or has none of the frames.
void add_recorded_images(OpenMap& open, const RecordedImagesRequest& request, const Progress& progress);

}  // namespace kinloop
