#pragma once

#include "kinloop/output/run_folder.hpp"
#include "kinloop/slam/dense_recorder.hpp"

namespace kinloop {

/// Writes a picture per loop, both images and the matches that agree with it, into the folder's `loops`; of
/// many loops an even choice. Pictures of an earlier run are removed.
void write_loop_pictures(const RunFolder& folder, const Map& map, const PinholeCamera& camera,
                         const DenseRecorder& recorder);

}  // namespace kinloop
