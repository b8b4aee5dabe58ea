#pragma once
// Writes the files of a run.

#include <optional>

#include <nlohmann/json.hpp>

#include "apps/run/run_summary.hpp"
#include "kinloop/geometry/trajectory.hpp"
#include "kinloop/io/run_folder.hpp"
#include "session/session.hpp"
#include "viewer/report/frame_table.hpp"

namespace kinloop {

/// What the files of a run are made of.
struct RunContents {
  const RunOutcome& outcome;
  const Trajectory& trajectory;
  const std::optional<MapCloud>& map;  ///< not set if only poses are wanted
  const DenseRecorder& images;
  FrameTable frames;
  nlohmann::json map_file;  ///< for run.json; null if no map was saved
  Timings program;          ///< of everything but `Slam` and writing
};

/// Writes all results, then run.json, which includes the time of that, and the report; without a map the
/// trajectory, the frame table and run.json alone. Returns the content of run.json. Throws InputError if a
/// file cannot be written.
nlohmann::json write_run(const RunFolder& folder, RunContents contents);

}  // namespace kinloop
