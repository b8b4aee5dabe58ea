#pragma once
// In: what a run left behind. Out: one HTML page that needs nothing else: no network, no other file.

#include <string>

#include <nlohmann/json.hpp>

#include "kinloop/geometry/trajectory.hpp"

namespace kinloop {

/// What the page shows; parts that are empty are left out.
///
/// Of run.json it reads, where they are there: "input", "version", "frames", "tracked", "keyframes",
/// "landmarks", "wall_s", "peak_memory_mib", "frame_ms" {"median", "p95"}, "map" {"points", "voxel_m"},
/// "loops" [{"stamp_a", "stamp_b", "inliers"}], "rooms" {name: {"wall_s", "cpu_s"}}, "options" {key: value},
/// "evaluation" as `to_json`.
struct RunReport {
  nlohmann::json figures;  ///< run.json
  Trajectory estimate;
  Trajectory keyframes;
  Trajectory truth;
  std::string map_picture_png;  ///< the bytes of a PNG file: the map at a slant
  std::string map_top_png;      ///< from straight above
};

/// The page.
std::string render_report(const RunReport& report);

}  // namespace kinloop
