#pragma once
// In: what a live camera sees while stills are taken. Out: the viewer's page with its image, the board's
// corners and a hint.

#include <mutex>
#include <optional>
#include <string>

#include <opencv2/core/mat.hpp>

#include "tools/calibration/capture.hpp"
#include "viewer/server/service.hpp"

namespace kinloop {

class CapturePreview {
 public:
  /// Begins to serve at once. Throws InputError where the address cannot be had.
  CapturePreview(const ListenAddress& listen, std::string source);

  /// Where to look.
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
  size_t seen_ = 0;              // of the service's thread
  ViewerService service_;        // the last: its thread uses all the others
};

}  // namespace kinloop
