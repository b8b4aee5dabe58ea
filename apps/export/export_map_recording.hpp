#pragma once
// Writes a session of a map as a recording for Foxglove.

#include "session/map_store.hpp"

namespace kinloop {

struct MapRecordingRequest {
  std::filesystem::path file;
  std::string frame;
  size_t session = 0;
  int threads = 1;
};

/// Writes the poses and images of the session, and the cloud of its component.
void export_map_recording(const MapRecordingRequest& request, OpenMap& open, const Progress& progress);

}  // namespace kinloop
