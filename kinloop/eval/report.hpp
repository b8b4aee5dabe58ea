#pragma once
// In: what one or several runs left behind. Out: one HTML page that needs nothing else: no network, no other
// file.
//
// The page itself (viewer/pages/src/report) draws; here its data are put together: every number that it shows
// is computed by this room, from the files of the run.

#include <span>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "kinloop/eval/frame_table.hpp"
#include "kinloop/geometry/trajectory.hpp"

namespace kinloop {

/// A picture and what it shows.
struct ReportPicture {
  std::string caption;
  std::string jpeg;  ///< the bytes of the file
};

/// One run; parts that are empty are left out. `figures` is its run.json, of which nothing need be there.
struct RunReport {
  std::string name;
  nlohmann::json figures;
  Trajectory estimate, keyframes, truth;
  FrameTable frames;
  std::vector<ReportPicture> map_pictures;
  std::vector<ReportPicture> loop_pictures;
  std::string cloud;  ///< a piece of the cloud as the viewer's pages read it (viewer/scene/wire.hpp)
};

/// The page; of several runs it shows the figures side by side, and the cloud and the pictures of the first.
std::string render_report(std::span<const RunReport> runs);

/// What the page reads, as JSON.
nlohmann::json report_data(std::span<const RunReport> runs);

}  // namespace kinloop
