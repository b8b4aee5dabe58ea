#pragma once
// kinloop calibrate --live: captures images from a live camera, with hints on the terminal and in the
// browser.

#include <filesystem>
#include <mutex>
#include <optional>
#include <string>

#include <CLI/CLI.hpp>
#include <opencv2/core/mat.hpp>

#include "tools/calibration/capture.hpp"
#include "viewer/server/service.hpp"

namespace kinloop {

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

}  // namespace kinloop
