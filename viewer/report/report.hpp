#pragma once
// In: what one or several runs left behind. Out: one HTML page that needs nothing else: no network, no other
// file.
//
// The page itself (viewer/pages/src/report) draws; here its data are put together: every number that it shows
// is computed by this module, from the files of the run.

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <nlohmann/json.hpp>

#include "kinloop/geometry/trajectory.hpp"
#include "viewer/report/frame_table.hpp"

namespace kinloop {

/// A picture and what it shows.
struct ReportImage {
  std::string caption;
  std::string jpeg;  ///< the bytes of the file
};

/// One run; parts that are empty are left out. `figures` is its run.json, of which nothing need be there.
struct RunReport {
  std::string name;
  nlohmann::json metrics;
  Trajectory estimate, keyframes, truth;
  FrameTable frames;
  std::vector<ReportImage> map_images;
  std::vector<ReportImage> loop_images;
  std::string cloud;  ///< a piece of the cloud as the viewer's pages read it (viewer/scene/wire_format.hpp)
};

/// What a run of this input is called: the last component of a path, anything else ("sim:room") as it is.
std::string input_name(std::string_view input);

/// The paths by their last components, with as many of those before them as it takes to tell all apart.
std::vector<std::string> unique_short_names(std::span<const std::string> paths);

/// When the run began: its first frame, else its first pose; 0 of none.
int64_t start_stamp_ns(const RunReport& run);

/// The page; of several runs it shows the figures side by side, and the cloud and the pictures of the first.
std::string render_report(std::span<const RunReport> runs);

/// What the page reads, as JSON.
nlohmann::json report_data(std::span<const RunReport> runs);

}  // namespace kinloop
