#pragma once
// In: live camera images while calibration images are captured. Out: the viewer's page with the image, the
// board's corners and a hint.

#include <mutex>
#include <optional>
#include <string>

#include <opencv2/core/mat.hpp>

#include "tools/calibration/capture.hpp"
#include "viewer/server/service.hpp"

namespace kinloop {

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

}  // namespace kinloop
