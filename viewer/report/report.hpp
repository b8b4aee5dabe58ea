#pragma once
// In: the results of one or several runs. Out: one self-contained HTML page.
// The page itself (viewer/pages/src/report) draws; this module computes its data from the files of the run.

#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <nlohmann/json.hpp>

#include "kinloop/geometry/trajectory.hpp"
#include "viewer/report/frame_table.hpp"

namespace kinloop {

/// A picture and its caption.
struct ReportImage {
  std::string caption;
  std::string jpeg;  ///< bytes of the JPEG file
};

/// One run; empty parts are left out. `figures` is its run.json, in which every field is optional.
struct RunReport {
  std::string name;
  nlohmann::json metrics;
  Trajectory estimate, keyframes, truth;
  Trajectory live;  ///< the poses as they were given while frames came
  FrameTable frames;
  std::vector<ReportImage> map_images;
  std::vector<ReportImage> loop_images;
  std::string
      cloud;  ///< a piece of the cloud in the format of the viewer's pages (viewer/scene/wire_format.hpp)
};

/// Returns the display name of an input: the last component of a path, anything else ("sim:room") unchanged.
std::string input_name(std::string_view input);

/// Returns the display name of a run: its input according to `figures`, its run.json, else its path.
std::string run_name(const nlohmann::json& figures, const std::filesystem::path& path);

/// Returns the last components of the paths, as many as needed to distinguish them.
std::vector<std::string> unique_short_names(std::span<const std::string> paths);

/// Returns the stamp of the first frame, else of the first pose; 0 if there is none.
int64_t start_stamp_ns(const RunReport& run);

/// Returns the page; for several runs it shows the figures side by side, and the cloud and pictures of the
/// first.
std::string render_report(std::span<const RunReport> runs);

/// Returns the page's data as JSON.
nlohmann::json report_data(std::span<const RunReport> runs);

}  // namespace kinloop
