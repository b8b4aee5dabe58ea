#pragma once
// In: an opened map. Out: its images with their cameras and points, for COLMAP and Nerfstudio.

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

/// Either folder may be empty (not requested); both may be the same.
struct SparseModelRequest {
  std::filesystem::path map;  ///< named in errors
  std::filesystem::path colmap, nerfstudio;
  size_t session = 0;
  int threads = 1;
  size_t images = 0;      ///< at least so many, from the recording if the map has fewer; 0: those of the map
  size_t points = 0;      ///< of the cloud, in addition to the landmarks
  std::string recording;  ///< empty: as the map names it
};

/// Writes images and model into the folders, in the frame of `file` and with points of its cloud. Adds images
/// of the recording to the map. Throws InputError if the map has no images with known poses, or
/// as `add_recorded_images` does.
void export_sparse_model(const SparseModelRequest& request, const FileCloud& file, OpenMap& open,
                         const Progress& progress);

}  // namespace kinloop
