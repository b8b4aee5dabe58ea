#pragma once
// The steps of kinloop calibrate: its arguments, images from a live camera, the board in them, and the
// results as text and page.

#include <filesystem>
#include <functional>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>
#include <opencv2/core/mat.hpp>

#include "kinloop/core/threads/parallel_for.hpp"
#include "kinloop/geometry/camera.hpp"
#include "kinloop/sensor/camera/rgbd_camera.hpp"
#include "tools/calibration/board/board.hpp"
#include "tools/calibration/board/find_board.hpp"
#include "tools/calibration/capture.hpp"
#include "tools/calibration/depth_shift.hpp"
#include "tools/calibration/lens.hpp"
#include "tools/calibration/options.hpp"
#include "tools/calibration/rig.hpp"
#include "viewer/server/service.hpp"

namespace kinloop {

// kinloop calibrate --live: captures images from a live camera, with hints on the terminal and in the
// browser.

/// Shows the live image, the corners of the board and a hint in the browser.
class CapturePreview {
 public:
  /// Starts serving immediately. Throws InputError if the address is not available.
  CapturePreview(const ListenAddress& listen, std::string source);

  /// URL of the page.
  [[nodiscard]] const std::string& url() const { return service_.url(); }

  void show(const cv::Mat& color, const CaptureFeedback& feedback);

 private:
  struct Picture {
    cv::Mat color;
    CaptureFeedback feedback;
  };

  void update(Scene& scene, size_t browsers);

  std::string source_;
  std::mutex mutex_;
  std::optional<Picture> next_;  // guarded by the mutex
  size_t seen_ = 0;              // used by the service's thread only
  ViewerService service_;        // declared last: its thread uses all the others
};

/// The options; inactive if `source` is empty.
struct LiveCaptureOptions {
  std::string source;  ///< as for kinloop run
  size_t wanted = 20;
  std::string viewer;  ///< [ADDRESS:]PORT to listen on; empty: no browser
};

/// Adds --live, --stills and --viewer.
void add_live_options(CLI::App& command, LiveCaptureOptions& live);

/// Captures images into `folder` until there are enough, the source ends or Ctrl-C is pressed. Throws
/// InputError if the folder is not empty or the source lacks the images that `kind` needs.
void capture_live_stills(const LiveCaptureOptions& live, const std::filesystem::path& folder,
                         const Board& board, StillKind kind);

// The detections of the board in the images, with a summary on the terminal.

/// The arguments of kinloop calibrate.
struct CalibrateArguments {
  std::filesystem::path folder;
  std::string board = "5x7";
  double square_m = 0, marker_m = 0;
  std::filesystem::path output = "camera.yaml";
  std::string color, infrared;   ///< a folder of images or a camera.yaml
  std::filesystem::path camera;  ///< of `depth`
  double depth_scale = 0;        ///< units per metre
  LiveCaptureOptions live;
  double fps = 30;
  std::vector<std::string> assignments;
  int threads = hardware_threads();

  /// Returns the board. Throws UsageError if it is invalid or not supported by this build.
  [[nodiscard]] Board chosen_board() const;

  /// Returns the options. Throws UsageError if they contradict each other.
  [[nodiscard]] CalibrationOptions options() const;

  /// Returns the path of the output with another extension.
  [[nodiscard]] std::filesystem::path sibling_file(const char* ending) const;
};

/// Detects the board in these images.
BoardSearch search_boards(const std::vector<std::filesystem::path>& stills,
                          const CalibrateArguments& arguments);

/// Returns the shots of the folder in which both cameras see the board.
std::vector<PairedView> find_pairs(const CalibrateArguments& arguments);

/// Returns the path of a pair's depth image.
std::filesystem::path depth_path_of(const std::string& pair_name, const CalibrateArguments& arguments);

/// Returns a known camera (read from a file by `pick`), or images to estimate it from along with the pairs.
LensSource lens_source(const std::string& argument, const CalibrateArguments& arguments,
                       const std::function<std::optional<PinholeCamera>(const RgbdCamera&)>& pick);

// The results, as JSON, text for the terminal, and one self-contained HTML page.

/// Returns parameters with standard deviations, errors per view, rejected views, warnings.
nlohmann::json to_json(const LensCalibration& calibration);
nlohmann::json to_json(const RigCalibration& calibration);
nlohmann::json to_json(const DepthShift& shift);

/// Same for the terminal.
std::string to_text(const LensCalibration& calibration);
std::string to_text(const RigCalibration& calibration);
std::string to_text(const DepthShift& shift);

/// Returns a section of the page: a table of the parameters, plots of the errors and the coverage, the views.
std::string lens_section(const std::string& title, const LensCalibration& calibration);
std::string rig_section(const RigCalibration& calibration);
std::string depth_section(const DepthShift& shift);

/// Returns the page with these sections.
std::string calibration_page(const std::string& title, const std::string& subtitle,
                             const std::string& sections);

}  // namespace kinloop
