#pragma once
// Frames of a simulated room, and faults injected into their depth.

#include <functional>
#include <string>
#include <vector>

#include <opencv2/imgproc.hpp>

#include "session/input/checks/input_checker.hpp"
#include "simulator/simulated_source.hpp"

namespace kinloop::test {

struct CapturedFrames {
  RgbdCamera camera;
  std::vector<Frame> frames;
};

/// Every `step`-th of the first frames of a room at 320 x 240 and 30 Hz.
inline CapturedFrames simulated(SimulatedSensor sensor, uint64_t seed, int count, int step) {
  SimulationOptions options;
  options.sensor = sensor;
  options.width = 320;
  options.height = 240;
  const SimulatedSource source("sim:room", seed, options, 2);
  CapturedFrames recording{source.camera(), {}};
  for (int i = 0; i < count; ++i) recording.frames.push_back(source.frame(static_cast<size_t>(i * step)));
  return recording;
}

using DepthChange = std::function<cv::Mat(const cv::Mat&)>;

inline CapturedFrames with_depth(CapturedFrames recording, const DepthChange& change) {
  for (Frame& frame : recording.frames) frame.depth_m = change(frame.depth_m);
  return recording;
}

inline DepthChange flipped(int code) {
  return [code](const cv::Mat& depth_m) {
    cv::Mat changed;
    cv::flip(depth_m, changed, code);
    return changed;
  };
}

/// Scales depth images about their middle and shifts them by a share of their width.
inline DepthChange resized(double scale_x, double scale_y, double shift_x = 0) {
  return [=](const cv::Mat& depth_m) {
    const double width = depth_m.cols, height = depth_m.rows;
    const cv::Matx23d map(scale_x, 0, 0.5 * width * (1 - scale_x) + shift_x * width,  //
                          0, scale_y, 0.5 * height * (1 - scale_y));
    cv::Mat changed;
    cv::warpAffine(depth_m, changed, map, depth_m.size(), cv::INTER_NEAREST);
    return changed;
  };
}

/// All that is said about a recording.
inline std::vector<InputWarning> warnings(const CapturedFrames& recording,
                                          FrameOrder order = FrameOrder::kSpread) {
  InputChecker checker(recording.camera, order);
  std::vector<InputWarning> all;
  const auto add = [&](const std::vector<InputWarning>& found) {
    all.insert(all.end(), found.begin(), found.end());
  };
  for (const Frame& frame : recording.frames) add(checker.observe(frame));
  add(checker.finish());
  return all;
}

/// The same as text, a line each.
inline std::string warning_text(const CapturedFrames& recording, FrameOrder order = FrameOrder::kSpread) {
  std::string text;
  for (const InputWarning& warning : warnings(recording, order)) text += text_of(warning) + "\n";
  return text;
}

}  // namespace kinloop::test
