#pragma once

#include "apps/dense_recorder.hpp"
#include "kinloop/output/run_folder.hpp"

namespace kinloop {

/// Writes a picture per loop, both images and the landmarks that they share, into the folder's `loops`; of
/// many loops an even choice. Pictures of an earlier run are removed.
void write_loop_pictures(const RunFolder& folder, const Map& map, const DenseRecorder& recorder);

}  // namespace kinloop
