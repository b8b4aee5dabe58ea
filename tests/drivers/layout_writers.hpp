#pragma once
// Writes the same frames in every layout that kinloop reads.

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "kinloop/geometry/camera.hpp"
#include "kinloop/geometry/trajectory.hpp"

namespace kinloop::test {

/// Frames at 30 Hz from time 0, with depth in millimetres registered to colour.
struct Sample {
  PinholeCamera lens;
  std::vector<cv::Mat> colors;     ///< 8UC3
  std::vector<cv::Mat> depths_mm;  ///< 16UC1
  Trajectory truth;                ///< a pose for each frame, with its stamp

  [[nodiscard]] size_t size() const { return colors.size(); }
  [[nodiscard]] std::string stamp(size_t i) const;
};

/// A small sample of random images along a short path.
Sample make_sample(int frames, cv::Size size = {32, 24});

struct LayoutWriter {
  const char* name;  ///< that of the layout
  bool own_camera;   ///< the layout has one fixed camera: another one is to be given
  void (*write)(const std::filesystem::path& folder, const Sample& sample);
};

const std::vector<LayoutWriter>& layout_writers();

}  // namespace kinloop::test
