#pragma once

#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "kinloop/io/run_folder.hpp"
#include "kinloop/sensor/source/frame_source.hpp"
#include "session/store/dense_recorder.hpp"

namespace kinloop {

/// A picture of a loop, with measurements.
struct LoopPicture {
  std::string file;                        ///< in the folder of the pictures
  int64_t stamp_a_ns = 0, stamp_b_ns = 0;  ///< of its two images, the older first
  int reprojected = 0;                     ///< landmarks of the first image that project into the second
  int observed = 0;                        ///< of these, landmarks also observed in the second
  double median_error_px = 0;              ///< of these, distance between projection and keypoint
  double distance_m = 0, angle_deg = 0;    ///< between the two cameras
  int inliers = 0;                         ///< of the loop itself
};

/// Writes a picture per loop into the folder's `loops`, with loops.json: the two keyframes around the loop
/// with the largest overlap, and the landmarks of the first reprojected into the second with the final poses.
/// Of many loops, evenly spaced ones. Removes pictures of an earlier run.
void write_loop_pictures(const RunFolder& folder, const Slam& slam, const DenseRecorder& recorder);

/// Reads the index loops.json; empty if the folder has none. Leaves out what is not a JPEG image in the
/// folder itself. Throws InputError naming the index if it is damaged.
std::vector<LoopPicture> read_loop_pictures(const RunFolder& folder);

}  // namespace kinloop
